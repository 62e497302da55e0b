//! The oracle's words: plain lists of modules that remember how they came about.

use super::halving::{Net, Part};
use super::value::Value;
use std::rc::Rc;

/// A module's parameter.
#[derive(Clone, Copy, Debug)]
pub enum Param {
    Int(i32),
    Bool(bool),
    /// The language says f32; the oracle computes in f64 and leaves the rounding to the comparison.
    Float(f64),
    Vec2([f64; 2]),
    Vec3([f64; 3]),
    Vec4([f64; 4]),
}

impl Param {
    /// A value that has been coerced to the type of its field.
    pub fn new(value: Value) -> Param {
        match value {
            Value::Int(i) => Param::Int(i),
            Value::Bool(b) => Param::Bool(b),
            Value::Float(x) => Param::Float(x),
            Value::Vector(v) => match *v.as_slice() {
                [x, y] => Param::Vec2([x, y]),
                [x, y, z] => Param::Vec3([x, y, z]),
                [x, y, z, w] => Param::Vec4([x, y, z, w]),
                _ => panic!("{v:?} is no vector"),
            },
            other => panic!("no parameter of a module: {other:?}"),
        }
    }

    pub fn value(self) -> Value {
        match self {
            Param::Int(i) => Value::Int(i),
            Param::Bool(b) => Value::Bool(b),
            Param::Float(x) => Value::Float(x),
            Param::Vec2(v) => Value::Vector(v.to_vec()),
            Param::Vec3(v) => Value::Vector(v.to_vec()),
            Param::Vec4(v) => Value::Vector(v.to_vec()),
        }
    }

    /// The floats in it, none where it is no float.
    pub fn floats(&self) -> &[f64] {
        match self {
            Param::Int(_) | Param::Bool(_) => &[],
            Param::Float(x) => std::slice::from_ref(x),
            Param::Vec2(v) => v,
            Param::Vec3(v) => v,
            Param::Vec4(v) => v,
        }
    }
}

/// Bit by bit, as *keep* demands: 0.0 and −0.0 differ, a NaN is itself.
impl PartialEq for Param {
    fn eq(&self, other: &Param) -> bool {
        match (self, other) {
            (Param::Int(a), Param::Int(b)) => a == b,
            (Param::Bool(a), Param::Bool(b)) => a == b,
            (Param::Int(_) | Param::Bool(_), _) | (_, Param::Int(_) | Param::Bool(_)) => false,
            (a, b) => {
                let bits = |p: &Param| p.floats().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                bits(a) == bits(b)
            }
        }
    }
}

/// The shape of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// 2×2.
    Both,
    /// 1×2: splits columns (v) only.
    Columns,
    /// 2×1: splits rows (u) only.
    Rows,
}

/// One turn in a module's path: the block and the cell in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    pub shape: Shape,
    /// 0 or 1; 0 where the shape has one row.
    pub row: usize,
    /// 0 or 1; 0 where the shape has one column.
    pub column: usize,
}

impl Turn {
    /// The bits of the child in its block and how many they are.
    pub fn bits(self) -> (u64, u32) {
        match self.shape {
            Shape::Both => (2 * self.row as u64 + self.column as u64, 2),
            Shape::Columns => (self.column as u64, 1),
            Shape::Rows => (self.row as u64, 1),
        }
    }

    /// What the child takes of its parent along u and v.
    pub fn parts(self) -> (Part, Part) {
        let half = |second: usize| if second == 0 { Part::First } else { Part::Second };
        match self.shape {
            Shape::Both => (half(self.row), half(self.column)),
            Shape::Columns => (Part::Whole, half(self.column)),
            Shape::Rows => (half(self.row), Part::Whole),
        }
    }
}

/// Halvings along u and v since the root, and the row and column at that level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    pub du: u32,
    pub dv: u32,
    pub i: u64,
    pub j: u64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Module {
    pub symbol: String,
    pub params: Vec<Param>,
    /// Index of its root in the axiom.
    pub root: usize,
    pub path: Vec<Turn>,
    /// Shared with the module's other states as long as nothing splits it.
    pub net: Rc<Net>,
}

impl Module {
    /// How many bits of the order key the path takes: du + dv.
    pub fn key_bits(&self) -> u32 {
        self.path.iter().map(|turn| turn.bits().1).sum()
    }

    /// The children taken since the root, left-aligned in 64 bits.
    pub fn key(&self) -> u64 {
        assert!(self.key_bits() <= 62, "the order key holds at most 62 halvings");
        let mut free = 64;
        let mut key = 0;
        for turn in &self.path {
            let (bits, count) = turn.bits();
            free -= count;
            key |= bits << free;
        }
        key
    }

    pub fn cell(&self) -> Cell {
        let mut cell = Cell::default();
        for turn in &self.path {
            let (u, v) = turn.parts();
            if u != Part::Whole {
                cell = Cell { du: cell.du + 1, i: 2 * cell.i + turn.row as u64, ..cell };
            }
            if v != Part::Whole {
                cell = Cell { dv: cell.dv + 1, j: 2 * cell.j + turn.column as u64, ..cell };
            }
        }
        cell
    }

    /// The attribute `level`: the greater of the halvings along u and v.
    pub fn level(&self) -> u32 {
        let cell = self.cell();
        cell.du.max(cell.dv)
    }
}

/// The word between two steps, in depth-first order.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub modules: Vec<Module>,
    /// The axiom's nets, for bounds on rounding.
    pub roots: Rc<Vec<Rc<Net>>>,
}

impl Word {
    /// Σ|wᵢ pᵢ| for each control point of a module: its weights are products of entries of L and
    /// R, none negative, so the sum is what the path makes of the root's absolute values.
    pub fn magnitude(&self, module: &Module) -> Net {
        module.path.iter().fold(self.roots[module.root].absolute(), |net, turn| {
            let (u, v) = turn.parts();
            net.child(u, v)
        })
    }
}
