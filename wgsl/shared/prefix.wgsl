// Prefix sums over tiles of WORKGROUP·ITEMS elements: reduce, then spine, then down.
//
// Three dispatches and no spinning: WebGPU promises no progress between workgroups, and some
// drivers end a loop that waits. Each invocation takes ITEMS consecutive elements, so 12 bytes an
// element move in all (two reads, one write). ITEMS is large on CPU drivers, where barriers and
// loads are dear, and 16 elsewhere: 64 bytes an invocation, whole cache lines.

import tiles;

var<workgroup> partial: array<u32, WORKGROUP>;

// Inclusive sum over the workgroup.
fn workgroup_sum(local: u32, value: u32) -> u32 {
  partial[local] = value;
  workgroupBarrier();
  for (var distance = 1u; distance < WORKGROUP; distance = distance << 1u) {
    var before = 0u;
    if local >= distance {
      before = partial[local - distance];
    }
    workgroupBarrier();
    partial[local] += before;
    workgroupBarrier();
  }
  return partial[local];
}
