// Which leaf covers a place, which touch a point, which lie across a side: tessellate/tree.rs.

import table;

struct Touching {
  // NOWHERE where patches share no vertices and this one is another's.
  node: u32,
  // NOWHERE where no corner of it is the point.
  corner: u32,
}

// Leaves around a point: four of a root, two for each patch of a curve, one for each corner of a point.
const INNER = 0u;
const CURVE = 1u;
const POINT = 2u;

struct Around {
  kind: u32,
  root: u32,
  p: vec2u,
  record: u32,
  // Along the curve.
  t: u32,
  side: u32,
  // Of the root, where the point is one.
  corner: u32,
  count: u32,
}

struct Across {
  root: u32,
  node: u32,
  side: u32,
  depth: u32,
  itself: bool,
  turn: bool,
}

fn locate(root: u32, p: vec2u) -> Found {
  var found = base_of(root, p);
  for (var level = 0u; level < LEVELS; level++) {
    let first = children[found.node];
    if first == LEAF {
      break;
    }
    found.depth += vec2u(1u);
    let bit = (p >> (vec2u(LEVELS) - found.depth)) & vec2u(1u);
    found.node = first + (bit.x | (bit.y << 1u));
  }
  return found;
}

fn around(root: u32, p: vec2u) -> Around {
  let x = side_at(p.x, 0u);
  let y = side_at(p.y, 1u);
  var a: Around;
  a.root = root;
  a.p = p;
  if x == NOWHERE && y == NOWHERE {
    a.kind = INNER;
    a.count = 4u;
    return a;
  }
  var corner = (x & 1u) | ((y & 1u) << 1u);
  if x == NOWHERE || y == NOWHERE {
    a.side = min(x, y);
    a.record = curve_at(root, a.side);
    if a.record != NOWHERE {
      a.kind = CURVE;
      a.t = turned(p[along(a.side)], is_reversed(root, a.side));
      a.count = 2u * entry_count(a.record);
      return a;
    }
    corner = side_corner(a.side, 0u);
  }
  a.kind = POINT;
  a.corner = corner;
  a.record = point_at(root, corner);
  a.count = entry_count(a.record);
  return a;
}

// Which end of the cell that covers `place` lies at `t`: 0, 1 or NOWHERE.
fn end_at(place: u32, depth: u32, t: u32) -> u32 {
  let size = FULL >> depth;
  let low = place & ~(size - 1u);
  if t == low {
    return 0u;
  }
  if t == low + size {
    return 1u;
  }
  return NOWHERE;
}

// The lattice cell at a root's side, at `place` along it.
fn beside(side: u32, place: u32) -> vec2u {
  let across = (side & 1u) * (FULL - 1u);
  if side < 2u {
    return vec2u(across, place);
  }
  return vec2u(place, across);
}

// Leaf k of those around a point.
fn touching(a: Around, k: u32) -> Touching {
  if a.kind == INNER {
    let place = a.p - vec2u(1u) + vec2u(k & 1u, k >> 1u);
    let found = locate(a.root, place);
    let x = end_at(place.x, found.depth.x, a.p.x);
    let y = end_at(place.y, found.depth.y, a.p.y);
    if x == NOWHERE || y == NOWHERE {
      return Touching(found.node, NOWHERE);
    }
    return Touching(found.node, x | (y << 1u));
  }
  if a.kind == POINT {
    let entry = entry_at(a.record, k);
    if !SHARED && (entry >> 2u) != a.root {
      return Touching(NOWHERE, NOWHERE);
    }
    let corner = entry & 3u;
    let found = locate(entry >> 2u, vec2u(corner & 1u, corner >> 1u) * (FULL - 1u));
    return Touching(found.node, corner);
  }
  let entry = entry_at(a.record, k >> 1u);
  let root = entry >> 3u;
  let side = (entry >> 1u) & 3u;
  if !SHARED && (root != a.root || side != a.side) {
    return Touching(NOWHERE, NOWHERE);
  }
  let turn = (entry & 1u) != 0u;
  let t = turned(a.t, turn);
  // Just before t along the curve, then just behind.
  let place = t - select(1u, 0u, turn == ((k & 1u) == 0u));
  let found = locate(root, beside(side, place));
  let end = end_at(place, found.depth[along(side)], t);
  if end == NOWHERE {
    return Touching(found.node, NOWHERE);
  }
  return Touching(found.node, side_corner(side, end));
}

// The leaf that owns the vertex at a point, and its corner there.
fn owner_of(root: u32, p: vec2u) -> Touching {
  let a = around(root, p);
  for (var k = 0u; k < a.count; k++) {
    let found = touching(a, k);
    if found.corner != NOWHERE {
      return found;
    }
  }
  return Touching(0u, 0u);
}

// How many leaves are asked about across a side.
fn across_count(n: vec4u, side: u32) -> u32 {
  if !on_border(n, side) {
    return 1u;
  }
  let record = curve_at(n.x, side);
  if record == NOWHERE {
    return 0u;
  }
  return entry_count(record);
}

// Leaf k of those across a side.
fn across(n: vec4u, side: u32, k: u32) -> Across {
  let c = along(side);
  let low = low_of(n);
  let size = size_of(n);
  let border = border_of(n, side);
  var a: Across;
  if side_at(border, 1u - c) == NOWHERE {
    var place = low;
    place[1u - c] = select(border, border - 1u, (side & 1u) == 0u);
    let found = locate(n.x, place);
    a.root = n.x;
    a.node = found.node;
    a.side = side ^ 1u;
    a.depth = found.depth[c];
    return a;
  }
  let entry = entry_at(curve_at(n.x, side), k);
  a.root = entry >> 3u;
  a.side = (entry >> 1u) & 3u;
  a.turn = ((entry & 1u) != 0u) != is_reversed(n.x, side);
  let place = select(low[c], FULL - low[c] - size[c], a.turn);
  let found = locate(a.root, beside(a.side, place));
  a.node = found.node;
  a.depth = found.depth[along(a.side)];
  a.itself = a.root == n.x && a.side == side;
  return a;
}

// Whether this leaf makes the triangles that its side adds to larger leaves across: no other with the very
// same side comes before it on the curve, and nothing finer lies there.
fn pushes(n: vec4u, side: u32, marks: u32, count: u32) -> bool {
  if ((marks >> side) & 1u) != 0u {
    return false;
  }
  if !on_border(n, side) {
    return true;
  }
  let own = depth_of(n)[along(side)];
  for (var k = 0u; k < count; k++) {
    let a = across(n, side, k);
    if a.itself {
      return true;
    }
    if a.depth == own {
      return false;
    }
  }
  return true;
}

// Whether a leaf across a side takes a triangle from this one.
fn takes(a: Across, own: u32) -> bool {
  return a.depth < own && !is_hole(nodes[a.node]);
}

// Whether a point is a corner of a cell.
fn has_corner(n: vec4u, p: vec2u) -> bool {
  let low = low_of(n);
  let high = low + size_of(n);
  return (p.x == low.x || p.x == high.x) && (p.y == low.y || p.y == high.y);
}

// The ends of a side as points of the root across it, in the order in which its leaf runs round.
fn foreign(n: vec4u, side: u32, to: Across) -> array<vec2u, 2> {
  let c = along(side);
  let size = size_of(n)[c];
  let low = select(low_of(n)[c], FULL - low_of(n)[c] - size, to.turn);
  let other = nodes[to.node];
  let k = along(to.side);
  var p = corner_of(other, side_corner(to.side, 0u));
  var q = p;
  p[k] = low;
  q[k] = low + size;
  if to.side == 0u || to.side == 3u {
    return array<vec2u, 2>(q, p);
  }
  return array<vec2u, 2>(p, q);
}
