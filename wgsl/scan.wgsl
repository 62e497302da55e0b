// Exclusive prefix sum of `counts`; the total stands behind the last offset. Sums wrap at 2^32.

import extent;
import prefix;
import spine;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> offsets: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn reduce(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = tile * TILE + local * ITEMS;
  var sum = 0u;
  if start + ITEMS <= extent.count {
    for (var k = 0u; k < ITEMS; k++) {
      sum += counts[start + k];
    }
  } else {
    for (var k = start; k < extent.count; k++) {
      sum += counts[k];
    }
  }
  let inclusive = workgroup_sum(local, sum);
  if local == WORKGROUP - 1u && tile < tile_count(extent.count) {
    sums[tile] = inclusive;
  }
}

@compute @workgroup_size(WORKGROUP)
fn scan(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = tile * TILE + local * ITEMS;
  let full = start + ITEMS <= extent.count;
  var before: array<u32, ITEMS>;
  var sum = 0u;
  if full {
    for (var k = 0u; k < ITEMS; k++) {
      before[k] = sum;
      sum += counts[start + k];
    }
  } else {
    for (var k = start; k < extent.count; k++) {
      before[k - start] = sum;
      sum += counts[k];
    }
  }
  let inclusive = workgroup_sum(local, sum);
  if tile >= tile_count(extent.count) {
    return;
  }
  let base = sums[tile] + inclusive - sum;
  if full {
    for (var k = 0u; k < ITEMS; k++) {
      offsets[start + k] = base + before[k];
    }
  } else {
    for (var k = start; k < extent.count; k++) {
      offsets[k] = base + before[k - start];
    }
  }
  if tile == 0u && local == 0u {
    offsets[extent.count] = sums[tile_count(extent.count)];
  }
}
