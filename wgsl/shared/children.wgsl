// Which children a module has and where they go: shared by the mappings of emit.

// What is done with a module.
struct Emission {
  rule: u32,
  // Which directions are halved: bit 0 u, bit 1 v.
  halves: u32,
  // The cells that live, by 2·(half of u) + (half of v); none where nothing can be written.
  live: u32,
  // Where the first of them goes.
  first: u32,
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
  let end = e.first + ((word >> 8u) & 7u);
  if end > extent.capacity {
    atomicMax(&status.needed, end);
    e.live = 0u;
  } else if too_deep(m, e.halves) {
    atomicStore(&status.too_deep, 1u);
    e.live = 0u;
  }
  return e;
}

// Where cell c goes, or NOWHERE if it is erased.
fn place(first: u32, live: u32, c: u32) -> u32 {
  if (live & (1u << c)) == 0u {
    return NOWHERE;
  }
  return first + countOneBits(live & ((1u << c) - 1u));
}

fn write_child(rule: u32, c: u32, m: Record, halves: u32, at: u32) {
  if at != NOWHERE {
    write_record(at, with_address(successor(rule, c, m), m, halves, c >> 1u, c & 1u));
  }
}
