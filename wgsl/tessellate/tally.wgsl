// How many vertices and triangles each leaf makes, and which vertices it owns.

import lattice;
import topology;
import tree;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> topology: array<u32>;
@group(0) @binding(3) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(4) var<storage, read> children: array<u32>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read_write> marks: array<u32>;
@group(0) @binding(7) var<storage, read_write> counts: array<u32>;

// A vertex is there if a leaf that is no hole touches it; the first with a corner there owns it.
fn owns(i: u32, n: vec4u, corner: u32) -> bool {
  let a = around(n.x, corner_of(n, corner));
  var own = false;
  var seen = !is_hole(n);
  for (var k = 0u; k < a.count; k++) {
    let found = touching(a, k);
    if found.node == NOWHERE {
      continue;
    }
    if !own && found.corner != NOWHERE {
      own = found.node == i && found.corner == corner;
      if !own {
        return false;
      }
    }
    seen = seen || !is_hole(nodes[found.node]);
    if own && seen {
      break;
    }
  }
  return seen;
}

@compute @workgroup_size(WORKGROUP)
fn tally(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= range.count {
    return;
  }
  if children[i] != LEAF {
    counts[i] = 0u;
    counts[sizes.section + i] = 0u;
    return;
  }
  let n = nodes[i];
  let depth = depth_of(n);
  var mark = marks[i];
  var triangles = 0u;
  var vertices = 0u;
  if !is_hole(n) {
    if (mark & FINER) == 0u {
      triangles += countOneBits(halves_of(n));
    } else {
      mark |= FAN;
      vertices += 1u;
      for (var side = 0u; side < 4u; side++) {
        triangles += select(1u, 0u, ((mark >> side) & 1u) != 0u || collapsed(n, side));
      }
    }
  }
  for (var side = 0u; side < 4u; side++) {
    let count = across_count(n, side);
    if pushes(n, side, mark, count) {
      for (var k = 0u; k < count; k++) {
        let to = across(n, side, k);
        if takes(to, depth[along(side)]) {
          triangles += 1u;
          if !SHARED && on_border(n, side) {
            // Its ends on the other patch, but for the corners that are there.
            let ends = foreign(n, side, to);
            vertices += select(1u, 0u, has_corner(nodes[to.node], ends[0]));
            vertices += select(1u, 0u, has_corner(nodes[to.node], ends[1]));
          }
        }
      }
    }
  }
  for (var corner = 0u; corner < 4u; corner++) {
    if owns(i, n, corner) {
      mark |= 1u << (OWNS + corner);
      vertices += 1u;
    }
  }
  marks[i] = mark;
  counts[i] = vertices;
  counts[sizes.section + i] = triangles;
}
