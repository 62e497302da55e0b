// What every pass of a step shares with the host: plan/step.rs.

struct Extent {
  count: u32,
  capacity: u32,
  wanted: u32,
  step: u32,
  run_step: u32,
  seed: u32,
  given: u32,
  halted: u32,
  before: u32,
  behind: u32,
  made: u32,
  reserved: u32,
}

struct Status {
  fired: atomic<u32>,
  too_deep: atomic<u32>,
  retired_symbols: atomic<u32>,
  needed: atomic<u32>,
  needed_finished: atomic<u32>,
  claimed: u32,
  reserved_0: u32,
  reserved_1: u32,
}

// More than 65,535 workgroups need two dimensions: invocations are counted along x, then y.
fn linear(id: vec3u, groups: vec3u) -> u32 {
  return id.x + id.y * groups.x * WORKGROUP;
}
