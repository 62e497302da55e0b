// The faces of a level: quads or triangles, from the closed forms that number vertices. Once a topology.
//
// An invocation a quad: reads 112 bytes of its root, from the caches, and writes 16 or 24.

import extent;

struct Params {
  count: u32,
  s: u32,
  // The first root.
  first: u32,
  reserved: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// For each root 28 words: of each corner its rank, and the edges owned before its owner and the owner; of each side the
// corners owned up to its owner, the edge, the owner, and whether the root runs along the edge.
@group(0) @binding(1) var<storage, read> sides: array<vec4u>;
// Corners and edges owned by each root and those before.
@group(0) @binding(2) var<storage, read> owned: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> faces: array<u32>;

const WORDS = 8u;

fn corner(root: u32, k: u32) -> u32 {
  let m = params.s - 1u;
  let c = sides[WORDS * root + k];
  return c.x + c.y * m + c.z * m * m;
}

// Point t, from 1, along side k as the root runs.
fn on_side(root: u32, k: u32, t: u32) -> u32 {
  let m = params.s - 1u;
  let side = sides[WORDS * root + 4u + k];
  return side.x + side.y * m + side.z * m * m + select(m - t, t - 1u, side.w != 0u);
}

fn vertex(root: u32, x: u32, y: u32) -> u32 {
  let s = params.s;
  let m = s - 1u;
  if y == 0u {
    if x == 0u { return corner(root, 0u); }
    if x == s { return corner(root, 1u); }
    return on_side(root, 0u, x);
  }
  if y == s {
    if x == 0u { return corner(root, 3u); }
    if x == s { return corner(root, 2u); }
    return on_side(root, 2u, s - x);
  }
  if x == 0u { return on_side(root, 3u, s - y); }
  if x == s { return on_side(root, 1u, y); }
  let after = owned[root];
  return after.x + after.y * m + root * m * m + (y - 1u) * m + x - 1u;
}

@compute @workgroup_size(WORKGROUP)
fn number_faces(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let index = linear(id, groups);
  if index >= params.count {
    return;
  }
  let s = params.s;
  let root = params.first + index / (s * s);
  let x = index % (s * s) % s;
  let y = index % (s * s) / s;
  let a = vertex(root, x, y);
  let b = vertex(root, x + 1u, y);
  let c = vertex(root, x + 1u, y + 1u);
  let d = vertex(root, x, y + 1u);
  if TRIANGLES {
    let at = 6u * index;
    faces[at] = a;
    faces[at + 1u] = b;
    faces[at + 2u] = c;
    faces[at + 3u] = a;
    faces[at + 4u] = c;
    faces[at + 5u] = d;
  } else {
    let at = 4u * index;
    faces[at] = a;
    faces[at + 1u] = b;
    faces[at + 2u] = c;
    faces[at + 3u] = d;
  }
}
