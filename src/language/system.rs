//! A checked system: names resolved, expressions typed, constants folded.
//!
//! This is all that the engine sees of a rule file. It knows no device and no container.

use super::expr::{Expr, Type, Value};
use super::syntax::{self, Span};
use std::sync::Arc;

/// Index into [`System::symbols`].
pub type SymbolId = usize;

/// A checked system.
#[derive(Clone, Debug)]
pub struct System {
    pub name: String,
    pub kind: Kind,
    /// Declared modules in order of declaration, then (curve systems) the turtle symbols that occur.
    pub symbols: Vec<Symbol>,
    /// Values that stand in the environment buffer: params, and consts that read a param.
    pub uniforms: Vec<Uniform>,
    pub queries: Vec<Query>,
    pub axiom: Axiom,
    /// The unnamed group has the empty name.
    pub groups: Vec<Group>,
    /// What [`StepKind::Place`] counts.
    pub placements: Vec<Placement>,
    /// Symbols that contexts look past.
    pub ignored: Vec<SymbolId>,
    pub run: Vec<Step>,
    /// What was written, for messages and for the parts of the language that later passes read.
    pub source: Arc<syntax::System>,
}

impl System {
    /// The symbol of that name.
    pub fn symbol(&self, name: &str) -> Option<SymbolId> {
        self.symbols.iter().position(|s| s.name == name)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Curve(Topology),
    /// Degrees along u (rows) and v (columns), 1..=8 each.
    Patch {
        degree: [u8; 2],
        rational: bool,
    },
    Mesh,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topology {
    Ring,
    Open,
    Tree,
}

#[derive(Clone, Debug)]
pub struct Symbol {
    pub name: String,
    pub fields: Vec<Field>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub name: String,
    pub ty: Type,
}

/// A value that the host may change between frames without a rebuild.
#[derive(Clone, Debug)]
pub struct Uniform {
    pub name: String,
    pub ty: Type,
    pub kind: UniformKind,
    pub span: Span,
}

impl Uniform {
    /// The host may set it.
    pub fn is_param(&self) -> bool {
        matches!(self.kind, UniformKind::Param { .. })
    }
}

#[derive(Clone, Debug)]
pub enum UniformKind {
    /// A `param`: its default and, if written, its range.
    Param { default: Value, range: Option<(Value, Value)> },
    /// A `const` that reads params: computed on the host from uniforms before it.
    Derived(Expr),
}

#[derive(Clone, Debug)]
pub struct Query {
    pub name: String,
    pub ty: Type,
    /// Absent: bound by the host.
    pub value: Option<Expr>,
    pub span: Span,
}

/// The axiom as the engine reads it. Those of patches and curves are resolved in full; meshes stay in
/// [`System::source`].
#[derive(Clone, Debug)]
pub enum Axiom {
    /// No axiom was written.
    None,
    Patches(Vec<PatchStart>),
    /// In the order of the word.
    Curve(Vec<CurveStart>),
    /// Meshes: see the syntax tree.
    Other,
}

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

#[derive(Clone, Debug)]
pub struct Group {
    pub name: String,
    pub rules: Vec<Rule>,
}

/// One production. It fires on a module when `tests` and `condition` all hold, if no earlier rule
/// of the running groups did.
#[derive(Clone, Debug)]
pub struct Rule {
    pub label: Option<String>,
    /// Its index in the group.
    pub index: usize,
    pub queries: Vec<QueryUse>,
    pub left: Option<Context>,
    /// The symbols of the strict predecessors; one in patch systems.
    pub strict: Vec<SymbolId>,
    pub right: Option<Context>,
    /// Every name that the predecessor binds: what [`ExprKind::Binder`](super::expr::ExprKind::Binder) counts.
    pub binders: Vec<Binder>,
    /// From literals in the pattern and names bound twice; all of type bool.
    pub tests: Vec<Expr>,
    /// What [`ExprKind::Let`](super::expr::ExprKind::Let) counts; each may read those before it.
    pub lets: Vec<Let>,
    pub condition: Option<Expr>,
    /// One without a weight, or several with.
    pub alternatives: Vec<Alternative>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct QueryUse {
    /// Index into [`System::queries`].
    pub query: usize,
    pub span: Span,
}

/// The symbols of a context as written: nearest last on the left, nearest first on the right, those of branches
/// where these stand.
#[derive(Clone, Debug)]
pub struct Context {
    pub symbols: Vec<SymbolId>,
    /// Of a right context what its modules are to each other.
    pub parts: Vec<ContextPart>,
    pub end: bool,
    pub span: Span,
}

/// A part of a right context.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ContextPart {
    /// Index into [`Context::symbols`].
    Module(usize),
    /// A branch, which begins with a module, and whether it ends with `#`.
    Branch(Vec<ContextPart>, bool),
}

/// Where the value of a bound name stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Binder {
    pub name: String,
    pub ty: Type,
    pub place: BinderPlace,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinderPlace {
    /// Field `field` of strict predecessor `module`.
    Strict {
        module: usize,
        field: usize,
    },
    /// Field of the context's module, counted as written.
    Left {
        module: usize,
        field: usize,
    },
    Right {
        module: usize,
        field: usize,
    },
    /// The value of the rule's n-th query use.
    Query(usize),
    /// The tag `@t` of strict predecessor `module` (mesh systems).
    Tag {
        module: usize,
    },
}

#[derive(Clone, Debug)]
pub struct Let {
    pub name: String,
    pub value: Expr,
}

#[derive(Clone, Debug)]
pub struct Alternative {
    pub weight: Option<Expr>,
    pub successor: Successor,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum Successor {
    /// Patch systems: `eps`.
    Erase,
    /// Patch systems: one module, net and path unchanged.
    Relabel(Module),
    /// Patch systems: a block.
    Split(Block),
    /// A word of a curve system.
    Word(CurveWord),
    /// The modules of a mesh system's slots, or of a branching surface. The full form is in the syntax tree.
    Modules(Vec<Module>),
}

/// A module of a successor: its arguments have the types of the symbol's fields.
#[derive(Clone, Debug)]
pub struct Module {
    pub symbol: SymbolId,
    pub args: Vec<Expr>,
    pub span: Span,
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

/// `place NAME on A, B = …`: where vertices go.
#[derive(Clone, Debug)]
pub struct Placement {
    pub name: String,
    /// Only vertices between modules of these symbols alone are moved; empty: all.
    pub on: Vec<SymbolId>,
    /// Of type vec3.
    pub value: Expr,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub struct Step {
    pub kind: StepKind,
    pub span: Span,
}

/// Counts are expressions of type int over uniforms, read at `prepare`.
#[derive(Clone, Debug)]
pub enum StepKind {
    /// Indices into [`System::groups`], in order of priority.
    Derive {
        count: Expr,
        until_terminal: bool,
        groups: Vec<usize>,
    },
    Repeat {
        count: Expr,
        body: Vec<Step>,
    },
    /// The condition is of type bool.
    If {
        condition: Expr,
        body: Vec<Step>,
    },
    /// Index into [`System::placements`]. In patch systems the last step.
    Place(usize),
    /// The turtle writes modules of this symbol.
    Trace {
        into: SymbolId,
    },
    /// `subdivide`, `mark`, `crease`, `deposit`: the word that names it; the rest is in the
    /// syntax tree.
    Other(&'static str),
}
