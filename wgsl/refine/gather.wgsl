// The tile of each root at level 0: its corners and one row around.
//
// An invocation a root: reads 64 bytes of numbers and 256 of points, most of them from the caches, and writes 256.

import extent;
import pinned;
import roots;

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> tiles: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let index = linear(id, groups);
  if index >= params.count {
    return;
  }
  let root = params.first + index;
  let tile = 16u * (root - params.chunk);
  for (var k = 0u; k < 4u; k++) {
    let numbers = roots[ROOT * root + k];
    for (var i = 0u; i < 4u; i++) {
      tiles[tile + 4u * k + i] = points[numbers[i]];
    }
  }
  let extra = roots[ROOT * root + 4u].w;
  if extra == NONE {
    return;
  }
  // Steps across the sides, in rows of four.
  var outward = array<i32, 4>(-4, 1, 4, -1);
  var corners = array<i32, 4>(5, 6, 10, 9);
  for (var k = 0u; k < 4u; k++) {
    let ring = extras[extra + 4u * k];
    if ring == NONE {
      continue;
    }
    let to = i32(tile) + corners[k];
    tiles[to] = rings[ring];
    let before = extras[extra + 4u * k + 2u];
    let after = extras[extra + 4u * k + 3u];
    if before != NONE {
      tiles[to + outward[k]] = rings[ring + before];
    }
    if after != NONE {
      tiles[to + outward[(k + 3u) & 3u]] = rings[ring + after];
    }
  }
}
