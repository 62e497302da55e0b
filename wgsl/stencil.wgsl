// The points of a curve from its control points, each by its row of a table: affine/stencils.rs. All steps at once.
//
// An invocation a point: reads 8 bytes of its row and writes 16; weights (4 bytes) and control points (16) come from the
// caches, since many rows share them. 8 flops a weight. 64 control points and 6 steps of Chaikin's rule, 4,096 points of 3
// weights: 96 KiB to and from memory and 96 Kflop a frame, where 6 derived steps move 189 KiB or more.

import extent;

struct Shape {
  count: u32,
  columns: u32,
  reserved_0: u32,
  reserved_1: u32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var<storage, read> rows: array<vec2u>;
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read> control: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> curve: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn stencil(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= shape.count {
    return;
  }
  let row = rows[i];
  let begin = row.y & 0xffffffu;
  let end = begin + (row.y >> 24u) + 1u;
  var at = row.x;
  var sum = vec4f();
  for (var k = begin; k < end; k++) {
    sum += weights[k] * control[at];
    at += 1u;
    // Behind the last control point stands the first.
    if at == shape.columns {
      at = 0u;
    }
  }
  curve[i] = sum;
}
