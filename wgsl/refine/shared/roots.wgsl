// What kernels know of a root: 24 words. The points of its neighbourhood, 4 × 4; corners and edges owned by the roots before
// it; which corners (bits 0 to 3) and sides (4 to 7) it owns; where `extras` has the rest, or NONE; corners and edges owned
// by it and those before.
const ROOT = 6u;

@group(0) @binding(2) var<storage, read> roots: array<vec4u>;
// Of a root that is not regular: for each corner where its ring begins, or NONE, the ring's size, and which of its points
// stand beside the corner; for each side where its weights begin, or NONE, and whether the root runs along its edge (1) and
// one weight a level serves all of it (2).
@group(0) @binding(3) var<storage, read> extras: array<u32>;
@group(0) @binding(4) var<storage, read> rings: array<vec4f>;

struct Params {
  // Invocations.
  count: u32,
  zero: u32,
  // Quads along a side of each tile that is read.
  n: u32,
  // Of these tiles, counted from the roots.
  level: u32,
  // The first root of this dispatch, and the root of the first tile.
  first: u32,
  chunk: u32,
  // Floats before those that are bound, of both levels.
  fine: u32,
  coarse: u32,
}
