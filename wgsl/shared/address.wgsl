// The record's header: plan/layout.rs.

import record;

const NOWHERE = 0xffffffffu;
const MAX_HALVINGS = 31u;

fn symbol_of(m: Record) -> u32 {
  return m.q0.x & 0xffffu;
}

// max(du, dv)
fn level_of(m: Record) -> u32 {
  return max((m.q0.x >> 16u) & 0xffu, m.q0.x >> 24u);
}

fn too_deep(m: Record, halves: u32) -> bool {
  return ((m.q0.x >> 16u) & 0xffu) + (halves & 1u) > MAX_HALVINGS || (m.q0.x >> 24u) + (halves >> 1u) > MAX_HALVINGS;
}
