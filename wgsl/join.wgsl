// What stands beside a word that is one chunk: in a ring the other end, else nothing, which has the symbol END.
// plan/edges.rs.
//
// One workgroup: an invocation copies a record of 16·QUADS bytes.

import extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read_write> records: array<vec4u>;

const END = 0xffffu;

@compute @workgroup_size(2u * HALO)
fn join(@builtin(local_invocation_index) k: u32) {
  let n = extent.count;
  let before = k < HALO;
  let to = select(n + k, k, before);
  if !RING || n == 0u {
    for (var q = 0u; q < QUADS; q++) {
      records[to * QUADS + q] = vec4u(select(0u, END, q == 0u), 0u, 0u, 0u);
    }
    return;
  }
  var module_at = (k - HALO) % n;
  if before {
    module_at = (n - (HALO - k) % n) % n;
  }
  for (var q = 0u; q < QUADS; q++) {
    records[to * QUADS + q] = records[(HALO + module_at) * QUADS + q];
  }
}
