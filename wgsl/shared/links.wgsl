// Records by their index in a linked word: plan/layout.rs.

import address;

const LATERAL = 0x80000000u;
const NONE = 0x7fffffffu;
const END = 0xffffu;
// In the column of links: found, and the index.
const SETTLED = 0x40000000u;
const TARGET = 0x3fffffffu;
// Sections of that column: what is seen before a module and behind it, where what hangs on it ends, and what its
// children hang on.
const UP = 0u;
const DOWN = 1u;
const LAST = 2u;
const HANGS = 3u;

fn word_at(i: u32, at: u32) -> u32 {
  if i >= extent.count {
    return 0u;
  }
  let quad = records[i * QUADS + (at >> 2u)];
  return quad[at & 3u];
}

fn symbol_at(i: u32) -> u32 {
  if i >= extent.count {
    return END;
  }
  return word_at(i, 0u) & 0xffffu;
}

fn link_at(i: u32) -> u32 {
  if i >= extent.count {
    return NONE;
  }
  return word_at(i, LINK);
}
