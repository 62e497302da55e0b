// Which cells of a level are split.
//
// An invocation a cell: its control points are made from its root's, which no buffer then has to hold, by the weights
// that the ends of the cell give. So it takes as long at any depth, and no loop carries a net. Reads 16·R·C bytes,
// mostly from caches, and 24 more. For a bicubic net 16 points become others along x, then along y: 32 sums of 7 flops a
// coordinate, 672, or 896 with weights; the shares of both directions take 264 more, and the bound 420, or 940.

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

// Weights of the points of a curve, of which one more counts than before.
fn count_one(w: array<f32, LINES>, t: f32) -> array<f32, LINES> {
  var next: array<f32, LINES>;
  let s = 1.0 - t;
  next[0] = s * w[0];
  for (var i = 1u; i < LINES; i++) {
    next[i] = s * w[i] + t * w[i - 1u];
  }
  return next;
}

// How much each control point of a part of a curve has of those of the whole.
struct Shares {
  w: array<array<f32, LINES>, LINES>,
}

// The part from a to b: its point k is the blossom at a, and k times at b.
fn shares(points: u32, a: f32, b: f32) -> Shares {
  var all: Shares;
  for (var k = 0u; k < LINES; k++) {
    var w: array<f32, LINES>;
    w[0] = 1.0;
    for (var n = 1u; n < LINES; n++) {
      if n < points {
        w = count_one(w, select(a, b, n + k >= points));
      }
    }
    all.w[k] = w;
  }
  return all;
}

// Where all weights are 1 nothing is computed for them.
fn weighed(p: vec4f) -> vec4f {
  if RATIONAL {
    return p;
  }
  return vec4f(p.xyz, 1.0);
}

// From the root's control points those of a cell: along x, then along y.
fn restrict_net(n: vec4u) {
  // Exact, which a division need not be.
  let size = bitcast<vec2f>((vec2u(127u) - depth_of(n)) << vec2u(23u));
  let low = vec2f(n.zw) * size;
  let high = vec2f(n.zw + vec2u(1u)) * size;
  let x = shares(ROWS, low.x, high.x);
  for (var c = 0u; c < COLUMNS; c++) {
    var p: array<vec4f, ROWS>;
    for (var r = 0u; r < ROWS; r++) {
      p[r] = net[r][c];
    }
    for (var k = 0u; k < ROWS; k++) {
      var sum = x.w[k][0] * p[0];
      for (var r = 1u; r < ROWS; r++) {
        sum += x.w[k][r] * p[r];
      }
      net[k][c] = weighed(sum);
    }
  }
  let y = shares(COLUMNS, low.y, high.y);
  for (var r = 0u; r < ROWS; r++) {
    let p = net[r];
    for (var k = 0u; k < COLUMNS; k++) {
      var sum = y.w[k][0] * p[0];
      for (var c = 1u; c < COLUMNS; c++) {
        sum += y.w[k][c] * p[c];
      }
      net[r][k] = weighed(sum);
    }
  }
}

// Row k of the matrix times the root's place, over its size.
fn moved(k: u32) -> f32 {
  let o = net_origin;
  return ((wanted.clip[0][k] * o.x + wanted.clip[1][k] * o.y) + (wanted.clip[2][k] * o.z + wanted.clip[3][k]))
    * inverse_size();
}

// Row k of the matrix times a point about that place, over the size.
fn clipped(p: vec4f, k: u32, moved: f32) -> f32 {
  return (wanted.clip[0][k] * p.x + wanted.clip[1][k] * p.y) + (wanted.clip[2][k] * p.z + moved * p.w);
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
  restrict_net(n);
  let limit = select(wanted.tolerance, wanted.keep, was_split) * raised(budget.coarser);
  // Outside by one plane of the picture's frustum: left, right, below, above, behind.
  var outside = 0u;
  var crosses = false;
  var size = net_size;
  var unit = vec3f(1.0);
  if wanted.pixels != 0u {
    // A picture has no such size.
    size = 1.0;
    unit = vec3f(wanted.half_size, 1.0);
    let near = wanted.near * inverse_size();
    let moved_x = moved(0u);
    let moved_y = moved(1u);
    let moved_w = moved(3u);
    outside = 31u;
    for (var r = 0u; r < ROWS; r++) {
      for (var c = 0u; c < COLUMNS; c++) {
        let p = net[r][c];
        let x = clipped(p, 0u, moved_x);
        let y = clipped(p, 1u, moved_y);
        let w = clipped(p, 3u, moved_w);
        outside &= select(0u, 1u, x < -w) | select(0u, 2u, x > w) | select(0u, 4u, y < -w) | select(0u, 8u, y > w)
          | select(0u, 16u, w < near);
        crosses = crosses || w < near;
        net[r][c] = vec4f(x, y, 0.0, w);
      }
    }
  }
  // What the near plane cuts has no size in the picture, however small it is.
  return outside == 0u && (crosses || error_bound(RATIONAL || wanted.pixels != 0u, unit) * size > limit);
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
