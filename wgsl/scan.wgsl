// Exclusive prefix sum of `counts`; the total stands behind the last offset. 12 bytes an element move.

import extent;
import compositions;
import sums;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> offsets: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

fn element_of(start: u32, end: u32) -> u32 {
  var sum = 0u;
  if end - start == ITEMS {
    for (var k = 0u; k < ITEMS; k++) {
      sum += counts[start + k];
    }
  } else {
    for (var k = start; k < end; k++) {
      sum += counts[k];
    }
  }
  return sum;
}

@compute @workgroup_size(WORKGROUP)
fn scan(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let own = own_of(group, groups, local);
  let full = own.end - own.start == ITEMS;
  // The counts are read once.
  var before: array<u32, ITEMS>;
  var sum = 0u;
  if full {
    for (var k = 0u; k < ITEMS; k++) {
      before[k] = sum;
      sum += counts[own.start + k];
    }
  } else {
    for (var k = own.start; k < own.end; k++) {
      before[k - own.start] = sum;
      sum += counts[k];
    }
  }
  let inclusive = workgroup_composed(local, sum);
  if own.tile >= tile_count(extent.count) {
    return;
  }
  let base = sums[own.tile] + inclusive - sum;
  if full {
    for (var k = 0u; k < ITEMS; k++) {
      offsets[own.start + k] = base + before[k];
    }
  } else {
    for (var k = own.start; k < own.end; k++) {
      offsets[k] = base + before[k - own.start];
    }
  }
  if own.tile == 0u && local == 0u {
    offsets[extent.count] = sums[tile_count(extent.count)];
  }
}
