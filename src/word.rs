//! What words of every kind have in common: symbols, and the parameters of their modules in typed columns.

use crate::language::Span;
use crate::language::expr::{Type, Value};
use crate::language::system::Field;
use std::fmt::Display;
use thiserror::Error;

/// Why an axiom has no modules. `E` is what reading a file may say.
#[derive(Debug, Error)]
pub enum AxiomError<E: Display> {
    #[error("{0}")]
    Source(E),
    #[error("{message}")]
    Wrong { message: String, span: Span },
}

impl<E: Display> AxiomError<E> {
    /// A source that is a system.
    pub(crate) fn of_system(span: Span) -> AxiomError<E> {
        let message = "this version does not begin with the word of another system".to_string();
        AxiomError::Wrong { message, span }
    }
}

/// The one of a file's curves or patches that the axiom asks for.
pub(crate) fn chosen<T, E: Display>(
    mut all: Vec<T>,
    index: u32,
    (what, path): (&str, &str),
    span: Span,
) -> Result<T, AxiomError<E>> {
    if (index as usize) < all.len() {
        return Ok(all.swap_remove(index as usize));
    }
    let there = match all.len().checked_sub(1) {
        Some(last) => format!("counted from 0, its last is {last}"),
        None => "it holds none".to_string(),
    };
    let message = format!("{path} has no {what} {index}: {there}");
    Err(AxiomError::Wrong { message, span })
}

/// A symbol with the names and types of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    pub name: String,
    pub fields: Vec<Field>,
}

/// The parameters of all modules of a word: for each symbol a table with a column for each of its fields and a row for
/// each of its modules, in the order of the word. A module says which row is its own.
///
/// ```
/// use burgeon::language::{Type, Value};
/// use burgeon::language::system::Field;
/// use burgeon::word::{Column, Params, Symbol};
///
/// let field = |name: &str, ty| Field { name: name.into(), ty };
/// let point = Symbol { name: "P".into(), fields: vec![field("v", Type::Vec2), field("s", Type::Float)] };
/// let mut params = Params::new(&[point]);
/// let first = params.push(0, &[Value::Vec2([0.0, 1.0]), Value::Float(0.5)])?;
/// params.push(0, &[Value::Vec2([2.0, 3.0]), Value::Float(0.25)])?;
/// assert_eq!(params.column(0, 0), Some(&Column::Vec2(vec![[0.0, 1.0], [2.0, 3.0]])));
/// assert_eq!(params.row(0, first).get(1), Some(Value::Float(0.5)));
/// # Ok::<(), burgeon::word::ParamsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Params {
    tables: Vec<Table>,
}

/// The parameters of the modules of one symbol.
#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
    /// Also of a symbol without parameters.
    rows: u32,
    columns: Vec<Column>,
}

/// The values of one field, a row after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    Bool(Vec<bool>),
    Int(Vec<i32>),
    Float(Vec<f32>),
    Vec2(Vec<[f32; 2]>),
    Vec3(Vec<[f32; 3]>),
    Vec4(Vec<[f32; 4]>),
}

/// Why a row does not fit the table of its symbol; fields are counted from 0.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ParamsError {
    #[error("there are {symbols} symbols, and none with index {symbol}")]
    Symbol { symbol: usize, symbols: usize },
    #[error("{found} parameters where the symbol declares {expected}")]
    Arity { found: usize, expected: usize },
    #[error("parameter {field} is of type {found}, declared as {expected}")]
    Type { field: usize, found: Type, expected: Type },
}

/// The parameters of one module.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    columns: &'a [Column],
    row: usize,
}

impl Params {
    /// Empty tables for these symbols.
    pub fn new(symbols: &[Symbol]) -> Params {
        let mut params = Params::default();
        symbols.iter().for_each(|symbol| params.add_symbol(&symbol.fields));
        params
    }

    /// A table for one more symbol.
    pub fn add_symbol(&mut self, fields: &[Field]) {
        let columns = fields.iter().map(|field| Column::new(&field.ty)).collect();
        self.tables.push(Table { rows: 0, columns });
    }

    /// Forgets the tables of the symbols from this one on.
    pub fn truncate(&mut self, symbols: usize) {
        self.tables.truncate(symbols);
    }

    /// Adds the parameters of a module, and says in which row they stand.
    ///
    /// # Errors
    /// Where they are not as the symbol declares them; then nothing is added.
    pub fn push(&mut self, symbol: usize, values: &[Value]) -> Result<u32, ParamsError> {
        let symbols = self.tables.len();
        let table = self.tables.get_mut(symbol).ok_or(ParamsError::Symbol { symbol, symbols })?;
        let (found, expected) = (values.len(), table.columns.len());
        if found != expected {
            return Err(ParamsError::Arity { found, expected });
        }
        let wrong = |(column, value): (&Column, &Value)| column.ty() != value.ty();
        if let Some(field) = table.columns.iter().zip(values).position(wrong) {
            let (found, expected) = (values[field].ty(), table.columns[field].ty());
            return Err(ParamsError::Type { field, found, expected });
        }
        for (column, value) in table.columns.iter_mut().zip(values) {
            column.push(value);
        }
        table.rows += 1;
        Ok(table.rows - 1)
    }

    /// Adds a row of which the record holds each field from these words on: see [`Value::from_words`].
    pub(crate) fn push_record(&mut self, symbol: usize, words: &[usize], record: &[u32]) -> u32 {
        let table = &mut self.tables[symbol];
        for (column, &at) in table.columns.iter_mut().zip(words) {
            column.push_words(&record[at..]);
        }
        table.rows += 1;
        table.rows - 1
    }

    /// A row of a symbol's table; without parameters where there is none.
    pub fn row(&self, symbol: usize, row: u32) -> Row<'_> {
        let table = self.tables.get(symbol).filter(|table| row < table.rows);
        Row { columns: table.map_or(&[], |table| &table.columns), row: row as usize }
    }

    /// Rows of a symbol's table: how many modules it has.
    pub fn rows(&self, symbol: usize) -> u32 {
        self.tables.get(symbol).map_or(0, |table| table.rows)
    }

    /// The columns of a symbol, in the order of its fields.
    pub fn columns(&self, symbol: usize) -> &[Column] {
        self.tables.get(symbol).map_or(&[], |table| &table.columns)
    }

    /// All values of one field of a symbol.
    pub fn column(&self, symbol: usize, field: usize) -> Option<&Column> {
        self.columns(symbol).get(field)
    }

    /// The same, to be changed. A row that is taken away or added here is one that no module has, or that some miss.
    pub fn column_mut(&mut self, symbol: usize, field: usize) -> Option<&mut Column> {
        self.tables.get_mut(symbol)?.columns.get_mut(field)
    }
}

impl Column {
    fn new(ty: &Type) -> Column {
        match ty {
            Type::Bool => Column::Bool(Vec::new()),
            Type::Int => Column::Int(Vec::new()),
            // Lists are constants, never parameters.
            Type::Float | Type::List(..) => Column::Float(Vec::new()),
            Type::Vec2 => Column::Vec2(Vec::new()),
            Type::Vec3 => Column::Vec3(Vec::new()),
            Type::Vec4 => Column::Vec4(Vec::new()),
        }
    }

    pub fn ty(&self) -> Type {
        match self {
            Column::Bool(_) => Type::Bool,
            Column::Int(_) => Type::Int,
            Column::Float(_) => Type::Float,
            Column::Vec2(_) => Type::Vec2,
            Column::Vec3(_) => Type::Vec3,
            Column::Vec4(_) => Type::Vec4,
        }
    }

    /// The value in this row.
    pub fn get(&self, row: usize) -> Option<Value> {
        match self {
            Column::Bool(all) => all.get(row).copied().map(Value::Bool),
            Column::Int(all) => all.get(row).copied().map(Value::Int),
            Column::Float(all) => all.get(row).copied().map(Value::Float),
            Column::Vec2(all) => all.get(row).copied().map(Value::Vec2),
            Column::Vec3(all) => all.get(row).copied().map(Value::Vec3),
            Column::Vec4(all) => all.get(row).copied().map(Value::Vec4),
        }
    }

    /// Rows.
    pub fn len(&self) -> usize {
        match self {
            Column::Bool(all) => all.len(),
            Column::Int(all) => all.len(),
            Column::Float(all) => all.len(),
            Column::Vec2(all) => all.len(),
            Column::Vec3(all) => all.len(),
            Column::Vec4(all) => all.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A value of the column's type.
    fn push(&mut self, value: &Value) {
        self.push_words(&value.words());
    }

    fn push_words(&mut self, words: &[u32]) {
        let f = |n: usize| f32::from_bits(words[n]);
        match self {
            Column::Bool(all) => all.push(words[0] != 0),
            Column::Int(all) => all.push(words[0] as i32),
            Column::Float(all) => all.push(f(0)),
            Column::Vec2(all) => all.push([f(0), f(1)]),
            Column::Vec3(all) => all.push([f(0), f(1), f(2)]),
            Column::Vec4(all) => all.push([f(0), f(1), f(2), f(3)]),
        }
    }
}

impl<'a> Row<'a> {
    /// The value of this field.
    pub fn get(self, field: usize) -> Option<Value> {
        self.columns.get(field)?.get(self.row)
    }

    /// The values in the order of the fields.
    pub fn iter(self) -> impl Iterator<Item = Value> + 'a {
        self.columns.iter().filter_map(move |column| column.get(self.row))
    }

    /// The same in a list.
    pub fn to_vec(self) -> Vec<Value> {
        self.iter().collect()
    }

    /// Parameters.
    pub fn len(self) -> usize {
        self.columns.len()
    }

    pub fn is_empty(self) -> bool {
        self.columns.is_empty()
    }
}
