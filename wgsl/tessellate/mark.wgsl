// Which sides of leaves have something finer across: said by the finer one, whatever the order.

import lattice;
import topology;
import tree;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<storage, read> topology: array<u32>;
@group(0) @binding(2) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(3) var<storage, read> children: array<u32>;
@group(0) @binding(4) var<storage, read> table: array<u32>;
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;

@compute @workgroup_size(WORKGROUP)
fn mark(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= range.count || children[i] != LEAF {
    return;
  }
  let n = nodes[i];
  let depth = depth_of(n);
  for (var side = 0u; side < 4u; side++) {
    let count = across_count(n, side);
    for (var k = 0u; k < count; k++) {
      let a = across(n, side, k);
      if a.depth < depth[along(side)] {
        atomicOr(&marks[a.node], 1u << a.side);
      }
    }
  }
}
