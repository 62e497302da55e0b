// What was given and measured before anything is matched: first the values that the host gives,
// then a row of MEASURED words a module.

fn measured_word(m: Record, word: u32) -> u32 {
  return attributes[extent.given + m.index * MEASURED + word];
}

// A word of what the host gives, the index clamped.
fn given_word(at: i32) -> u32 {
  return attributes[min(u32(at), max(extent.given, 1u) - 1u)];
}
