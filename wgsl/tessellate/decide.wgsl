// Which cells of a level are split.
//
// An invocation a cell: its control points are made from its root's, which no buffer then has to hold. Reads
// 16·R·C bytes, mostly from caches, and 24 more; does C·m(m + 1)/2 midpoints for each halving along x and
// R·n(n + 1)/2 along y: 48 for a level of a bicubic net, then about 500 flops of the bound.

import lattice;
import topology;
import control;
import bound;

struct Target {
  clip: mat4x4f,
  half_size: vec2f,
  near: f32,
  tolerance: f32,
  keep: f32,
  pixels: u32,
  least: u32,
  most: u32,
}

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<uniform> wanted: Target;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> nets: array<vec4f>;
@group(0) @binding(5) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(6) var<storage, read> children_before: array<u32>;
@group(0) @binding(7) var<storage, read_write> counts: array<u32>;
@group(0) @binding(8) var<storage, read_write> marks: array<u32>;

// Keeps one half of each column.
fn halve_columns(upper: bool) {
  for (var level = 1u; level < ROWS; level++) {
    for (var k = 0u; k + 1u < ROWS; k++) {
      if k + level < ROWS {
        for (var c = 0u; c < COLUMNS; c++) {
          if upper {
            let at = k * COLUMNS + c;
            net[at] = (net[at] + net[at + COLUMNS]) * 0.5;
          } else {
            let at = (ROWS - 1u - k) * COLUMNS + c;
            net[at] = (net[at] + net[at - COLUMNS]) * 0.5;
          }
        }
      }
    }
  }
}

// Keeps one half of each row.
fn halve_rows(upper: bool) {
  for (var level = 1u; level < COLUMNS; level++) {
    for (var k = 0u; k + 1u < COLUMNS; k++) {
      if k + level < COLUMNS {
        for (var r = 0u; r < ROWS; r++) {
          if upper {
            let at = r * COLUMNS + k;
            net[at] = (net[at] + net[at + 1u]) * 0.5;
          } else {
            let at = r * COLUMNS + COLUMNS - 1u - k;
            net[at] = (net[at] + net[at - 1u]) * 0.5;
          }
        }
      }
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
  let limit = select(wanted.tolerance, wanted.keep, was_split);
  if wanted.pixels == 0u {
    return error_bound(RATIONAL) > limit;
  }
  // Outside by one plane of the picture's frustum: left, right, below, above, behind.
  var outside = 31u;
  var crosses = false;
  for (var k = 0u; k < POINTS; k++) {
    let p = net[k];
    let x = clipped(p, 0u);
    let y = clipped(p, 1u);
    let w = clipped(p, 3u);
    outside &= select(0u, 1u, x < -w) | select(0u, 2u, x > w) | select(0u, 4u, y < -w) | select(0u, 8u, y > w)
      | select(0u, 16u, w < wanted.near);
    crosses = crosses || w < wanted.near;
    net[k] = vec4f(x * wanted.half_size.x, y * wanted.half_size.y, 0.0, w);
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
  let old = select(counts[sizes.section + i], i, range.level == 0u);
  counts[sizes.section + i] = old;
  var was_split = false;
  if old != NOWHERE {
    was_split = children_before[old] != LEAF;
  }
  counts[k] = select(0u, 1u, splits(nodes[i], was_split));
  marks[i] = 0u;
}
