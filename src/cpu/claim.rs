//! Which rules fire of those that match, where some replace several modules.

/// From left to right and without overlap: what a rule claims behind its first module becomes `claimed`, the id of
/// nothing. `state` modules are claimed by what stands before; returned is how many are by what stands last.
pub fn claim(words: &[u32], claimed: u32, state: u32, rules: &mut [u32]) -> u32 {
    rules.iter_mut().fold(state, |state, rule| match state {
        0 => words[*rule as usize] >> 16 & 7,
        _ => {
            *rule = claimed;
            state - 1
        }
    })
}
