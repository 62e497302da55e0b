//! A stage as a program: which passes run over a chunk, with which entry points and columns, over how many elements.
//!
//! It is built once, from the tables, by the kind of the system (`src/plan/kind`). The CPU backend, the GPU backend that
//! waits and the derivation that is recorded loop over this one list; none of them knows what kind of word it rewrites.

use super::columns::Domain;
use super::step::{Column, Pass};
use super::tables::Stage;
use super::turtle::MOTION_WORDS;

/// The passes of a stage, in the order in which they run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// What stands beside a word that is one chunk. A backend that waits has several, and
    /// [joins](super::Backend::join) them itself.
    pub joining: Vec<Work>,
    /// What comes of a chunk. Where it is known without (the growth is a closed form), there are none. After them a
    /// backend that waits reads the [`totals`](Work::total), and makes room.
    pub counting: Vec<Work>,
    /// These write what comes.
    pub writing: Vec<Work>,
    /// These copy what is retired, and run over that alone.
    pub retiring: Vec<Work>,
}

/// A pass as a stage runs it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    pub pass: Pass,
    /// What its kernel binds, in order, and whether that is written.
    pub bindings: Vec<(Column, bool)>,
    pub calls: Vec<Call>,
}

/// Dispatches of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// Entry points, which take turns where there are several rounds.
    pub entries: &'static [&'static str],
    pub over: Over,
    /// Rounds of pointer jumping: as many as links take to reach through the word if each round doubles how far they
    /// reach, and so many more. None: one dispatch of each entry.
    pub rounds: Option<u32>,
}

/// The size of a dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// An invocation for each element.
    Each(Domain),
    /// A workgroup for each tile of elements: of a scan.
    Tiles(Domain),
    /// One workgroup.
    Group,
    /// As many invocations as the children of each module take: the tuning says how many.
    Children,
}

/// What a pass counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Total {
    /// Elements of the new word.
    New(Domain),
    /// Elements that are retired.
    Retired(Domain),
}

impl Call {
    pub(super) const fn once(entries: &'static [&'static str], over: Over) -> Call {
        Call { entries, over, rounds: None }
    }

    /// The entries of its dispatches over a word of `n` elements, in order.
    pub fn dispatches(&self, n: u64) -> impl Iterator<Item = &'static str> + use<> {
        let entries = self.entries;
        let count = match self.rounds {
            None => entries.len(),
            Some(more) => doublings(n, more).next_multiple_of(entries.len()),
        };
        (0..count).map(move |k| entries[k % entries.len()])
    }
}

/// Rounds in which links that double reach through `n` elements, and `more`.
fn doublings(n: u64, more: u32) -> usize {
    (u64::BITS - n.saturating_sub(1).leading_zeros() + more) as usize
}

impl Work {
    pub(super) fn new(pass: Pass, calls: Vec<Call>) -> Work {
        Work { pass, bindings: pass.row().bindings().collect(), calls }
    }

    /// One dispatch, an invocation for each module.
    pub(super) fn each(pass: Pass) -> Work {
        Work::new(pass, vec![Call::once(pass.row().entries, Over::Each(Domain::Module))])
    }

    /// A scan over the modules: tiles are reduced, one workgroup scans the tiles, each tile goes on from there.
    pub(super) fn scan(pass: Pass) -> Work {
        let over = [Over::Tiles(Domain::Module), Over::Group, Over::Tiles(Domain::Module)];
        let entries = pass.row().entries.chunks(1);
        Work::new(pass, entries.zip(over).map(|(entry, over)| Call::once(entry, over)).collect())
    }

    /// What it counts, and the column that holds the number: after what it holds of each tile.
    pub fn total(&self) -> Option<(Total, Column)> {
        match self.pass {
            Pass::Scan => Some((Total::New(Domain::Module), Column::Sums)),
            Pass::Compact => Some((Total::Retired(Domain::Module), Column::RetiredSums)),
            _ => None,
        }
    }
}

impl Program {
    /// All passes of a backend that waits, in order.
    pub fn works(&self) -> impl Iterator<Item = &Work> {
        self.counting.iter().chain(&self.writing).chain(&self.retiring)
    }

    /// Those of a derivation that is recorded: its word is one chunk, of which nothing is retired.
    pub fn recorded(&self) -> impl Iterator<Item = &Work> {
        let counting = self.counting.iter().filter(|work| work.pass != Pass::Compact);
        self.joining.iter().chain(counting).chain(&self.writing)
    }

    /// Whether some pass of it writes this column.
    pub fn writes(&self, column: Column) -> bool {
        self.works().any(|work| work.bindings.contains(&(column, true)))
    }
}

/// How many elements a column has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// One for each of a domain.
    Each(Domain),
    /// One for each tile of a scan over a domain.
    Tiles(Domain),
    /// One.
    One,
}

/// The size of a column that lives for one sweep: `words` for each of `of`, and `more` after them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub of: Length,
    pub words: usize,
    pub more: usize,
}

impl Size {
    /// Bytes, for `n` elements of the domain in tiles of so many.
    pub fn bytes(&self, n: u64, tile: u32) -> u64 {
        let elements = match self.of {
            Length::Each(_) => n,
            Length::Tiles(_) => n.div_ceil(u64::from(tile)),
            Length::One => 1,
        };
        4 * (elements * self.words as u64 + self.more as u64)
    }
}

/// The size of a column for a stage of this layout, where `given` words come from the host; none of those that are no
/// column of a sweep: what is stored, the environment and the extent.
pub fn size(column: Column, stage: &Stage, given: usize) -> Option<Size> {
    let each = |words, more| Size { of: Length::Each(Domain::Module), words, more };
    let tiles = |words, more| Size { of: Length::Tiles(Domain::Module), words, more };
    Some(match column {
        Column::Attributes => each(stage.row.words, given),
        Column::Rules | Column::Counts | Column::Retired => each(1, 0),
        Column::Offsets => each(1, 1),
        Column::Sums | Column::RetiredSums => tiles(1, 1),
        Column::TileMotions => tiles(MOTION_WORDS, 0),
        // Two halves, between which rounds go to and fro.
        Column::Motions => each(2 * MOTION_WORDS, 0),
        // Sections: see [`super::links`].
        Column::Links => each(4, 0),
        Column::Carried => Size { of: Length::One, words: MOTION_WORDS, more: 0 },
        Column::Status => Size { of: Length::One, words: size_of::<super::step::Status>() / 4, more: 0 },
        Column::Before(_) | Column::After(_) | Column::Finished(_) | Column::Environment | Column::Extent => {
            return None;
        }
    })
}
