//! Which flags belong to systems of which kind.

use super::{Failure, flags};
use burgeon::language::system::{Kind, System};

#[derive(Clone, Copy, PartialEq, Eq)]
enum Of {
    Patches,
    Curves,
}
use Of::{Curves, Patches};

/// A flag that systems of one kind alone have, and whether it is given.
type Row<F> = (&'static str, Of, fn(&F) -> bool);

const DERIVE: [Row<flags::Derive>; 2] =
    [("--bspline", Patches, |f| f.bspline), ("--eye", Patches, |f| f.view.eye.is_some())];

const RUN: [Row<flags::Run>; 11] = [
    ("--grid", Patches, |f| f.grid.is_some()),
    ("--tolerance", Patches, |f| f.fineness.tolerance.is_some()),
    ("--min-depth", Patches, |f| f.fineness.min_depth.is_some()),
    ("--max-depth", Patches, |f| f.fineness.max_depth.is_some()),
    ("--wireframe", Patches, |f| f.drawing.wireframe),
    ("--by-symbol", Patches, |f| f.by_symbol),
    ("--sweep", Curves, |f| !f.words.sweep.is_empty()),
    ("--seeds", Curves, |f| f.words.seeds.is_some()),
    ("--each", Curves, |f| f.words.each),
    ("--points", Curves, |f| f.points),
    ("--control", Curves, |f| f.control),
];

/// Refuses flags of `run` that the system's kind has not.
pub fn check_run(flags: &flags::Run, system: &System) -> Result<(), Failure> {
    let mut wrong = strange(&DERIVE, &flags.derive, system);
    wrong.extend(strange(&RUN, flags, system));
    refuse(&wrong, system)
}

/// The same of a command that derives and has no other flags of kinds.
#[cfg_attr(not(feature = "gpu"), expect(dead_code))]
pub fn check(flags: &flags::Derive, system: &System) -> Result<(), Failure> {
    refuse(&strange(&DERIVE, flags, system), system)
}

/// The flags that are given and belong to the other kind.
fn strange<F>(rows: &[Row<F>], flags: &F, system: &System) -> Vec<&'static str> {
    let own = kind(system);
    let given = rows.iter().filter(|(_, of, given)| own.is_some_and(|own| *of != own) && given(flags));
    given.map(|&(flag, ..)| flag).collect()
}

/// None of what has no plan: that is said before any flag is looked at.
fn kind(system: &System) -> Option<Of> {
    match system.kind {
        Kind::Patch { .. } => Some(Patches),
        Kind::Curve(_) => Some(Curves),
        Kind::Mesh => None,
    }
}

fn refuse(flags: &[&str], system: &System) -> Result<(), Failure> {
    let (flags, are) = match flags {
        [] => return Ok(()),
        [one] => (one.to_string(), "is"),
        [others @ .., last] => (format!("{} and {last}", others.join(", ")), "are"),
    };
    let (other, own) = match kind(system) {
        Some(Curves) => ("patches", "curves"),
        _ => ("curves", "patches"),
    };
    let name = &system.name;
    Err(Failure::Usage(format!("error: {flags} {are} for {other}, and {name} is a system of {own}")))
}
