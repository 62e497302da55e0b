//! Random numbers, from the requirement: a hash of the seed, the step, the path and the site.

/// Mixes a word into a hash. Frozen for ever by the vectors of the tests.
pub fn hash(state: u32, word: u32) -> u32 {
    let mut h = (state ^ word).wrapping_mul(0x9e37_79b1).wrapping_add(0x85eb_ca77);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}

/// A path of curve words: 64 bits, the upper word first.
pub type Path = [u32; 2];

/// The path of a module of the axiom.
pub fn root(index: usize) -> Path {
    [0, index as u32]
}

/// path(child) = hash(path(parent), slot).
pub fn child(parent: Path, slot: u32) -> Path {
    let high = hash(parent[0], slot);
    [high, hash(parent[1], high)]
}

/// Identifies a rule: its label, or its index in the group, as FNV-1a.
pub fn rule_site(label: Option<&str>, index: usize) -> u32 {
    let index = (index as u32).to_le_bytes();
    let bytes = label.map_or(&index[..], str::as_bytes);
    bytes.iter().fold(0x811c_9dc5, |h, b| (h ^ u32::from(*b)).wrapping_mul(0x0100_0193))
}

/// The draw among a rule's alternatives: a call of its own.
pub const CHOICE: u32 = u32::MAX;

/// The hash of one call in a rule, on one module, in one step of the whole run.
pub fn draw(seed: u32, step: u32, path: Path, site: u32, call: u32) -> u32 {
    [step, path[0], path[1], site, call].into_iter().fold(seed, hash)
}

/// `rand()`, `rand(a, b)`, `randn()`.
pub fn number(function: &str, bounds: &[f64], drawn: u32) -> f64 {
    let unit = f64::from(drawn >> 8) / f64::from(1 << 24);
    match (function, bounds) {
        ("rand", []) => unit,
        ("rand", [low, high]) => low + (high - low) * unit,
        ("randn", []) => {
            // Twelve slices of 16 bits, less their mean: integer until the last multiply.
            let words = (0..6).map(|n| hash(drawn, n));
            let sum: i64 = words.map(|w| i64::from(w >> 16) + i64::from(w & 0xffff)).sum();
            (sum - 6 * 65_535) as f64 / 65_536.0
        }
        other => panic!("no random number: {other:?}"),
    }
}

/// The alternative that is drawn; `None` if all weights are 0 or less.
pub fn choice(weights: &[f64], drawn: u32) -> Option<usize> {
    // In 65,536ths, the whole below 2^31. The weights are floats of the language, so f32.
    let most = 32_767.0 / weights.len() as f32;
    let fixed = |w: &f64| u64::from(((*w as f32).clamp(0.0, most) * 65_536.0).round_ties_even() as u32);
    let fixed: Vec<u64> = weights.iter().map(fixed).collect();
    let total: u64 = fixed.iter().sum();
    let mut left = (u64::from(drawn) * total) >> 32;
    fixed.iter().position(|weight| {
        let here = left < *weight;
        left = left.wrapping_sub(*weight);
        here
    })
}
