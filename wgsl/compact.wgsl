// The indices of the retired modules, or of whatever elements equal `extent.wanted`, in ascending
// order; their number stands behind the tiles' sums.

import extent;
import prefix;
import spine;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> rules: array<u32>;
@group(0) @binding(2) var<storage, read_write> retired: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

fn found(i: u32) -> u32 {
  return select(0u, 1u, rules[i] == extent.wanted);
}

@compute @workgroup_size(WORKGROUP)
fn reduce(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = tile * TILE + local * ITEMS;
  let end = min(start + ITEMS, extent.count);
  var sum = 0u;
  for (var i = start; i < end; i++) {
    sum += found(i);
  }
  let inclusive = workgroup_sum(local, sum);
  if local == WORKGROUP - 1u && tile < tile_count(extent.count) {
    sums[tile] = inclusive;
  }
}

@compute @workgroup_size(WORKGROUP)
fn compact(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = tile * TILE + local * ITEMS;
  let end = min(start + ITEMS, extent.count);
  // The hits of this invocation, a bit each: the rules are read once.
  var hits: array<u32, ITEM_WORDS>;
  var sum = 0u;
  for (var i = start; i < end; i++) {
    let hit = found(i);
    let k = i - start;
    hits[k >> 5u] |= hit << (k & 31u);
    sum += hit;
  }
  let inclusive = workgroup_sum(local, sum);
  if tile >= tile_count(extent.count) {
    return;
  }
  var at = sums[tile] + inclusive - sum;
  for (var w = 0u; w < ITEM_WORDS; w++) {
    var left = hits[w];
    while left != 0u {
      retired[at] = start + w * 32u + firstTrailingBit(left);
      at++;
      left &= left - 1u;
    }
  }
}
