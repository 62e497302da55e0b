//! Words of curve systems: their modules, how these hang together, and where they come from.

use super::{Module, SymbolId};
use crate::language::expr::{Expr, Value};
use crate::language::syntax::Span;

/// A part of a curve's axiom.
#[derive(Clone, Debug)]
pub enum CurveStart {
    /// Modules, written out; their arguments read uniforms at most.
    Word(CurveWord),
    /// `P(_, true) = file "c.csv"`: a module for each point.
    Points {
        symbol: SymbolId,
        /// One for each field; none where the point goes.
        args: Vec<Option<Expr>>,
        source: CurveSource,
        /// How far the ring is turned: this point comes first.
        shift: Option<Expr>,
        span: Span,
    },
    /// The final word of an earlier system of the file.
    System { name: String, shift: Option<Expr>, span: Span },
}

/// Modules of a curve in the order of the word, and how they hang together.
#[derive(Clone, Debug, Default)]
pub struct CurveWord {
    pub modules: Vec<Module>,
    /// One for each module.
    pub hangs: Vec<Hang>,
    /// Modules and `eps`.
    pub slots: u32,
}

/// What a module of a written word hangs on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hang {
    /// The module of the same word; none on what stands before the word.
    pub on: Option<usize>,
    /// It begins a branch.
    pub lateral: bool,
    /// It hangs on nothing at all: the first of a curve that the turtle begins.
    pub root: bool,
    /// Its place in the word, `eps` counted and brackets not.
    pub slot: u32,
}

impl CurveWord {
    /// The module that what follows the word hangs on; none if the word has nothing on its axis.
    pub fn exit(&self) -> Option<usize> {
        let mut at = None;
        for (n, hang) in self.hangs.iter().enumerate() {
            if hang.on == at && !hang.lateral {
                at = Some(n);
            }
        }
        at
    }
}

#[derive(Clone, Debug)]
pub enum CurveSource {
    /// All points of a file, or of the curve in it with this index.
    File { path: String, index: Option<u32>, span: Span },
    /// Vectors.
    Inline(Vec<Value>),
    /// The points of the final word of an earlier system.
    System { name: String, span: Span },
}
