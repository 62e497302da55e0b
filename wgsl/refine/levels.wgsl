// One level or two of some roots, all in registers: an invocation a quad of the tile that is read, a point a name. No
// neighbour is looked up, since a tile has one row around its root; what is written is the next tile, and of the levels
// that are kept the vertices that the root owns.
//
// The body is written out by src/codegen/refine.rs: drivers unroll loops only up to a size, and an array that is left is
// several times slower. Two levels read 256 bytes a quad, most of them from the caches, and write 192 of vertices and 256
// of the next tile: a frame moves 18.5 bytes a vertex, 12 of them the vertex, and 20 flops.

import extent;
import pinned;
import masks;
import roots;

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> tiles: array<vec4f>;
@group(0) @binding(5) var<storage, read> weights: array<f32>;
@group(0) @binding(6) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> fine: array<f32>;
@group(0) @binding(8) var<storage, read_write> coarse: array<f32>;

// How much the sharp mask counts at point `t` of a side of `s` pieces after `level`: see mesh/rings.rs.
fn weight(extra: u32, side: u32, level: u32, at: u32, s: u32) -> f32 {
  let table = extras[extra + 16u + 2u * side];
  if table == NONE || at == 0u || at >= s {
    return 0.0;
  }
  let flags = extras[extra + 17u + 2u * side];
  if (flags & 2u) != 0u {
    return weights[table + level];
  }
  // The last two sides run down their axes.
  let t = select(at, s - at, ((flags & 1u) != 0u) == (side >= 2u));
  return weights[table + (2u << level) - 2u - level + t - 1u];
}

fn mended(smooth_point: vec3f, sharp_point: vec3f, weight: f32) -> vec3f {
  if weight == 1.0 {
    return sharp_point;
  }
  return select(smooth_point, blended(smooth_point, sharp_point, weight), weight > 0.0);
}

fn ring_of(extra: u32, corner: u32) -> vec4u {
  let at = extra + 4u * corner;
  return vec4u(extras[at], extras[at + 1u], extras[at + 2u], extras[at + 3u]);
}

fn put_fine(vertex: u32, p: vec3f) {
  let at = 3u * vertex - params.fine;
  fine[at] = p.x;
  fine[at + 1u] = p.y;
  fine[at + 2u] = p.z;
}

fn put_coarse(vertex: u32, p: vec3f) {
  let at = 3u * vertex - params.coarse;
  coarse[at] = p.x;
  coarse[at + 1u] = p.y;
  coarse[at + 2u] = p.z;
}

// How a root numbers its vertices on a grid of s × s quads: where its own begin, its sides, its inner rows (from (-1, -1)).
struct Numbers {
  begin: u32,
  sides: u32,
  inside: u32,
}

fn numbers(root: u32, own: vec4u, after: vec4u, s: u32) -> Numbers {
  let m = s - 1u;
  let before = root * m * m;
  let begin = own.x + own.y * m + before;
  let inside = after.x + after.y * m + before - m - 1u;
  return Numbers(begin, begin + countOneBits(own.z & 15u), inside);
}

@compute @workgroup_size(WORKGROUP)
fn refine(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let index = linear(id, groups);
  if index >= params.count {
    return;
  }
  let n = params.n;
  let quads = n * n;
  let root = params.first + index / quads;
  let x = index % quads % n;
  let y = index % quads / n;
  refine_quad(root, x, y, n);
}

import body;
