//! The syntax tree of a rule file: what was written, with the place where it was written.
//!
//! The tree holds names as names: nothing is resolved, typed or folded here. The checker
//! ([`mod@super::check`]) turns it into a [`super::System`]; the printer ([`mod@super::print`]) turns it
//! back into text, and `parse(print(tree)) == tree`.

/// A range of bytes in the source text.
///
/// Spans say where a thing stands, not what it is, so all spans compare equal: two trees that
/// were written differently but say the same are equal.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    pub start: u32,
    pub end: u32,
}

impl PartialEq for Span {
    fn eq(&self, _: &Span) -> bool {
        true
    }
}
impl Eq for Span {}

impl Span {
    /// The span of the bytes `start..end`.
    pub fn new(start: usize, end: usize) -> Span {
        Span { start: start as u32, end: end as u32 }
    }
    /// The smallest span that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
    /// As a range for slicing the source text.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A name or a module's symbol (`+ - & ^ / \ | !` are symbols too).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    pub text: String,
    pub span: Span,
}

/// A numeral, as written (without sign).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number {
    pub text: String,
    pub span: Span,
}

/// A whole rule file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RuleFile {
    /// From a first line `burgeon 1`.
    pub version: Option<Number>,
    /// In order: a const or param above a system holds for all systems below it.
    pub items: Vec<FileItem>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileItem {
    Const(Const),
    Param(Param),
    System(System),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct System {
    pub name: Name,
    pub kind: Kind,
    pub kind_span: Span,
    pub attributes: Vec<Attribute>,
    pub items: Vec<Item>,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Curve,
    Patch,
    Mesh,
}

/// An attribute behind the kind of a system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attribute {
    pub kind: AttributeKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AttributeKind {
    Ring,
    Open,
    Tree,
    /// `bezier u [v]`.
    Bezier(Number, Option<Number>),
    Rational,
    /// `join c0` or `join c1`: true for C1.
    Join {
        c1: bool,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    Const(Const),
    Param(Param),
    /// One `module` line; it may declare several.
    Modules(Vec<ModuleDecl>),
    Query(Query),
    Volume(Volume),
    Ignore(Vec<Name>),
    Template(Template),
    Axiom(Axiom),
    Rules(Rules),
    Place(Place),
    Run(Run),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Const {
    pub name: Name,
    pub ty: Option<Name>,
    pub value: Expr,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Param {
    pub name: Name,
    pub ty: Option<Name>,
    pub value: Expr,
    /// `in low .. high`.
    pub range: Option<(Expr, Expr)>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleDecl {
    pub symbol: Name,
    pub fields: Vec<Field>,
    pub span: Span,
}

/// `name: type`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    pub name: Name,
    pub ty: Name,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Query {
    pub name: Name,
    pub field: Field,
    /// Absent: bound by the host.
    pub value: Option<Expr>,
    pub span: Span,
}

/// Reserved: a grid of the environment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Volume {
    pub name: Name,
    pub ty: Name,
    pub size: [Number; 3],
    pub from: Expr,
    pub to: Expr,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    pub name: Name,
    pub body: TemplateBody,
    pub base: Vec<Name>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateBody {
    File(Text),
    Inline(Vec<TemplateLine>),
}

/// A string in quotes, without them (there are no escapes).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    pub text: String,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemplateLine {
    pub kind: TemplateLineKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TemplateLineKind {
    Vertex([SignedNumber; 3]),
    /// Two vertices and a sharpness.
    Crease(Number, Number, SignedNumber),
    Face(Name, Vec<Number>),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignedNumber {
    pub negative: bool,
    pub number: Number,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axiom {
    pub kind: AxiomKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxiomKind {
    /// A word, written out.
    Word(Vec<Element>),
    /// A curve's points, unnamed.
    Source(Source),
    /// `P(0) = file "…"  Q = file "…"`: in patch systems a source for each symbol.
    Starts(Vec<Start>),
    /// Mesh systems.
    Meshes(Vec<MeshStart>),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Start {
    pub module: ModuleUse,
    pub source: Source,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    pub kind: SourceKind,
    pub shift: Option<Expr>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// `file "path"` or `file "path" [3]`.
    File(Text, Option<Number>),
    /// A list literal: [`ExprKind::List`].
    List(Expr),
    /// A shape, a template, or the name of an earlier system. Arguments are absent without parentheses.
    Named(Name, Option<Vec<Expr>>),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshStart {
    pub source: Source,
    pub at: Vec<Transform>,
    pub slots: Option<Vec<Slot>>,
}

/// `scale(1, 1, 2)`, `corner`, `uv(…)`: one word of an `at` or `on` clause.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transform {
    pub name: Name,
    pub args: Option<Vec<Expr>>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slot {
    pub names: Vec<Name>,
    pub fill: SlotFill,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SlotFill {
    Eps(Span),
    Module(ModuleUse),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rules {
    /// Absent: the unnamed group.
    pub group: Option<Name>,
    pub rules: Vec<Rule>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rule {
    pub label: Option<Name>,
    pub predecessor: Predecessor,
    pub lets: Vec<(Name, Expr)>,
    pub condition: Option<Expr>,
    /// One without a weight, or at least two with weights (the checker sees to it).
    pub alternatives: Vec<Alternative>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Predecessor {
    /// `?E(d)`.
    pub queries: Vec<QueryUse>,
    pub left: Option<LeftContext>,
    /// At least one.
    pub strict: Vec<Pattern>,
    /// Written with `&` between the strict predecessors.
    pub joined: bool,
    pub right: Option<RightContext>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QueryUse {
    pub query: Name,
    pub binder: Name,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftContext {
    /// Begins with `#`.
    pub end: bool,
    pub patterns: Vec<Pattern>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RightContext {
    pub parts: Vec<ContextPart>,
    /// Ends with `#`.
    pub end: bool,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ContextPart {
    Pattern(Pattern),
    Branch(RightContext),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    pub symbol: Name,
    /// Absent without parentheses: then all parameters match.
    pub args: Option<Vec<PatternArg>>,
    pub tag: Option<PatternTag>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PatternArg {
    Bind(Name),
    /// `_`.
    Any(Span),
    Number(SignedNumber),
    Bool(bool, Span),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PatternTag {
    Bind(Name),
    Number(Number),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alternative {
    pub weight: Option<Expr>,
    pub successor: Successor,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Successor {
    /// Curve and patch systems; and in mesh systems a lone `eps` or module.
    Word(Vec<Element>),
    /// Mesh systems: anything with a template's name, `at`, `on` or slots.
    Template(TemplateUse),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemplateUse {
    pub name: Name,
    pub args: Option<Vec<Expr>>,
    pub place: Option<TemplatePlace>,
    pub slots: Option<Vec<Slot>>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemplatePlace {
    /// `on` keeps the face and sets a loose copy on it; `at` replaces it.
    pub on: bool,
    pub transforms: Vec<Transform>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Element {
    Eps(Span),
    Module(ModuleUse),
    /// `[ … ]`: a branch.
    Branch(Vec<Element>, Span),
    /// `[ a | b ; c | d ]`: a block of a patch system.
    Block(Block),
}

/// Rows of cells; the parser has seen to it that the rows are 1 or 2, of one length, 1 or 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    pub rows: Vec<Vec<Cell>>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cell {
    Eps(Span),
    Module(ModuleUse),
    Block(Block),
}

/// A module in a successor, an axiom, a slot or a `mark`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModuleUse {
    pub symbol: Name,
    /// Absent without parentheses.
    pub args: Option<Vec<Expr>>,
    /// One expression, or several in parentheses.
    pub tag: Option<Vec<Expr>>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub name: Name,
    pub on: Vec<Name>,
    pub value: Expr,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    pub steps: Vec<Step>,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    pub kind: StepKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepKind {
    Derive { count: DeriveCount, groups: Vec<Name> },
    Subdivide { scheme: Name, levels: Expr, place: Option<Name> },
    Place(Name),
    Mark { module: ModuleUse, condition: Expr, isolated: bool },
    Crease { sharpness: Expr, condition: Expr },
    Deposit { pattern: Pattern, into: Name, condition: Option<Expr> },
    Trace { into: Name },
    Repeat { count: Expr, body: Vec<Step> },
    If { condition: Expr, body: Vec<Step> },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DeriveCount {
    Steps(Expr),
    /// `until terminal max n`. The parser leaves `max` out as `None` for the checker to report.
    UntilTerminal {
        max: Option<Expr>,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExprKind {
    Number(Number),
    Bool(bool),
    /// Also `_` in an axiom's start: the point read.
    Name(String),
    Call(Name, Vec<Expr>),
    /// `(a, b, c)`: at least two.
    Vector(Vec<Expr>),
    /// `[a, b]`.
    List(Vec<Expr>),
    /// `v.x`.
    Field(Box<Expr>, Name),
    Index(Box<Expr>, Box<Expr>),
    Unary(UnaryOp, Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnaryOp {
    Neg,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Sub,
    Mul,
    Div,
    Rem,
}

impl BinaryOp {
    /// The operator as written.
    pub fn token(self) -> &'static str {
        match self {
            BinaryOp::Or => "||",
            BinaryOp::And => "&&",
            BinaryOp::Equal => "==",
            BinaryOp::NotEqual => "!=",
            BinaryOp::Less => "<",
            BinaryOp::LessEqual => "<=",
            BinaryOp::Greater => ">",
            BinaryOp::GreaterEqual => ">=",
            BinaryOp::Add => "+",
            BinaryOp::Sub => "-",
            BinaryOp::Mul => "*",
            BinaryOp::Div => "/",
            BinaryOp::Rem => "%",
        }
    }
    /// How tightly it binds, from 1 (`||`) to 5 (`*`).
    pub fn precedence(self) -> u8 {
        match self {
            BinaryOp::Or => 1,
            BinaryOp::And => 2,
            BinaryOp::Equal
            | BinaryOp::NotEqual
            | BinaryOp::Less
            | BinaryOp::LessEqual
            | BinaryOp::Greater
            | BinaryOp::GreaterEqual => 3,
            BinaryOp::Add | BinaryOp::Sub => 4,
            BinaryOp::Mul | BinaryOp::Div | BinaryOp::Rem => 5,
        }
    }
}
