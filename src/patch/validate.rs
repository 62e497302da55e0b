//! Does a word hold together? Readers and tests ask; the engine never needs to.

use super::{Cell, MAX_DEGREE, Module, Net, Word, net_points};
use crate::language::expr::Type;
use crate::word::{Column, ParamsError, Symbol};
use thiserror::Error;

/// What is wrong with a word, naming the module.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WordError {
    #[error("the degrees {0:?} are not both in 1..=8")]
    Degree([u8; 2]),
    #[error("net {module} has the degrees {found:?}, those before it {first:?}; a word has one kind of net")]
    MixedDegrees { module: usize, first: [u8; 2], found: [u8; 2] },
    #[error("net {module} has {found} points where its degrees ask for {expected}")]
    Points { module: usize, found: usize, expected: usize },
    #[error("the word has {found} points where its {modules} modules ask for {expected}")]
    Nets { modules: usize, found: usize, expected: usize },
    #[error("module {module} has the symbol {symbol}, but the word names only {symbols}")]
    Symbol { module: usize, symbol: usize, symbols: usize },
    #[error("module {module} ({symbol}) has {found} parameters where {symbol} declares {expected}")]
    Arity { module: usize, symbol: String, found: usize, expected: usize },
    #[error("parameter {field} of module {module} ({symbol}) is of type {found}, declared as {expected}")]
    Parameter { module: usize, symbol: String, field: String, found: Type, expected: Type },
    #[error("module {module} ({symbol}) has row {row} of the parameters of {symbol}, which has {rows} rows")]
    Row { module: usize, symbol: String, row: u32, rows: u32 },
    #[error("module {module} lies in the cell {cell:?}, which is outside its root")]
    Cell { module: usize, cell: Cell },
    #[error("module {module} does not follow the one before it in the order of the derivation tree")]
    Order { module: usize },
    #[error("point {point} of module {module} is {value:?}; its coordinates must be finite")]
    NotFinite { module: usize, point: usize, value: [f32; 4] },
    #[error("point {point} of module {module} has the weight {weight}; it must be positive{}", if *.rational { "" } else { ", and 1 in a word that is not rational" })]
    Weight { module: usize, point: usize, weight: f32, rational: bool },
}

/// The least weight of a net that is rewritten, 2⁻¹⁰⁰.
///
/// A midpoint of weights is not below the lesser of the two, so none ever becomes denormal; and what
/// a GPU flushes to zero of a coordinate, less than 2⁻¹²⁶, moves no point by more than 2⁻²⁶.
pub const MIN_WEIGHT: f32 = f32::from_bits((127 - 100) << 23);

/// The greatest weight, and coordinate times weight, of a net that is rewritten, 2¹¹¹. A compiler may
/// put off the halvings of a step, which changes no bit, but then sums 2¹⁶ points of a net of degree 8:
/// that is still finite.
pub const MAX_COORDINATE: f32 = f32::from_bits((127 + 111) << 23);

/// Why a net cannot be rewritten; points are counted from 0, row by row.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NetError {
    #[error("the degrees {0:?} are not both in 1..=8")]
    Degree([u8; 2]),
    #[error("it has {found} points where its degrees ask for {expected}")]
    Points { found: usize, expected: usize },
    #[error("point {point} has the weight {weight}; {}", rule(*.rational))]
    Weight { point: usize, weight: f32, rational: bool },
    #[error(
        "point {point} is {value:?}, weight and coordinates times weight; these must lie within ±{MAX_COORDINATE:e}"
    )]
    Coordinate { point: usize, value: [f32; 4] },
}

fn rule(rational: bool) -> String {
    match rational {
        true => format!("weights must be positive, from {MIN_WEIGHT:e} to {MAX_COORDINATE:e}"),
        false => "other weights than 1 need a `rational` system".to_string(),
    }
}

impl Net {
    /// Checks what the rewriting of a net relies on: degrees in 1..=8 and as many points as they ask
    /// for; weights of 1, or in [`MIN_WEIGHT`]`..=`[`MAX_COORDINATE`] if `rational`; coordinates, which
    /// are homogeneous here, of at most [`MAX_COORDINATE`]. Then no halving, however often, gives a
    /// weight that is not positive or a coordinate that is not finite.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self, rational: bool) -> Result<(), NetError> {
        if !self.degree.iter().all(|d| (1..=MAX_DEGREE).contains(d)) {
            return Err(NetError::Degree(self.degree));
        }
        let (found, expected) = (self.points.len(), net_points(self.degree));
        if found != expected {
            return Err(NetError::Points { found, expected });
        }
        for (point, &value) in self.points.iter().enumerate() {
            let weight = value[3];
            let allowed = if rational { MIN_WEIGHT..=MAX_COORDINATE } else { 1.0..=1.0 };
            if !allowed.contains(&weight) {
                return Err(NetError::Weight { point, weight, rational });
            }
            // Written so that NaN is beyond it.
            if !value.iter().all(|x| x.abs() <= MAX_COORDINATE) {
                return Err(NetError::Coordinate { point, value });
            }
        }
        Ok(())
    }
}

impl WordError {
    /// What is wrong with the parameters of a module of this symbol.
    pub(crate) fn of_params(module: usize, symbol: &Symbol, e: ParamsError) -> WordError {
        let name = symbol.name.clone();
        match e {
            ParamsError::Symbol { symbol, symbols } => WordError::Symbol { module, symbol, symbols },
            ParamsError::Arity { found, expected } => {
                WordError::Arity { module, symbol: name, found, expected }
            }
            ParamsError::Type { field, found, expected } => {
                let field = symbol.fields[field].name.clone();
                WordError::Parameter { module, symbol: name, field, found, expected }
            }
        }
    }
}

impl Word {
    /// Checks every invariant of the word: degrees in 1..=8, one net and known symbol a module,
    /// parameters of the declared types, cells inside their roots (du + dv ≤ 62), modules in the
    /// order of (root, key), points finite, weights positive and 1 where the word is not rational.
    ///
    /// # Errors
    /// The first one broken.
    pub fn validate(&self) -> Result<(), WordError> {
        if !self.degree.iter().all(|d| (1..=MAX_DEGREE).contains(d)) {
            return Err(WordError::Degree(self.degree));
        }
        let (modules, found) = (self.modules.len(), self.nets.len());
        let expected = modules * self.net_points();
        if found != expected {
            return Err(WordError::Nets { modules, found, expected });
        }
        for (index, module) in self.modules.iter().enumerate() {
            self.validate_params(index, module)?;
            validate_cell(index, module.cell)?;
            self.validate_net(index)?;
        }
        let order = |m: &Module| (m.root, m.key);
        match self.modules.windows(2).position(|pair| order(&pair[0]) >= order(&pair[1])) {
            Some(before) => Err(WordError::Order { module: before + 1 }),
            None => Ok(()),
        }
    }

    fn validate_params(&self, index: usize, module: &Module) -> Result<(), WordError> {
        let Some(symbol) = self.symbols.get(module.symbol) else {
            let (symbol, symbols) = (module.symbol, self.symbols.len());
            return Err(WordError::Symbol { module: index, symbol, symbols });
        };
        let of_params = |e| WordError::of_params(index, symbol, e);
        let columns = self.params.columns(module.symbol);
        let (found, expected) = (columns.len(), symbol.fields.len());
        if found != expected {
            return Err(of_params(ParamsError::Arity { found, expected }));
        }
        let declared = columns.iter().map(Column::ty).zip(&symbol.fields);
        if let Some((field, (found, declared))) = declared.enumerate().find(|(_, (ty, f))| *ty != f.ty) {
            let expected = declared.ty.clone();
            return Err(of_params(ParamsError::Type { field, found, expected }));
        }
        let lengths = columns.iter().map(|column| column.len() as u32);
        let rows = lengths.fold(self.params.rows(module.symbol), u32::min);
        match module.row < rows {
            true => Ok(()),
            false => {
                Err(WordError::Row { module: index, symbol: symbol.name.clone(), row: module.row, rows })
            }
        }
    }

    fn validate_net(&self, index: usize) -> Result<(), WordError> {
        for (point, &value) in self.net(index).iter().enumerate() {
            if !value.iter().all(|x| x.is_finite()) {
                return Err(WordError::NotFinite { module: index, point, value });
            }
            let weight = value[3];
            if weight <= 0.0 || (!self.rational && weight != 1.0) {
                return Err(WordError::Weight { module: index, point, weight, rational: self.rational });
            }
        }
        Ok(())
    }
}

fn validate_cell(module: usize, cell: Cell) -> Result<(), WordError> {
    let inside = |halvings: u8, index: u32| halvings >= 32 || u64::from(index) < 1u64 << halvings;
    let fits = u32::from(cell.du) + u32::from(cell.dv) <= 62;
    if fits && inside(cell.du, cell.i) && inside(cell.dv, cell.j) {
        Ok(())
    } else {
        Err(WordError::Cell { module, cell })
    }
}
