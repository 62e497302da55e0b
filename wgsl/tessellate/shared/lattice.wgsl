// Cells of a root and the lattice of their corners: tessellate/lattice.rs.

const LEVELS = 24u;
const FULL = 1u << LEVELS;
const NOWHERE = 0xffffffffu;
const LEAF = 0u;

// Bits of a node's marks: tessellate/passes.rs.
const FINER = 15u;
const OWNS = 4u;
const FAN = 256u;

// What a pass works on: `count` nodes from `first` on. As `Extent` for the scans: `count` comes first.
struct Range {
  count: u32,
  first: u32,
  level: u32,
  // Of the range that holds all nodes: those that there would be with room for them.
  needed: u32,
  reserved: vec4u,
}

// Room, and where output begins in the caller's buffers.
struct Sizes {
  nodes: u32,
  vertices: u32,
  indices: u32,
  // Words of `counts` and `offsets` that belong to vertices; those of triangles stand behind.
  section: u32,
  first_index: u32,
  base_vertex: u32,
  // Of the range of all nodes.
  all: u32,
  tile: u32,
  // Words from what is bound to the first index, and to the draw's arguments.
  index_word: u32,
  draw_word: u32,
  reserved: vec2u,
}

// More than 65,535 workgroups need two dimensions: invocations are counted along x, then y.
fn linear(id: vec3u, groups: vec3u) -> u32 {
  return id.x + id.y * groups.x * WORKGROUP;
}

fn depth_of(n: vec4u) -> vec2u {
  return vec2u(n.y & 0xffu, (n.y >> 8u) & 0xffu);
}

fn size_of(n: vec4u) -> vec2u {
  return vec2u(FULL) >> depth_of(n);
}

fn low_of(n: vec4u) -> vec2u {
  return n.zw * size_of(n);
}

// Corner c: bit 0 of c is its end along x, bit 1 along y.
fn corner_of(n: vec4u, c: u32) -> vec2u {
  return low_of(n) + vec2u(c & 1u, c >> 1u) * size_of(n);
}

fn centre_of(n: vec4u) -> vec2u {
  return low_of(n) + (size_of(n) >> vec2u(1u));
}

fn is_hole(n: vec4u) -> bool {
  return (n.y >> 31u) != 0u;
}

fn quarter_of(n: vec4u, c: u32) -> vec4u {
  return vec4u(n.x, n.y + 0x101u, (n.z << 1u) | (c & 1u), (n.w << 1u) | (c >> 1u));
}

// The coordinate that runs along a side: sides 0, 1 at the ends of x, 2, 3 of y.
fn along(side: u32) -> u32 {
  return select(0u, 1u, side < 2u);
}

// The corner at an end of a side.
fn side_corner(side: u32, end: u32) -> u32 {
  if side < 2u {
    return (side & 1u) | (end << 1u);
  }
  return end | ((side & 1u) << 1u);
}

// The corners of a side in the order in which a triangle of the cell runs along it: sides 0 and 3 from their
// high end.
fn side_around(side: u32) -> vec2u {
  let falls = select(0u, 1u, side == 0u || side == 3u);
  return vec2u(side_corner(side, falls), side_corner(side, 1u - falls));
}

// The side of a root where a coordinate has this value, or NOWHERE.
fn side_at(value: u32, coordinate: u32) -> u32 {
  if value == 0u {
    return coordinate * 2u;
  }
  if value == FULL {
    return coordinate * 2u + 1u;
  }
  return NOWHERE;
}

// The place of a side across itself.
fn border_of(n: vec4u, side: u32) -> u32 {
  return corner_of(n, side_corner(side, 0u))[1u - along(side)];
}

fn on_border(n: vec4u, side: u32) -> bool {
  return side_at(border_of(n, side), 1u - along(side)) != NOWHERE;
}
