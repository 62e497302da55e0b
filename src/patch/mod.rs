//! Bézier control nets and words of them: the host's containers.
//!
//! Row index of a net = u, column = v. The normal is S_u × S_v. Points are (xw, yw, zw, w) in
//! memory; w = 1 when the net is not rational.
//!
//! [`evaluate`] gives points, derivatives and normals of a net, [`validate`] says whether a word
//! holds together, [`bspline`] makes nets of the control points of a B-spline.

pub mod axiom;
pub mod bspline;
pub mod evaluate;
pub mod validate;
pub mod values;

pub use crate::word::AxiomError;
pub use axiom::{Axiom, Root};
pub use bspline::ControlGrid;
pub use evaluate::{NetRef, Parameter, Sample};
pub use validate::{NetError, WordError};
pub use values::{Grid, Values};

pub use crate::word::Symbol;
use crate::word::{Params, Row};

/// The highest degree of a net along u or v; the lowest is 1.
pub const MAX_DEGREE: u8 = 8;

/// Points of a net of these degrees: (rows) × (columns).
pub fn net_points(degree: [u8; 2]) -> usize {
    (degree[0] as usize + 1) * (degree[1] as usize + 1)
}

/// Control points of one tensor-product Bézier patch.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// Degrees along u (rows − 1) and v (columns − 1).
    pub degree: [u8; 2],
    /// Row by row, `(degree[0] + 1) × (degree[1] + 1)` homogeneous points.
    pub points: Vec<[f32; 4]>,
}

impl Net {
    /// The net as the functions of [`evaluate`] take it, without a copy.
    ///
    /// # Panics
    /// When `points` does not hold `(degree[0] + 1) × (degree[1] + 1)` points or a degree is not
    /// in 1..=8.
    pub fn view(&self) -> NetRef<'_> {
        NetRef::new(self.degree, &self.points)
    }

    /// The same surface with u and v exchanged; its normals point the other way.
    pub fn transposed(&self) -> Net {
        let (rows, columns) = (self.degree[0] as usize + 1, self.degree[1] as usize + 1);
        let points =
            (0..columns).flat_map(|j| (0..rows).map(move |i| self.points[i * columns + j])).collect();
        Net { degree: [self.degree[1], self.degree[0]], points }
    }
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

impl Cell {
    /// Its rectangle in the root's unit square: `[[u, v] of its lower corner, of its upper one]`.
    ///
    /// Exact for every cell that can be written, since a power of two divides a 32-bit integer.
    pub fn uv(&self) -> [[f64; 2]; 2] {
        let side = |halvings: u8, index: u32| {
            let length = (-f64::from(halvings)).exp2();
            [f64::from(index) * length, (f64::from(index) + 1.0) * length]
        };
        let ([u0, u1], [v0, v1]) = (side(self.du, self.i), side(self.dv, self.j));
        [[u0, v0], [u1, v1]]
    }

    /// The level of the net: max(du, dv).
    pub fn level(&self) -> u8 {
        self.du.max(self.dv)
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Bounds {
    /// The smallest box around these points, or `None` when there are none.
    pub fn around(points: impl IntoIterator<Item = [f32; 3]>) -> Option<Bounds> {
        points.into_iter().fold(None, |bounds, point| {
            let Bounds { min, max } = bounds.unwrap_or(Bounds { min: point, max: point });
            Some(Bounds {
                min: std::array::from_fn(|k| min[k].min(point[k])),
                max: std::array::from_fn(|k| max[k].max(point[k])),
            })
        })
    }

    pub fn center(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.min[k] * 0.5 + self.max[k] * 0.5)
    }
}

/// One module of a word of patches, without its net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Module {
    /// Index into [`Word::symbols`].
    pub symbol: usize,
    /// Its row in the table of its symbol: see [`Word::params`].
    pub row: u32,
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
    /// Those of all modules, in columns.
    pub params: Params,
    /// One after the other, `(degree[0] + 1)(degree[1] + 1)` points a module, row by row.
    pub nets: Vec<[f32; 4]>,
}

impl Word {
    /// A word with one module a net, each a root of its own: what a file of nets is before any
    /// rule ran. The nets must all have the same degrees; `rational` is whether any weight is not 1.
    ///
    /// # Errors
    /// When the degrees differ, or a net does not hold together.
    pub fn from_nets(system: &str, symbol: &str, nets: &[Net]) -> Result<Word, WordError> {
        let degree = nets.first().map_or([3, 3], |net| net.degree);
        if let Some(net) = nets.iter().position(|net| net.degree != degree) {
            return Err(WordError::MixedDegrees { module: net, first: degree, found: nets[net].degree });
        }
        if let Some(net) = nets.iter().position(|net| net.points.len() != net_points(degree)) {
            let (found, expected) = (nets[net].points.len(), net_points(degree));
            return Err(WordError::Points { module: net, found, expected });
        }
        let points: Vec<[f32; 4]> = nets.iter().flat_map(|net| net.points.iter().copied()).collect();
        let symbols = vec![Symbol { name: symbol.into(), fields: Vec::new() }];
        let mut params = Params::new(&symbols);
        let root = |index: usize| Module {
            symbol: 0,
            row: params.push_record(0, &[], &[]),
            root: index as u32,
            key: 0,
            cell: Cell::default(),
        };
        let modules = (0..nets.len()).map(root).collect();
        let word = Word {
            system: system.into(),
            steps: 0,
            symbols,
            degree,
            rational: points.iter().any(|point| point[3] != 1.0),
            modules,
            params,
            nets: points,
        };
        word.validate()?;
        Ok(word)
    }

    /// The parameters of module `index`.
    pub fn params(&self, index: usize) -> Row<'_> {
        let module = &self.modules[index];
        self.params.row(module.symbol, module.row)
    }

    /// Points a net.
    pub fn net_points(&self) -> usize {
        net_points(self.degree)
    }

    /// The control points of module `index`, row by row.
    pub fn net(&self, index: usize) -> &[[f32; 4]] {
        let n = self.net_points();
        &self.nets[index * n..(index + 1) * n]
    }

    /// The net of module `index`, ready to evaluate.
    pub fn view(&self, index: usize) -> NetRef<'_> {
        NetRef::new(self.degree, self.net(index))
    }

    /// The box around all control points, which holds the surface too (weights are positive).
    /// `None` for a word without modules.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::around(self.nets.iter().map(|&[x, y, z, w]| [x / w, y / w, z / w]))
    }
}
