// How patches meet, as words: tessellate/topology.rs.

const ROOT_WORDS = 9u;

fn curve_at(root: u32, side: u32) -> u32 {
  return topology[root * ROOT_WORDS + side];
}

fn point_at(root: u32, corner: u32) -> u32 {
  return topology[root * ROOT_WORDS + 4u + corner];
}

fn orientation_of(root: u32) -> u32 {
  return topology[root * ROOT_WORDS + 8u] & 0xffu;
}

fn mirrors(root: u32) -> bool {
  return (countOneBits(orientation_of(root)) & 1u) != 0u;
}

fn least_depth(root: u32) -> u32 {
  return (topology[root * ROOT_WORDS + 8u] >> 8u) & 0xffu;
}

fn is_void(root: u32) -> bool {
  return ((topology[root * ROOT_WORDS + 8u] >> 20u) & 1u) != 0u;
}

fn is_reversed(root: u32, side: u32) -> bool {
  return ((topology[root * ROOT_WORDS + 8u] >> (16u + side)) & 1u) != 0u;
}

fn entry_count(record: u32) -> u32 {
  return topology[record];
}

fn entry_at(record: u32, k: u32) -> u32 {
  return topology[record + 1u + k];
}

// A place along a side as one along its curve, or the other way.
fn turned(t: u32, turn: bool) -> u32 {
  return select(t, FULL - t, turn);
}

fn collapsed(n: vec4u, side: u32) -> bool {
  return on_border(n, side) && curve_at(n.x, side) == NOWHERE;
}

// Which of the two triangles of a cell there are, as bits: the first has sides 2 and 1, the second 3 and 0.
// Three corners are one point where two neighbouring sides are.
fn halves_of(n: vec4u) -> u32 {
  let x = vec2<bool>(collapsed(n, 0u), collapsed(n, 1u));
  let y = vec2<bool>(collapsed(n, 2u), collapsed(n, 3u));
  if any(x) && any(y) {
    return 0u;
  }
  return select(1u, 0u, y.x || x.y) | select(2u, 0u, y.y || x.x);
}
