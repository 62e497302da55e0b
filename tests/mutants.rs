//! Kernels broken on purpose: the tests must see each.

use crate::tier;
use burgeon::codegen::{Edit, GENERATED};
use burgeon::gpu::Engine;
use std::path::Path;

/// A file of the kernels, what stands there, and what takes its place.
pub type Mutant = (&'static str, &'static str, &'static str);

/// The mutants to try: of each file the first, or all.
pub fn sample(list: &[Mutant]) -> Vec<Mutant> {
    tier::sample(list.iter().copied(), |&(file, ..)| vec![file])
}

/// Where a file of the kernels is.
fn path_of(file: &str) -> String {
    ["wgsl/tessellate/shared", "wgsl/tessellate", "wgsl/refine/shared", "wgsl/refine", "wgsl/shared", "wgsl"]
        .map(|folder| format!("{folder}/{file}.wgsl"))
        .into_iter()
        .find(|path| Path::new(path).exists())
        .unwrap_or_else(|| panic!("{file}.wgsl"))
}

/// Says if the text is there no more, or if a device whose kernels are broken like this does what it should.
pub fn unseen(
    engine: &Engine,
    (file, find, replace): Mutant,
    difference: impl Fn(&Engine) -> Option<String>,
) -> Option<String> {
    // What rules become is no file.
    let path = if file == GENERATED { file.to_string() } else { path_of(file) };
    if file != GENERATED {
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        if !text.contains(find) {
            return Some(format!("{path} has no `{find}` any more"));
        }
    }
    match difference(&engine.clone().with_edit(Edit { file, find, replace })) {
        None => Some(format!("{path}: `{find}` → `{replace}` is not seen")),
        Some(difference) => {
            println!("{path}: `{find}` → `{replace}`: {difference}");
            None
        }
    }
}

/// Fails with all that was said.
#[track_caller]
pub fn assert_seen(unseen: impl Iterator<Item = String>) {
    let unseen: Vec<String> = unseen.collect();
    assert!(unseen.is_empty(), "{}", unseen.join("\n"));
}
