// Where leaves come from that are derived anew each frame.

// How a derivation says what it made: tessellate/word.rs.
struct Source {
  // vec4u of a record.
  quads: u32,
  // The symbol of erased cells.
  hole: u32,
  // Slots of the table.
  slots: u32,
  reserved_0: u32,
}

// plan/turns.rs
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
