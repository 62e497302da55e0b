// The triangles: two of each leaf without finer neighbours, fans of the others, and what leaves add to the
// fans of larger ones.
//
// A triangle writes 12 bytes of indices and 4 of its cell, and reads nodes along a few paths.

import lattice;
import topology;
import tree;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> topology: array<u32>;
@group(0) @binding(3) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(4) var<storage, read> children: array<u32>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read> marks: array<u32>;
@group(0) @binding(7) var<storage, read> offsets: array<u32>;
@group(0) @binding(8) var<storage, read_write> indices: array<u32>;
@group(0) @binding(9) var<storage, read_write> cells: array<u32>;

// The number of what a leaf owns, behind so many corners.
fn number(node: u32, below: u32) -> u32 {
  let owned = (marks[node] >> OWNS) & 15u;
  return offsets[node] + countOneBits(owned & ((1u << below) - 1u));
}

fn vertex_at(root: u32, p: vec2u) -> u32 {
  let owner = owner_of(root, p);
  return number(owner.node, owner.corner);
}

fn write(at: u32, a: u32, b: u32, c: u32, cell: u32) {
  let turn = mirrors(nodes[cell].x);
  let base = sizes.index_word + 3u * at;
  indices[base] = a;
  indices[base + 1u] = select(b, c, turn);
  indices[base + 2u] = select(c, b, turn);
  cells[at] = cell;
}

@compute @workgroup_size(WORKGROUP)
fn triangles(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= range.count || children[i] != LEAF {
    return;
  }
  let n = nodes[i];
  let depth = depth_of(n);
  let mark = marks[i];
  var at = offsets[sizes.section + i];
  var corner: array<u32, 4>;
  if !is_hole(n) {
    for (var c = 0u; c < 4u; c++) {
      corner[c] = vertex_at(n.x, corner_of(n, c));
    }
    if (mark & FINER) == 0u {
      let halves = halves_of(n);
      if (halves & 1u) != 0u {
        write(at, corner[0], corner[1], corner[3], i);
        at += 1u;
      }
      if (halves & 2u) != 0u {
        write(at, corner[0], corner[3], corner[2], i);
        at += 1u;
      }
    } else {
      let centre = number(i, 4u);
      for (var side = 0u; side < 4u; side++) {
        if ((mark >> side) & 1u) == 0u && !collapsed(n, side) {
          let ends = side_around(side);
          write(at, corner[ends.x], corner[ends.y], centre, i);
          at += 1u;
        }
      }
    }
  }
  var own = number(i, 4u) + select(0u, 1u, (mark & FAN) != 0u);
  for (var side = 0u; side < 4u; side++) {
    let count = across_count(n, side);
    if pushes(n, side, mark, count) {
      for (var k = 0u; k < count; k++) {
        let to = across(n, side, k);
        if takes(to, depth[along(side)]) {
          let ends = foreign(n, side, to);
          var index: array<u32, 2>;
          for (var end = 0u; end < 2u; end++) {
            if SHARED || !on_border(n, side) || has_corner(nodes[to.node], ends[end]) {
              index[end] = vertex_at(to.root, ends[end]);
            } else {
              index[end] = own;
              own += 1u;
            }
          }
          write(at, index[0], index[1], number(to.node, 4u), to.node);
          at += 1u;
        }
      }
    }
  }
}
