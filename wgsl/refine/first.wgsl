// The points of the roots where faces are no quads: each a combination of the mesh's points, row by row.
//
// An invocation a point: reads 20 bytes of points and weights a term (about 6 terms) and writes 16.

import extent;
import pinned;

struct Params {
  count: u32,
  zero: u32,
  reserved_0: u32,
  reserved_1: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> mesh: array<vec4f>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
// A point and its weight.
@group(0) @binding(3) var<storage, read> terms: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> points: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn first(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= params.count {
    return;
  }
  var sum = vec3f();
  for (var k = starts[i]; k < starts[i + 1u]; k++) {
    let term = terms[k];
    sum = pin(sum + pin(mesh[term.x].xyz * bitcast<f32>(term.y)));
  }
  points[i] = vec4f(sum, 1.0);
}
