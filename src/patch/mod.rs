//! Bézier control nets and words of them: the host's containers.
//!
//! Row index of a net = u, column = v. The normal is S_u × S_v. Points are (xw, yw, zw, w) in
//! memory; w = 1 when the net is not rational.

use crate::language::Value;

/// Control points of one tensor-product Bézier patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// Degrees along u (rows − 1) and v (columns − 1).
    pub degree: [u8; 2],
    /// Row by row, `(degree[0] + 1) × (degree[1] + 1)` homogeneous points.
    pub points: Vec<[f32; 4]>,
}

/// Where a net lies in its root: halvings along u and v, then its row and column at that level.
///
/// In the root's unit square it covers u ∈ [i, i+1] / 2^du, v ∈ [j, j+1] / 2^dv.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    pub du: u8,
    pub dv: u8,
    pub i: u32,
    pub j: u32,
}

/// A symbol with the names and types of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    pub name: String,
    pub fields: Vec<crate::language::system::Field>,
}

/// One module of a word of patches, without its net.
#[derive(Clone, Debug, PartialEq)]
pub struct Module {
    /// Index into [`Word::symbols`].
    pub symbol: usize,
    pub params: Vec<Value>,
    /// Index of its root in the axiom.
    pub root: u32,
    /// The children taken since the root, two bits for a 2×2 block, one for 1×2 and 2×1,
    /// left-aligned: sorting by (root, key) is the depth-first order of the derivation.
    pub key: u64,
    pub cell: Cell,
}

/// A word of patches, in the order of the derivation tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub system: String,
    /// Steps done.
    pub steps: u32,
    pub symbols: Vec<Symbol>,
    pub degree: [u8; 2],
    pub rational: bool,
    pub modules: Vec<Module>,
    /// One after the other, `(degree[0] + 1)(degree[1] + 1)` points a module, row by row.
    pub nets: Vec<[f32; 4]>,
}

impl Word {
    /// Points a net.
    pub fn net_points(&self) -> usize {
        (self.degree[0] as usize + 1) * (self.degree[1] as usize + 1)
    }
    /// The control points of module `index`, row by row.
    pub fn net(&self, index: usize) -> &[[f32; 4]] {
        let n = self.net_points();
        &self.nets[index * n..(index + 1) * n]
    }
}

/// The axiom of a patch system: its roots in order.
#[derive(Clone, Debug)]
pub struct Axiom {
    pub roots: Vec<Root>,
}

/// One root: a module of the axiom.
#[derive(Clone, Debug)]
pub struct Root {
    /// Index into the system's symbols.
    pub symbol: usize,
    /// One for each field; they read uniforms at most.
    pub args: Vec<crate::language::Expr>,
    pub net: Net,
}
