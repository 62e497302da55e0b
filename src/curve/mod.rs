//! Words of a curve: what they start from, and what a derivation reads back.

mod axiom;
mod polyline;
mod words;

pub use crate::word::AxiomError;
pub use axiom::{Axiom, Part, Root};
pub use polyline::{Note, Polyline, coordinates, notes};
pub use words::{Start, Words};

use crate::language::system::Topology;
use crate::word::{Column, Params, Row, Symbol};

/// A word of modules in order, with their parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub system: String,
    /// Steps done.
    pub steps: u32,
    /// Whether the last module is followed by the first.
    pub topology: Topology,
    pub symbols: Vec<Symbol>,
    pub modules: Vec<Module>,
    /// Those of all modules, in columns.
    pub params: Params,
}

/// A module of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Module {
    /// Index into [`Word::symbols`].
    pub symbol: usize,
    /// Its row in the table of its symbol: see [`Word::params`].
    pub row: u32,
    /// Its place in the derivation tree, hashed; 0 where the system draws no random numbers.
    pub path: u64,
    /// The module before it on its axis or, if it begins a branch, the one that it branches off: an index into
    /// [`Word::modules`]. None of the first of a curve, also of a ring.
    pub parent: Option<usize>,
    /// It begins a branch.
    pub lateral: bool,
}

impl Word {
    /// The parameters of module `index`.
    pub fn params(&self, index: usize) -> Row<'_> {
        let module = &self.modules[index];
        self.params.row(module.symbol, module.row)
    }

    /// The positions of the modules that have one, in order.
    pub fn points(&self) -> Vec<[f32; 3]> {
        self.positions().flatten().collect()
    }

    /// The position of each module: its first vector, missing coordinates 0.
    pub fn positions(&self) -> impl Iterator<Item = Option<[f32; 3]>> {
        let is_vector = |c: &&Column| matches!(c, Column::Vec2(_) | Column::Vec3(_) | Column::Vec4(_));
        let columns = 0..self.symbols.len();
        let columns: Vec<_> = columns.map(|s| self.params.columns(s).iter().find(is_vector)).collect();
        self.modules.iter().map(move |module| {
            let row = module.row as usize;
            match columns.get(module.symbol)?.as_ref()? {
                Column::Vec2(all) => all.get(row).map(|&[x, y]| [x, y, 0.0]),
                Column::Vec3(all) => all.get(row).copied(),
                Column::Vec4(all) => all.get(row).map(|&[x, y, z, _]| [x, y, z]),
                _ => None,
            }
        })
    }
}
