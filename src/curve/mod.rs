//! Words of a curve: what they start from, and what a derivation reads back.

mod axiom;
mod polyline;
mod words;

pub use axiom::{Axiom, AxiomError, Part, Root};
pub use polyline::{Note, Polyline, coordinates, notes};
pub use words::{Start, Words};

use crate::language::expr::Value;
use crate::language::system::Topology;
use crate::patch::Symbol;

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
}

/// A module of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Module {
    /// Index into [`Word::symbols`].
    pub symbol: usize,
    pub params: Vec<Value>,
    /// Its place in the derivation tree, hashed; 0 where the system draws no random numbers.
    pub path: u64,
    /// The module before it on its axis or, if it begins a branch, the one that it branches off: an index into
    /// [`Word::modules`]. None of the first of a curve, also of a ring.
    pub parent: Option<usize>,
    /// It begins a branch.
    pub lateral: bool,
}

impl Word {
    /// The positions of the modules that have one, in order: see [`Module::position`].
    pub fn points(&self) -> Vec<[f32; 3]> {
        self.modules.iter().filter_map(Module::position).collect()
    }
}

impl Module {
    /// Its first vector, missing coordinates 0.
    pub fn position(&self) -> Option<[f32; 3]> {
        self.params.iter().find_map(|value| match *value {
            Value::Vec2([x, y]) => Some([x, y, 0.0]),
            Value::Vec3(p) => Some(p),
            Value::Vec4([x, y, z, _]) => Some([x, y, z]),
            _ => None,
        })
    }
}
