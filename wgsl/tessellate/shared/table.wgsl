// The leaves of a word by the cells that they are: tessellate/word.rs.

import hash;

struct Found {
  node: u32,
  depth: vec2u,
}

// The leaf of the word that is this cell, or NOWHERE.
fn leaf_at(root: u32, shape: u32, cell: vec2u) -> u32 {
  let mask = table[1];
  var slot = hash(root, shape, cell.x, cell.y) & mask;
  for (var probes = 0u; probes <= mask; probes++) {
    let entry = table[SLOTS + slot];
    if entry == 0u {
      break;
    }
    let n = nodes[entry - 1u];
    if n.x == root && (n.y & 0xffffu) == shape && n.z == cell.x && n.w == cell.y {
      return entry - 1u;
    }
    slot = (slot + 1u) & mask;
  }
  return NOWHERE;
}

// The leaf that covers a place: of the word, or the root where there is none.
fn base_of(root: u32, p: vec2u) -> Found {
  if !WORD {
    return Found(root, vec2u(0u));
  }
  for (var s = 0u; s < table[0]; s++) {
    let shape = table[2u + s];
    let depth = vec2u(shape & 0xffu, shape >> 8u);
    let leaf = leaf_at(root, shape, p >> (vec2u(LEVELS) - depth));
    if leaf != NOWHERE {
      return Found(leaf, depth);
    }
  }
  return Found(0u, vec2u(0u));
}
