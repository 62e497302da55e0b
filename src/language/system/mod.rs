//! A checked system: names resolved, expressions typed, constants folded.
//!
//! This is all that the engine sees of a rule file. It knows no device and no container.

mod curve;
mod mesh;
mod patch;

use super::expr::{Expr, Type, Value};
use super::syntax::{self, Span};
use std::sync::Arc;

pub use curve::{CurveSource, CurveStart, CurveWord, Hang};
pub use mesh::{
    Attachment, FaceModule, FaceSuccessor, FaceTemplate, Fill, Filling, MeshSource, MeshStart, Pairing,
    PointField, ShapeArg, ShapeUse, SharpEdge, SlotName, Template, TemplateBody, TemplateFace, TemplateId,
    TemplateMesh, TemplateUse, Transform, UvRange,
};
pub use patch::{Block, Cell, Continuity, PatchSource, PatchStart, SurfaceElement, surface_modules};

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
    /// Of mesh systems.
    pub templates: Vec<Template>,
    pub axiom: Axiom,
    /// The unnamed group has the empty name.
    pub groups: Vec<Group>,
    /// What [`StepKind::Place`] counts.
    pub placements: Vec<Placement>,
    /// Symbols that contexts look past.
    pub ignored: Vec<SymbolId>,
    pub run: Vec<Step>,
    /// What was written, for messages.
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
        /// How the nets of branching surfaces meet, if it is written.
        join: Option<Continuity>,
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

/// What a system starts from. Names of files and of earlier systems stay names: what they hold is read later.
#[derive(Clone, Debug)]
pub enum Axiom {
    /// No axiom was written.
    None,
    Patches(Vec<PatchStart>),
    /// The final word of an earlier patch system of the file, with its own symbols.
    PatchSystem {
        name: String,
        span: Span,
    },
    /// In the order of the word.
    Curve(Vec<CurveStart>),
    /// In the order of the word.
    Meshes(Vec<MeshStart>),
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
    /// The symbols of the strict predecessors; one in patch systems. Of mesh systems several are faces of equal tag,
    /// joined with `&`.
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
    /// The tag `@t` of strict predecessor `module` (mesh systems), which a face without one does not match. Where tags
    /// have several ints it is the first of them; a join compares them all.
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
    /// Patch systems: a surface that branches.
    Surface(Vec<SurfaceElement>),
    /// Mesh systems: what becomes of a face.
    Face(FaceSuccessor),
}

/// A module of a successor: its arguments have the types of the symbol's fields.
#[derive(Clone, Debug)]
pub struct Module {
    pub symbol: SymbolId,
    pub args: Vec<Expr>,
    pub span: Span,
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
    Subdivide {
        /// Its name in the [`Vocabulary`](super::Vocabulary), which stands for what refines by it.
        scheme: &'static str,
        levels: Expr,
        /// Index into [`System::placements`]: it moves the vertices of each level.
        place: Option<usize>,
    },
    /// Faces for which the condition, of type bool, holds get the module.
    Mark {
        module: FaceModule,
        condition: Expr,
        /// No two neighbours get it.
        isolated: bool,
    },
    /// Edges for which the condition, of type bool, holds get the sharpness, a float.
    Crease {
        sharpness: Expr,
        condition: Expr,
    },
    /// Reserved: what it writes into a volume is still open.
    Deposit,
}

impl StepKind {
    /// The word that the step begins with.
    pub fn word(&self) -> &'static str {
        match self {
            StepKind::Derive { .. } => "derive",
            StepKind::Repeat { .. } => "repeat",
            StepKind::If { .. } => "if",
            StepKind::Place(_) => "place",
            StepKind::Trace { .. } => "trace",
            StepKind::Subdivide { .. } => "subdivide",
            StepKind::Mark { .. } => "mark",
            StepKind::Crease { .. } => "crease",
            StepKind::Deposit => "deposit",
        }
    }
}
