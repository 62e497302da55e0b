//! One step, written once. Read this second.
//!
//! A step rewrites every module of a chunk at once, in the passes listed here; each reads only
//! what passes before it have written whole. Both backends walk this list: the CPU runs the
//! function and the GPU the kernel of the same name (`src/cpu/NAME.rs`, `wgsl/NAME.wgsl`).
//!
//! ```text
//! measure         attributes of nets, where rules read any      nets → attributes
//! link            of linked words what contexts see            records → links
//! turtle          of curves: where the turtle stands        records → attributes
//! turtle_linked   the same of words with links
//! match_modules   which rule fires on each module               records → rules
//! claim           what rules of several predecessors take         rules → rules
//! count           how many modules come of it                   rules → counts
//! scan            where the first of them goes                  counts → offsets
//! emit            children: symbols, parameters, addresses, nets  → records, nets
//! emit_word       the same of curves, whose modules have no nets    → records
//! compact         which modules no rule can ever fire on again  rules → retired
//! retire          these, copied once to where they stay         → finished records, nets
//! ```
//!
//! Where the growth is a closed form (every module has c successors), `match_modules`, `count`,
//! `scan`, `compact` and `retire` are skipped: `emit` finds the rule by the symbol alone and writes
//! to c·i. Nothing decides an index but a scan.

/// A column: one array with an entry for every module of a chunk, or for the whole chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Records before the step.
    Records,
    /// Nets before the step.
    Nets,
    /// What the host gives, then for each module the attributes that rules read: [`super::measure`].
    Attributes,
    /// The rule that fires on each module: an index into the stage's rule table, whose last two
    /// rows are *keep* and *retired*.
    Rules,
    /// Modules that each module becomes.
    Counts,
    /// Exclusive prefix sum of the counts, and the total behind the last.
    Offsets,
    /// Records after the step.
    NextRecords,
    /// Nets after the step.
    NextNets,
    /// Prefix sums of the tiles of a scan, and the total behind the last.
    Sums,
    /// Rigid motions of tiles, or of modules: [`super::turtle`].
    Motions,
    /// The motion that goes from one chunk to the next.
    Carried,
    /// Indices of the retired modules in ascending order.
    Retired,
    /// Records of the retired modules.
    FinishedRecords,
    /// Nets of the retired modules.
    FinishedNets,
    /// Of linked words what modules hang on: four sections, each with a word for every module ([`super::links`]); of
    /// the turtle two.
    Links,
    /// Flags of the chunk: see [`Status`].
    Status,
    /// Uniforms of the system, what the host gives ([`super::given`]), constants, then the rule table
    /// ([`super::tables::rule_word`]), as vec4u.
    Environment,
    /// What the host says of the dispatch: see [`Extent`].
    Extent,
}

/// A pass of the step: its name, and its columns in the order of their bindings.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    pub name: &'static str,
    pub reads: &'static [Column],
    pub writes: &'static [Column],
}

impl Pass {
    /// What it binds, in order, and whether that is written. Of a linked word contexts and children read its links,
    /// behind all else.
    pub fn bindings(&self, linked: bool) -> Vec<(Column, bool)> {
        let links = linked && [MATCH.name, EMIT_WORD.name].contains(&self.name);
        let reads = self.reads.iter().map(|c| (*c, false));
        let written = reads.chain(self.writes.iter().map(|c| (*c, true)));
        written.chain(links.then_some((Links, false))).collect()
    }
}

use Column::*;

/// The attributes of nets.
pub const MEASURE: Pass =
    Pass { name: "measure", reads: &[Extent, Environment, Records, Nets], writes: &[Attributes] };
/// Where the turtle stands at each module, where a word is traced: a scan, as [`SCAN`].
pub const TURTLE: Pass =
    Pass { name: "turtle", reads: &[Extent, Records], writes: &[Attributes, Motions, Carried] };
/// The same where modules have links.
pub const TURTLE_LINKED: Pass =
    Pass { name: "turtle_linked", reads: &[Extent, Records], writes: &[Attributes, Motions, Links] };
/// What contexts see around the modules of a linked word; and, when it is known what they become, what their children
/// hang on.
pub const LINK: Pass = Pass { name: "link", reads: &[Extent, Environment, Records, Rules], writes: &[Links] };
/// Which rule fires on each module. Of a linked word it also reads its links, and so does `emit_word`.
pub const MATCH: Pass = Pass {
    name: "match_modules",
    reads: &[Extent, Environment, Records, Attributes],
    writes: &[Rules, Status],
};
/// Which rules fire of those that match, where some replace several modules of a curve.
pub const CLAIM: Pass = Pass { name: "claim", reads: &[Extent, Environment], writes: &[Rules, Sums, Status] };
/// How many modules come of each.
pub const COUNT: Pass = Pass { name: "count", reads: &[Extent, Environment, Rules], writes: &[Counts] };
/// Where the first of them goes.
pub const SCAN: Pass = Pass { name: "scan", reads: &[Extent, Counts], writes: &[Offsets, Sums] };
/// The children.
pub const EMIT: Pass = Pass {
    name: "emit",
    reads: &[Extent, Environment, Records, Nets, Rules, Offsets, Attributes],
    writes: &[NextRecords, NextNets, Status],
};
/// The children of a curve's modules, which have no nets and are never retired.
pub const EMIT_WORD: Pass = Pass {
    name: "emit_word",
    reads: &[Extent, Environment, Records, Rules, Offsets, Attributes],
    writes: &[NextRecords, Status],
};
/// Which modules are retired.
pub const COMPACT: Pass = Pass { name: "compact", reads: &[Extent, Rules], writes: &[Retired, Sums] };
/// The retired modules, copied to where they stay.
pub const RETIRE: Pass = Pass {
    name: "retire",
    reads: &[Extent, Records, Nets, Retired],
    writes: &[FinishedRecords, FinishedNets, Status],
};

/// All passes, in the order in which they run; of a curve `emit_word` takes the place of `emit`.
pub const PASSES: [Pass; 12] =
    [MEASURE, TURTLE, TURTLE_LINKED, LINK, MATCH, CLAIM, COUNT, SCAN, EMIT, EMIT_WORD, COMPACT, RETIRE];

/// What the rules may know of the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Clock {
    /// Steps done in this `derive`: the attribute `step`.
    pub step: u32,
    /// Steps done in the whole run: one of the things that a random number depends on.
    pub run_step: u32,
    /// The seed of the run.
    pub seed: u32,
}

/// What the host says of a dispatch; a uniform of 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Extent {
    /// Modules of the chunk.
    pub count: u32,
    /// Modules that fit in the buffers that the pass writes; nothing is written past them.
    pub capacity: u32,
    /// The rule id that `compact` looks for; of a curve, modules from the chunk's first to the end of the word, and for
    /// `emit_word` modules of the new word before it.
    pub wanted: u32,
    pub clock: Clock,
    /// Words that the host gives: where the measured attributes begin.
    pub given: u32,
    /// Not 0: every module is kept, since nothing fired in the step before and the derive ends there.
    pub halted: u32,
}

/// What a chunk says of a step; 32 bytes. Each word only ever rises during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Status {
    /// Not 0: some rule fired.
    pub fired: u32,
    /// Not 0: a child's address would not fit ([`MAX_HALVINGS`](super::layout::MAX_HALVINGS)).
    pub too_deep: u32,
    /// Bit s mod 32 is set if a module of symbol s is retired.
    pub retired_symbols: u32,
    /// 0, or the modules that `emit` would have had to write: more than the capacity.
    pub needed: u32,
    /// The same of `retire`.
    pub needed_finished: u32,
    /// Modules that are claimed by a rule which begins before: the chunk's first at first, then those behind its last.
    pub claimed: u32,
    pub reserved: [u32; 2],
}
