//! Nets of patch systems: where they come from, blocks that split them, and surfaces that branch.

use super::{Module, SymbolId};
use crate::language::expr::Expr;
use crate::language::syntax::Span;

/// `P(0) = file "teapot.bpt"`: each net of the source becomes one root, a module P(0).
#[derive(Clone, Debug)]
pub struct PatchStart {
    pub symbol: SymbolId,
    /// One for each field; they read uniforms at most.
    pub args: Vec<Expr>,
    pub source: PatchSource,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum PatchSource {
    /// All nets of a file, or the one with this index.
    File { path: String, index: Option<u32>, span: Span },
    /// Points row by row, `(degree u + 1) × (degree v + 1)`; x, y, z, not yet multiplied by the weight, and a weight of 1 where none was written.
    Inline { points: Vec<[f32; 4]>, span: Span },
    /// The final word of an earlier system of the file.
    System { name: String, span: Span },
}

/// A 1×2, 2×1 or 2×2 block; cells row by row (row = u, column = v).
#[derive(Clone, Debug)]
pub struct Block {
    pub rows: usize,
    pub columns: usize,
    pub cells: Vec<Cell>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Cell {
    Eps,
    Module(Module),
    Block(Block),
}

/// How smooth a net of a branching surface goes on from the net that it grows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// `join c0`: they share the edge.
    C0,
    /// `join c1`: across the edge the derivative is the same, too.
    C1,
}

/// An element of a surface that branches: `P(0) [ +(35) P(n-1) ] P(n-1)`. Each takes a slot but a branch, whose
/// elements do.
#[derive(Clone, Debug)]
pub enum SurfaceElement {
    Eps,
    /// A module with a net of its own.
    Net(Module),
    /// A symbol of the turtle, which turns or moves what follows on its axis. It has one argument, a float: degrees
    /// or a length.
    Turtle(Module),
    /// A net that is split as it grows.
    Block(Block),
    /// `[ … ]`: behind it the axis goes on from before.
    Branch(Vec<SurfaceElement>),
}

/// Calls `visit` on every module of a branching surface, in the order written.
pub fn surface_modules<'a>(word: &'a [SurfaceElement], visit: &mut dyn FnMut(&'a Module)) {
    fn in_block<'a>(block: &'a Block, visit: &mut dyn FnMut(&'a Module)) {
        for cell in &block.cells {
            match cell {
                Cell::Eps => {}
                Cell::Module(module) => visit(module),
                Cell::Block(inner) => in_block(inner, visit),
            }
        }
    }
    for element in word {
        match element {
            SurfaceElement::Eps => {}
            SurfaceElement::Net(module) | SurfaceElement::Turtle(module) => visit(module),
            SurfaceElement::Block(block) => in_block(block, visit),
            SurfaceElement::Branch(branch) => surface_modules(branch, visit),
        }
    }
}
