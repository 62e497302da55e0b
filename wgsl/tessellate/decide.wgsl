// Which cells of a level are split.
//
// An invocation a cell: its control points are made from its root's, which no buffer then has to hold. Reads
// 16·R·C bytes, mostly from caches, and 24 more; does C·m(m + 1)/2 midpoints for each halving along x and
// R·n(n + 1)/2 along y: 48 for a level of a bicubic net, then about 500 flops of the bound.

import lattice;
import topology;
import control;
import bound;
import target;
import budget;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<uniform> wanted: Target;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> nets: array<vec4f>;
@group(0) @binding(5) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(6) var<storage, read> children_before: array<u32>;
@group(0) @binding(7) var<storage, read> budget: Budget;
@group(0) @binding(8) var<storage, read> leaves_before: array<u32>;
@group(0) @binding(9) var<storage, read_write> counts: array<u32>;
@group(0) @binding(10) var<storage, read_write> marks: array<u32>;

// Keeps one half of each column. Both are made, so that no invocation waits for others that keep the other one.
fn halve_columns(upper: bool) {
  for (var c = 0u; c < COLUMNS; c++) {
    var p: array<vec4f, ROWS>;
    var first: array<vec4f, ROWS>;
    for (var r = 0u; r < ROWS; r++) {
      p[r] = net[r][c];
    }
    for (var level = 0u; level < ROWS; level++) {
      first[level] = p[0];
      for (var r = 0u; r + 1u < ROWS; r++) {
        if r + level + 1u < ROWS {
          p[r] = (p[r] + p[r + 1u]) * 0.5;
        }
      }
    }
    for (var r = 0u; r < ROWS; r++) {
      net[r][c] = select(first[r], p[r], upper);
    }
  }
}

// Keeps one half of each row.
fn halve_rows(upper: bool) {
  for (var r = 0u; r < ROWS; r++) {
    var p = net[r];
    var first: array<vec4f, COLUMNS>;
    for (var level = 0u; level < COLUMNS; level++) {
      first[level] = p[0];
      for (var c = 0u; c + 1u < COLUMNS; c++) {
        if c + level + 1u < COLUMNS {
          p[c] = (p[c] + p[c + 1u]) * 0.5;
        }
      }
    }
    for (var c = 0u; c < COLUMNS; c++) {
      net[r][c] = select(first[c], p[c], upper);
    }
  }
}

// Row k of the matrix times a point.
fn clipped(p: vec4f, k: u32) -> f32 {
  return (wanted.clip[0][k] * p.x + wanted.clip[1][k] * p.y) + (wanted.clip[2][k] * p.z + wanted.clip[3][k] * p.w);
}

fn splits(n: vec4u, was_split: bool) -> bool {
  let depth = depth_of(n);
  let least = min(depth.x, depth.y);
  let most = max(depth.x, depth.y);
  if is_hole(n) || most + 1u >= LEVELS {
    return false;
  }
  if least < least_depth(n.x) {
    return true;
  }
  if most >= wanted.most {
    return false;
  }
  if least < wanted.least {
    return true;
  }
  load_net(n.x);
  for (var level = depth.x; level > 0u; level--) {
    halve_columns(((n.z >> (level - 1u)) & 1u) != 0u);
  }
  for (var level = depth.y; level > 0u; level--) {
    halve_rows(((n.w >> (level - 1u)) & 1u) != 0u);
  }
  let limit = select(wanted.tolerance, wanted.keep, was_split) * raised(budget.coarser);
  if wanted.pixels == 0u {
    return error_bound(RATIONAL) > limit;
  }
  // Outside by one plane of the picture's frustum: left, right, below, above, behind.
  var outside = 31u;
  var crosses = false;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      let p = net[r][c];
      let x = clipped(p, 0u);
      let y = clipped(p, 1u);
      let w = clipped(p, 3u);
      outside &= select(0u, 1u, x < -w) | select(0u, 2u, x > w) | select(0u, 4u, y < -w) | select(0u, 8u, y > w)
        | select(0u, 16u, w < wanted.near);
      crosses = crosses || w < wanted.near;
      net[r][c] = vec4f(x * wanted.half_size.x, y * wanted.half_size.y, 0.0, w);
    }
  }
  if outside != 0u {
    return false;
  }
  // What the near plane cuts has no size in the picture, however small it is.
  return crosses || error_bound(true) > limit;
}

@compute @workgroup_size(WORKGROUP)
fn decide(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k >= range.count {
    return;
  }
  let i = range.first + k;
  // Where triangles will be counted stands meanwhile which node had this cell in the frame before.
  var old = i;
  if range.level != 0u {
    old = counts[sizes.section + i];
  } else if DERIVED {
    old = leaves_before[i];
  }
  counts[sizes.section + i] = old;
  var was_split = false;
  if old != NOWHERE {
    was_split = children_before[old] != LEAF;
  }
  counts[k] = select(0u, 1u, splits(nodes[i], was_split));
  marks[i] = 0u;
}
