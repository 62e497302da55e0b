//! A schedule to be recorded: every sweep that there may be, in order, with what the device needs to decide
//! between them.
//!
//! Where nobody waits for a device, no step knows on the host how long the word is, nor whether anything fired.
//! So all sweeps are recorded, and between them the device says how many modules there are, what time it is, and
//! whether a `derive until terminal` has come to its end, after which its sweeps keep every module as it is.

use super::derive::StageId;
use super::schedule::Act;
use super::{Error, Plan};

/// The most sweeps that a recorded schedule may have.
pub const MOST_TURNS: usize = 4096;

/// Bits of [`Turn::flags`]: the last sweep of its step, of its derive; a derive that ends when nothing fires.
pub const ENDS_STEP: u32 = 1;
pub const ENDS_DERIVE: u32 = 2;
pub const UNTIL_TERMINAL: u32 = 4;
/// What it makes of nothing is the point at which a turtle starts.
pub const STARTS: u32 = 8;

/// One sweep of a recorded schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    pub stage: StageId,
    /// Steps of its derive that come before.
    pub step: u32,
    /// What every module becomes, where the growth is closed; else 0.
    pub growth: u32,
    /// [`ENDS_STEP`] and the others.
    pub flags: u32,
}

/// A turn as the kernel `proceed` reads it: a uniform of 16 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct TurnWords {
    /// Which one it is: the slot of its extent.
    pub index: u32,
    pub growth: u32,
    pub flags: u32,
    /// Modules whose children a workgroup of the next sweep writes.
    pub children: u32,
}

/// What a recorded derivation says of itself; 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Progress {
    /// Modules of the word; 0 where it did not come to its end.
    pub modules: u32,
    /// Modules that the longest word on the way has. Where there was no room for one, those behind it were not
    /// derived, and may be longer.
    pub needed: u32,
    /// Modules that there is room for.
    pub capacity: u32,
    /// Not 0: a net was halved more often than an address can hold.
    pub too_deep: u32,
    /// Steps done, without those that a derive until terminal had no use for.
    pub steps: u32,
    /// Derivations recorded, this one included.
    pub frame: u32,
    /// Of the step that runs: whether a rule fired.
    pub fired: u32,
    /// Of the derive that runs: whether it has come to its end.
    pub halted: u32,
}

impl Progress {
    /// Whether the word is what the schedule derives.
    pub fn complete(&self) -> bool {
        self.needed <= self.capacity && self.too_deep == 0
    }
}

/// The sweeps of a schedule.
///
/// # Errors
/// [`Error::Value`] where they are more than [`MOST_TURNS`].
pub fn turns(plan: &Plan, schedule: &[Act]) -> Result<Vec<Turn>, Error> {
    let mut turns = Vec::new();
    for act in schedule {
        let derive = act.rewrite();
        let stages = &plan.tables.rule_sets[derive.rule_set].stages;
        let sweeps = u64::from(derive.count) * stages.len() as u64;
        if turns.len() as u64 + sweeps > MOST_TURNS as u64 {
            let message = format!(
                "the schedule makes {} sweeps or more over the word; a derivation that is recorded may make \
                 {MOST_TURNS}: derive fewer steps",
                turns.len() as u64 + sweeps
            );
            return Err(Error::Value(message, Some(derive.span)));
        }
        for step in 0..derive.count {
            for (n, stage) in stages.iter().enumerate() {
                let last = n + 1 == stages.len();
                let ends = [
                    (last, ENDS_STEP),
                    (last && step + 1 == derive.count, ENDS_DERIVE),
                    (derive.until_terminal, UNTIL_TERMINAL),
                    (matches!(act, Act::Trace { .. }), STARTS),
                ];
                turns.push(Turn {
                    stage: StageId { rule_set: derive.rule_set, stage: n },
                    step,
                    growth: stage.closed.unwrap_or(0),
                    flags: ends.iter().filter(|(is, _)| *is).map(|(_, bit)| bit).sum(),
                });
            }
        }
    }
    Ok(turns)
}
