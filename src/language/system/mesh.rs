//! Meshes: templates and shapes, what rules write on faces, and what an axiom starts from.
//!
//! The word of a mesh system is a polygon mesh each of whose faces holds a module. A rule leaves a face out, gives it
//! another module, or puts a *template* on it, a mesh whose *base* is the face and whose other faces stand in *slots*.

use super::{Module, SymbolId};
use crate::language::expr::{Expr, Type};
use crate::language::syntax::Span;

/// Index into [`System::templates`](super::System::templates).
pub type TemplateId = usize;

/// A mesh that stands in for a face, or that an axiom starts from.
#[derive(Clone, Debug)]
pub struct Template {
    pub name: String,
    pub body: TemplateBody,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum TemplateBody {
    /// An OBJ file, read by the engine; its groups name the slots.
    File {
        path: String,
        /// The groups of the bases, each of one face. None written: the group `base`, if the file has it.
        bases: Vec<SlotName>,
        span: Span,
    },
    /// Written out in the rule file.
    Inline(TemplateMesh),
}

/// The name of a slot as written. Of a file only its reading tells whether it has that slot.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotName {
    pub name: String,
    pub span: Span,
}

/// A template as numbers. With a base it is closed: each edge has two faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TemplateMesh {
    /// x, y, z in the template's own units.
    pub vertices: Vec<[f32; 3]>,
    /// The names of the slots, in the order in which their first faces stand; those of the bases among them.
    pub slots: Vec<String>,
    /// In the order written.
    pub faces: Vec<TemplateFace>,
    pub edges: Vec<SharpEdge>,
    /// Indices into `faces`, in the order of the faces that a rule replaces; empty if it replaces none.
    pub bases: Vec<usize>,
}

/// A face of a template.
#[derive(Clone, Debug, PartialEq)]
pub struct TemplateFace {
    /// Index into [`TemplateMesh::slots`].
    pub slot: usize,
    /// Indices into [`TemplateMesh::vertices`]: at least three, all different, counter-clockwise from outside.
    pub corners: Vec<u32>,
}

/// `e 0 1 2.5`: an edge that subdivision keeps sharp.
#[derive(Clone, Debug, PartialEq)]
pub struct SharpEdge {
    /// Indices into [`TemplateMesh::vertices`].
    pub ends: [u32; 2],
    /// For how many levels; as written.
    pub sharpness: f32,
}

/// A mesh made from arguments: `box(1, 1, 2)`, `extrude(0.5)`, `tube(stem, 8, r)`.
#[derive(Clone, Debug)]
pub struct ShapeUse {
    /// Its name in the [`Vocabulary`](crate::language::Vocabulary), which stands for what makes it.
    pub shape: &'static str,
    /// One for each of its parameters.
    pub args: Vec<ShapeArg>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum ShapeArg {
    /// Of the parameter's type. In an axiom it reads uniforms at most.
    Value(Expr),
    /// A float worked out at each point of the shape's curve.
    PerPoint {
        /// What [`ExprKind::Binder`](crate::language::expr::ExprKind::Binder) counts in the value.
        fields: Vec<PointField>,
        value: Expr,
    },
    /// The final word of an earlier curve system of the file.
    Curve { name: String, span: Span },
    /// The final word of an earlier patch system of the file.
    Patch { name: String, span: Span },
}

/// A field that the points of a curve have.
#[derive(Clone, Debug, PartialEq)]
pub struct PointField {
    pub name: String,
    pub ty: Type,
    /// Where it stands: symbols of the curve's system, and the index of the field in each.
    pub places: Vec<(SymbolId, usize)>,
}

/// A module on a face, and its tag.
#[derive(Clone, Debug)]
pub struct FaceModule {
    pub module: Module,
    /// Of type int; all tags of a symbol have the same number of them. Empty: no tag.
    pub tag: Vec<Expr>,
}

/// What a rule of a mesh system makes of the face that it matches, or of the faces that it joins.
#[derive(Clone, Debug)]
pub enum FaceSuccessor {
    /// `eps`: it is removed and leaves a border.
    Erase,
    /// It stays where it is, with another module.
    Relabel(FaceModule),
    /// It is replaced: the base of the template lands on it, and its own loop of vertices stays.
    Replace(Box<TemplateUse>),
    /// `on`: it stays, and a loose copy of the template is set on it.
    Attach(Box<TemplateUse>),
    /// Several faces are replaced by one template; the n-th base lands on the n-th of the
    /// [predecessors](super::Rule::strict), which are faces of equal tag.
    Join(Box<TemplateUse>),
}

/// A template or shape put on a face: `trunk at scale(0.8) uv(0, 1) { top: A(n-1); side: B }`.
#[derive(Clone, Debug)]
pub struct TemplateUse {
    pub template: FaceTemplate,
    pub attachment: Attachment,
    /// A slot that none of them names is terminal: its faces have the slot's name as symbol.
    pub fillings: Vec<Filling>,
    pub span: Span,
}

/// What is put on a face.
#[derive(Clone, Debug)]
pub enum FaceTemplate {
    Template(TemplateId),
    /// One that fits faces with any number of corners.
    Shape(ShapeUse),
}

/// How a template comes to lie on a face.
#[derive(Clone, Debug)]
pub struct Attachment {
    pub pairing: Pairing,
    /// Applied in this order once its base lies on the face, to all vertices but the base's: about the centroid of
    /// the base, z out of the face.
    pub transforms: Vec<Transform>,
    /// Absent: texture coordinates as in the template.
    pub uv: Option<UvRange>,
}

/// Which corner of the face each corner of the base lands on. They run around it in the same sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pairing {
    /// Auto-attachment: as turns the base least from the face, in the sense of least squares.
    Fitted,
    /// `corner`: the first on the first.
    FirstCorners,
}

#[derive(Clone, Debug)]
pub enum Transform {
    /// `scale(s)`: by one factor, a float.
    Scale(Expr),
    /// `scale(x, y, z)`: by a factor along each axis, floats.
    Stretch([Expr; 3]),
    Rotate {
        /// Of type vec3; of any length.
        axis: Expr,
        /// In degrees, a float.
        angle: Expr,
    },
}

/// `uv(u0, u1, v0, v1)`: where 0 and 1 of the texture coordinates of a template go.
#[derive(Clone, Debug)]
pub struct UvRange {
    /// Floats.
    pub u: [Expr; 2],
    /// Floats. Absent: v goes on from that of the face.
    pub v: Option<[Expr; 2]>,
}

/// `top, bottom: A(nth)`: what the faces of these slots become.
#[derive(Clone, Debug)]
pub struct Filling {
    /// At least one, and none twice in one use.
    pub slots: Vec<SlotName>,
    pub fill: Fill,
}

#[derive(Clone, Debug)]
pub enum Fill {
    /// `eps`: they are left out.
    Erase,
    /// Worked out once for each face; `nth` is its number within its slot, from 0.
    Module(FaceModule),
}

/// A mesh that an axiom starts from. Several stand beside one another, unconnected.
#[derive(Clone, Debug)]
pub struct MeshStart {
    pub source: MeshSource,
    /// Applied in this order, about the origin.
    pub transforms: Vec<Transform>,
    /// Absent: texture coordinates as in the source.
    pub uv: Option<UvRange>,
    /// A slot that none of them names is terminal: its faces have the slot's name as symbol. Those of an earlier
    /// system are its symbols, and what is not named stays as it is.
    pub fillings: Vec<Filling>,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub enum MeshSource {
    /// All of a file, or the object in it with this index. Its groups are slots.
    File {
        path: String,
        index: Option<u32>,
        span: Span,
    },
    /// Its bases are slots like its other faces.
    Template {
        template: TemplateId,
        span: Span,
    },
    Shape(ShapeUse),
    /// The final word of an earlier mesh system of the file.
    System {
        name: String,
        span: Span,
    },
}
