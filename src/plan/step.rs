//! One step, written once. Read this second.
//!
//! A step rewrites every module of a chunk at once, in the passes listed here; each reads only
//! what passes before it have written whole. Which of them a stage runs is its
//! [program](super::program), which both backends walk: the CPU runs the function and the GPU the
//! kernel of the same name (`src/cpu/NAME.rs`, `wgsl/NAME.wgsl`).
//!
//! ```text
//! join            what stands beside a chunk                    records → records
//! measure         attributes of nets, where rules read any      nets → attributes
//! turtle          of curves: where the turtle stands            records → attributes
//! turtle_linked   the same of words with links
//! link            of linked words what contexts see             records → links
//! match_modules   which rule fires on each module               records → rules
//! claim           what rules of several predecessors take       rules → rules
//! hang            of linked words what children hang on         rules → links
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

use super::columns::Stored;

/// A column: one array with an entry for every element of a domain, for every tile of a scan, or for the whole chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Of the word before the step.
    Before(Stored),
    /// Of the word after the step.
    After(Stored),
    /// Of the retired modules.
    Finished(Stored),
    /// What the host gives, then for each module the attributes that rules read: [`super::measure`].
    Attributes,
    /// The rule that fires on each module: an index into the stage's rule table, whose last two
    /// rows are *keep* and *retired*.
    Rules,
    /// Modules that each module becomes.
    Counts,
    /// Exclusive prefix sum of the counts, and the total after the last.
    Offsets,
    /// Prefix sums of the tiles of a scan, and the total after the last.
    Sums,
    /// The same of the scan that finds retired modules.
    RetiredSums,
    /// Rigid motions of tiles: [`super::turtle`].
    TileMotions,
    /// Rigid motions of modules, in two halves.
    Motions,
    /// The motion that goes from one chunk to the next.
    Carried,
    /// Indices of the retired modules in ascending order.
    Retired,
    /// Of linked words what modules hang on: four sections, each with a word for every module ([`super::links`]); before
    /// these are known, two of the turtle.
    Links,
    /// Flags of the chunk: see [`Status`].
    Status,
    /// Uniforms of the system, what the host gives ([`super::given`]), constants, then the rule table
    /// ([`super::tables::rule_word`]), as vec4u.
    Environment,
    /// What the host says of the dispatch: see [`Extent`].
    Extent,
}

/// A pass of the step. Which of them a stage runs, and over what, is its [program](super::program).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    Join,
    Measure,
    Turtle,
    TurtleLinked,
    Link,
    Match,
    Claim,
    Hang,
    Count,
    Scan,
    Emit,
    EmitWord,
    Compact,
    Retire,
}

/// What is the same of a pass in every stage.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// As messages name it.
    pub name: &'static str,
    /// The kernel: `wgsl/NAME.wgsl`.
    pub kernel: &'static str,
    /// Its entry points, in the order in which they run.
    pub entries: &'static [&'static str],
    /// Its columns in the order of their bindings: those read, then those written.
    pub reads: &'static [Column],
    pub writes: &'static [Column],
    /// The kernel depends on the rules, not on the layout alone.
    pub of_rules: bool,
}

impl Row {
    /// What it binds, in order, and whether that is written.
    pub fn bindings(&self) -> impl Iterator<Item = (Column, bool)> + use<> {
        let reads = self.reads.iter().map(|&column| (column, false));
        reads.chain(self.writes.iter().map(|&column| (column, true)))
    }
}

use Column::*;
use Stored::{Nets, Records};

impl Pass {
    /// All of them.
    pub const ALL: [Pass; 14] = [
        Pass::Join,
        Pass::Measure,
        Pass::Turtle,
        Pass::TurtleLinked,
        Pass::Link,
        Pass::Match,
        Pass::Claim,
        Pass::Hang,
        Pass::Count,
        Pass::Scan,
        Pass::Emit,
        Pass::EmitWord,
        Pass::Compact,
        Pass::Retire,
    ];

    /// Its row of the table of passes.
    pub const fn row(self) -> Row {
        match self {
            Pass::Join => Row {
                name: "join",
                kernel: "join",
                entries: &["join"],
                reads: &[Extent],
                writes: &[Before(Records)],
                of_rules: false,
            },
            Pass::Measure => Row {
                name: "measure",
                kernel: "measure",
                entries: &["measure"],
                reads: &[Extent, Environment, Before(Records), Before(Nets)],
                writes: &[Attributes],
                of_rules: true,
            },
            // A scan, as `Scan`.
            Pass::Turtle => Row {
                name: "turtle",
                kernel: "turtle",
                entries: &["reduce", "spine", "turtle"],
                reads: &[Extent, Before(Records)],
                writes: &[Attributes, TileMotions, Carried],
                of_rules: true,
            },
            Pass::TurtleLinked => Row {
                name: "turtle_linked",
                kernel: "turtle_linked",
                entries: &["begin", "away", "back", "turtle_linked"],
                reads: &[Extent, Before(Records)],
                writes: &[Attributes, Motions, Links],
                of_rules: true,
            },
            Pass::Link => Row {
                name: "link",
                kernel: "link",
                entries: &["start", "link", "settle", "jump"],
                reads: &[Extent, Environment, Before(Records), Rules],
                writes: &[Links],
                of_rules: true,
            },
            Pass::Match => Row {
                name: "match_modules",
                kernel: "match_modules",
                entries: &["match_modules"],
                reads: &[Extent, Environment, Before(Records), Attributes],
                writes: &[Rules, Status],
                of_rules: true,
            },
            Pass::Claim => Row {
                name: "claim",
                kernel: "claim",
                entries: &["reduce", "spine", "claim"],
                reads: &[Extent, Environment],
                writes: &[Rules, Sums, Status],
                of_rules: true,
            },
            // The same kernel as `Link`, when it is known what modules become.
            Pass::Hang => Row { name: "hang", entries: &["unhang", "rehang"], ..Pass::Link.row() },
            Pass::Count => Row {
                name: "count",
                kernel: "count",
                entries: &["count"],
                reads: &[Extent, Environment, Rules],
                writes: &[Counts],
                of_rules: true,
            },
            Pass::Scan => Row {
                name: "scan",
                kernel: "scan",
                entries: &["reduce", "spine", "scan"],
                reads: &[Extent, Counts],
                writes: &[Offsets, Sums],
                of_rules: false,
            },
            Pass::Emit => Row {
                name: "emit",
                kernel: "emit",
                entries: &["emit"],
                reads: &[Extent, Environment, Before(Records), Before(Nets), Rules, Offsets, Attributes],
                writes: &[After(Records), After(Nets), Status],
                of_rules: true,
            },
            Pass::EmitWord => Row {
                name: "emit_word",
                kernel: "emit_word",
                entries: &["emit_word"],
                reads: &[Extent, Environment, Before(Records), Rules, Offsets, Attributes],
                writes: &[After(Records), Status],
                of_rules: true,
            },
            Pass::Compact => Row {
                name: "compact",
                kernel: "compact",
                entries: &["reduce", "spine", "compact"],
                reads: &[Extent, Rules],
                writes: &[Retired, RetiredSums],
                of_rules: false,
            },
            Pass::Retire => Row {
                name: "retire",
                kernel: "retire",
                entries: &["retire"],
                reads: &[Extent, Before(Records), Before(Nets), Retired],
                writes: &[Finished(Records), Finished(Nets), Status],
                of_rules: false,
            },
        }
    }
}

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

/// What the host says of a dispatch; a uniform of 48 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Extent {
    /// Modules of the chunk; for `retire` those that are retired.
    pub count: u32,
    /// Modules that fit in the buffers that the pass writes; nothing is written past them.
    pub capacity: u32,
    /// The rule id that `compact` looks for.
    pub wanted: u32,
    pub clock: Clock,
    /// Words that the host gives: where the measured attributes begin.
    pub given: u32,
    /// Not 0: every module is kept, since nothing fired in the step before and the derive ends there.
    pub halted: u32,
    /// Where modules have neighbours: modules of the word before the chunk, and from the chunk's first to the end.
    pub before: u32,
    pub behind: u32,
    /// Modules of the new word before those that come of the chunk.
    pub made: u32,
    pub reserved: u32,
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
