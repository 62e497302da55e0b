// The indices of the retired modules, or of whatever elements equal `extent.wanted`, in ascending
// order; their number stands behind the tiles' sums.

import extent;
import compositions;
import sums;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> rules: array<u32>;
@group(0) @binding(2) var<storage, read_write> retired: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

fn found(i: u32) -> u32 {
  return select(0u, 1u, rules[i] == extent.wanted);
}

fn element_of(start: u32, end: u32) -> u32 {
  var sum = 0u;
  for (var i = start; i < end; i++) {
    sum += found(i);
  }
  return sum;
}

@compute @workgroup_size(WORKGROUP)
fn compact(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let own = own_of(group, groups, local);
  // The hits of this invocation, a bit each: the rules are read once.
  var hits: array<u32, ITEM_WORDS>;
  var sum = 0u;
  for (var i = own.start; i < own.end; i++) {
    let hit = found(i);
    let k = i - own.start;
    hits[k >> 5u] |= hit << (k & 31u);
    sum += hit;
  }
  let inclusive = workgroup_composed(local, sum);
  if own.tile >= tile_count(extent.count) {
    return;
  }
  var at = sums[own.tile] + inclusive - sum;
  for (var w = 0u; w < ITEM_WORDS; w++) {
    var left = hits[w];
    while left != 0u {
      retired[at] = own.start + w * 32u + firstTrailingBit(left);
      at++;
      left &= left - 1u;
    }
  }
}
