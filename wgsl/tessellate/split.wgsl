// The four quarters of every cell that is split, behind the nodes that are there. Where there is no room for
// them the cell stays whole.
//
// An invocation a cell of the level: reads 8 to 28 bytes, writes 4, and 80 more if it is split.

import lattice;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> children_before: array<u32>;
@group(0) @binding(4) var<storage, read_write> counts: array<u32>;
@group(0) @binding(5) var<storage, read_write> nodes: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> children: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn split(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k >= range.count {
    return;
  }
  let i = range.first + k;
  let first = range.first + range.count + 4u * offsets[k];
  if counts[k] == 0u || first + 4u > sizes.nodes {
    children[i] = LEAF;
    return;
  }
  children[i] = first;
  let old = counts[sizes.section + i];
  var known = LEAF;
  if old != NOWHERE {
    known = children_before[old];
  }
  let n = nodes[i];
  for (var c = 0u; c < 4u; c++) {
    nodes[first + c] = quarter_of(n, c);
    counts[sizes.section + first + c] = select(known + c, NOWHERE, known == LEAF);
  }
}
