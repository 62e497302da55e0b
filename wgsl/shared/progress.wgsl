// What a recorded derivation says of itself: plan/turns.rs.

struct Progress {
  modules: u32,
  needed: u32,
  capacity: u32,
  too_deep: u32,
  steps: u32,
  frame: u32,
  fired: u32,
  halted: u32,
}
