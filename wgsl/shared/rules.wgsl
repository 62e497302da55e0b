// The rule table: a word a production behind the uniforms, then those of `keep` and `retired`.

fn rule_word(rule: u32) -> u32 {
  if ONLY_RULE_WORD != 0u {
    return ONLY_RULE_WORD;
  }
  let at = RULE_TABLE + rule;
  let quad = environment[at >> 2u];
  return quad[at & 3u];
}

// A word of the uniforms.
fn uniform_word(at: u32) -> u32 {
  let quad = environment[at >> 2u];
  return quad[at & 3u];
}

// Where a rule's word says that nothing is left on the axis: plan/tables/mod.rs.
const NO_EXIT = 255u;

// The child that what hung on the predecessor hangs on.
fn exit_of(rule: u32) -> u32 {
  return rule_word(rule) >> 24u;
}
