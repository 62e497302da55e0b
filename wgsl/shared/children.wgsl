// Which children a module has and where they go: shared by the mappings of emit.

import cell;
import matching;
import successors;
import write_record;

// What is done with a module.
struct Emission {
  rule: u32,
  // Which directions are halved: bit 0 u, bit 1 v.
  halves: u32,
  // The cells that live, by 2·(half of u) + (half of v). Not changed where they do not fit, so that
  // it stays a constant where the rule word is one, and tests of it fold away.
  live: u32,
  // Where the first of them goes.
  first: u32,
  // Whether the children can be written.
  fits: bool,
}

fn emission(i: u32, m: Record) -> Emission {
  var e: Emission;
  if CLOSED != 0u {
    e.rule = matching_rule(m);
    e.first = i * CLOSED;
  } else {
    e.rule = rules[i];
    e.first = offsets[i];
  }
  let word = rule_word(e.rule);
  e.halves = word & 3u;
  e.live = (word >> 4u) & 15u;
  let end = e.first + ((word >> 8u) & 255u);
  e.fits = true;
  if end > extent.capacity {
    atomicMax(&status.needed, end);
    e.fits = false;
  } else if too_deep(m, e.halves) {
    atomicStore(&status.too_deep, 1u);
    e.fits = false;
  }
  return e;
}

fn lives(e: Emission, c: u32) -> bool {
  return (e.live & (1u << c)) != 0u;
}

// Where cell c goes, if it lives.
fn place(e: Emission, c: u32) -> u32 {
  return e.first + countOneBits(e.live & ((1u << c) - 1u));
}

fn write_child(e: Emission, c: u32, m: Record) {
  if lives(e, c) {
    write_record(place(e, c), with_address(successor(e.rule, c, m), m, e.halves, c >> 1u, c & 1u));
  }
}
