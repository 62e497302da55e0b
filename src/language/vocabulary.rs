//! What the caller of the checker knows and the language does not: schemes, attributes, shapes.
//!
//! The language fixes how these are written, not which there are. An engine with a further scheme
//! or attribute hands in a [`Vocabulary`] with one more entry.

use super::expr::{Type, Value};
use super::system::Kind;

/// The names that rule files may use without declaring them.
#[derive(Clone, Debug)]
pub struct Vocabulary {
    pub schemes: Vec<Scheme>,
    pub attributes: Vec<Attribute>,
    pub shapes: Vec<Shape>,
    /// Params that exist undeclared, with their defaults. One that is used becomes a uniform.
    pub params: Vec<(&'static str, Value)>,
    /// Named numbers.
    pub constants: Vec<(&'static str, f32)>,
}

/// A scheme that `subdivide` knows.
#[derive(Clone, Debug)]
pub struct Scheme {
    pub name: &'static str,
    pub of: SchemeKind,
    pub doc: &'static str,
}

/// What a scheme subdivides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemeKind {
    Curve,
    Patch,
    Mesh,
}

impl SchemeKind {
    /// Whether systems of this kind hold what the scheme subdivides.
    pub fn fits(self, kind: Kind) -> bool {
        matches!(
            (self, kind),
            (SchemeKind::Curve, Kind::Curve(_))
                | (SchemeKind::Patch, Kind::Patch { .. })
                | (SchemeKind::Mesh, Kind::Mesh)
        )
    }
}

/// A value that the engine knows of the module, the edge, the place or the run.
#[derive(Clone, Debug)]
pub struct Attribute {
    pub name: &'static str,
    pub ty: Type,
    pub of: Owner,
    pub doc: &'static str,
}

/// Where an attribute has a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Rules and queries of patch systems.
    Patch,
    /// Rules, queries and marks of mesh systems.
    Face,
    /// `crease`.
    Edge,
    /// `place` of mesh systems.
    Place,
    /// `place` of patch systems, which displaces their tessellation. What is known there must not hang on
    /// how fine that is.
    Displacement,
    /// Expressions in slots.
    Slot,
    /// All rules.
    Rule,
}

impl Owner {
    /// Where that is, in words.
    pub fn describe(self) -> &'static str {
        match self {
            Owner::Patch => "the rules and queries of patch systems",
            Owner::Face => "the rules, queries and marks of mesh systems",
            Owner::Edge => "`crease`",
            Owner::Place => "`place` of mesh systems",
            Owner::Displacement => "`place` of patch systems",
            Owner::Slot => "slots",
            Owner::Rule => "rules",
        }
    }
}

/// A mesh that is made from arguments.
#[derive(Clone, Debug)]
pub struct Shape {
    pub name: &'static str,
    pub role: Role,
    pub parameters: Vec<Parameter>,
    pub slots: Slots,
    pub doc: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A mesh that an axiom starts from.
    Axiom,
    /// A template that replaces a face with any number of corners.
    Template,
}

/// An argument of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: &'static str,
    pub kind: ParameterKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ParameterKind {
    Value(Type),
    /// A float that is evaluated at each point of the curve and sees the fields of its modules.
    PerPoint,
    /// The name of an earlier curve system.
    Curve,
    /// The name of an earlier patch system.
    Patch,
}

/// The slots of a shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Slots {
    Named(Vec<Slot>),
    /// The symbols of the earlier system that is its argument.
    SymbolsOf,
}

/// A slot, and how many corners each of its faces has, where that is always the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    pub name: &'static str,
    pub corners: Option<usize>,
}

impl Default for Vocabulary {
    /// The names of the language's reference.
    fn default() -> Vocabulary {
        Vocabulary {
            schemes: schemes(),
            attributes: attributes(),
            shapes: shapes(),
            params: vec![("detail", Value::Int(1))],
            constants: vec![("pi", std::f32::consts::PI), ("tau", std::f32::consts::TAU)],
        }
    }
}

fn schemes() -> Vec<Scheme> {
    let scheme = |name, doc| Scheme { name, of: SchemeKind::Mesh, doc };
    vec![
        scheme("catmull_clark", "Quads from any faces; smooth but at creases and borders."),
        scheme("loop", "Triangles from triangles."),
        scheme("sqrt3", "Triangles from triangles, three for one."),
        scheme("doo_sabin", "A face for each vertex, edge and face."),
        scheme("bilinear", "Quads from any faces, without smoothing."),
    ]
}

fn attributes() -> Vec<Attribute> {
    use Owner::{Displacement, Edge, Face, Patch, Place, Rule, Slot};
    use Type::{Bool, Float, Int, Vec2, Vec3, Vec4};
    let all: [(&'static str, Type, Owner, &'static str); 36] = [
        ("centroid", Vec3, Patch, "Mean of the control points."),
        (
            "flatness",
            Float,
            Patch,
            "Greatest distance of a control point from the bilinear patch of the corners, at the same parameters.",
        ),
        ("bend_u", Float, Patch, "Greatest second difference along u."),
        ("bend_v", Float, Patch, "Greatest second difference along v."),
        (
            "area",
            Float,
            Patch,
            "Areas of the net's quads, summed: half the cross product of the diagonals each.",
        ),
        (
            "bbox_px",
            Float,
            Patch,
            "Greater side of the net's box on the screen, in pixels: 0 behind the viewer, 3.4e38 where it reaches through the viewer's plane.",
        ),
        (
            "area_px",
            Float,
            Patch,
            "Areas of the net's quads on the screen, summed, in pixels; behind the viewer as `bbox_px`.",
        ),
        ("level", Int, Patch, "The greater of its halvings along u and v."),
        ("uv", Vec2, Patch, "Its centre in the axiom's square."),
        ("centroid", Vec3, Face, "Mean of the corners."),
        ("normal", Vec3, Face, "Unit normal."),
        ("area", Float, Face, "Area."),
        ("sides", Int, Face, "Number of corners."),
        ("size", Float, Face, "Mean of the diagonals; of a triangle its longest edge."),
        ("level", Int, Face, "Subdivisions since the axiom."),
        ("uv", Vec2, Face, "Mean of the texture coordinates of the corners."),
        ("dihedral", Float, Edge, "Angle between the two faces, in degrees."),
        ("length", Float, Edge, "Length."),
        ("boundary", Bool, Edge, "It has one face only."),
        ("p", Vec3, Place, "The smooth position."),
        ("old", Vec3, Place, "The position before the step."),
        ("normal", Vec3, Place, "Area-weighted mean of the normals of the faces there."),
        ("scale", Float, Place, "Mean of all diagonals of the faces there."),
        ("frame", Vec4, Place, "Local axes, z along the normal; only as `frame * vector`."),
        ("uv", Vec2, Place, "Texture coordinates."),
        ("level", Int, Place, "Subdivisions since the axiom."),
        ("id", Int, Place, "Number of the vertex."),
        ("p", Vec3, Displacement, "The smooth position, on the patch."),
        ("old", Vec3, Displacement, "The same: nothing has moved it before."),
        ("normal", Vec3, Displacement, "Unit normal; where patches meet, the mean of theirs."),
        (
            "scale",
            Float,
            Displacement,
            "Mean of the two diagonals between the corners of the patch's control net, however finely it is cut.",
        ),
        (
            "frame",
            Vec4,
            Displacement,
            "Local axes: x along u, y along v and at right angles to it, z along the normal; only as `frame * vector`.",
        ),
        ("uv", Vec2, Displacement, "Place in the unit square of the axiom's patch, as its file has it."),
        ("id", Int, Displacement, "Number of the axiom's patch, from 0."),
        ("nth", Int, Slot, "Number of the face among those of the slot."),
        ("step", Int, Rule, "Steps done in this `derive`."),
    ];
    all.into_iter().map(|(name, ty, of, doc)| Attribute { name, ty, of, doc }).collect()
}

fn shapes() -> Vec<Shape> {
    use ParameterKind::{Curve, Patch, PerPoint, Value};
    let parameter = |(name, kind): (&'static str, ParameterKind)| Parameter { name, kind };
    let shape = |name, role, parameters: Vec<(&'static str, ParameterKind)>, slots, doc| Shape {
        name,
        role,
        parameters: parameters.into_iter().map(parameter).collect(),
        slots,
        doc,
    };
    let slots = |names: &[(&'static str, Option<usize>)]| {
        Slots::Named(names.iter().map(|&(name, corners)| Slot { name, corners }).collect())
    };
    let (int, float) = (|| Value(Type::Int), || Value(Type::Float));
    vec![
        shape(
            "grid",
            Role::Axiom,
            vec![("m", int()), ("n", int()), ("size", float())],
            slots(&[("face", Some(4))]),
            "m by n quads in a square of that size.",
        ),
        shape(
            "disc",
            Role::Axiom,
            vec![("n", int()), ("r", float())],
            slots(&[("face", None)]),
            "One regular n-gon of radius r.",
        ),
        shape(
            "box",
            Role::Axiom,
            vec![("x", float()), ("y", float()), ("z", float())],
            slots(&[("top", Some(4)), ("bottom", Some(4)), ("side", Some(4))]),
            "A box of that size.",
        ),
        shape(
            "tube",
            Role::Axiom,
            vec![("c", Curve), ("n", int()), ("r", PerPoint)],
            slots(&[("side", Some(4)), ("start", None), ("end", None)]),
            "An n-sided tube of radius r along a curve.",
        ),
        shape("fill", Role::Axiom, vec![("c", Curve)], slots(&[("face", None)]), "The inside of a ring."),
        shape(
            "revolve",
            Role::Axiom,
            vec![("c", Curve), ("n", int())],
            slots(&[("side", None), ("start", None), ("end", None)]),
            "A curve turned about the y axis in n steps.",
        ),
        shape(
            "leaves",
            Role::Axiom,
            vec![("p", Patch)],
            Slots::SymbolsOf,
            "Each net of a patch word as one face.",
        ),
        shape(
            "extrude",
            Role::Template,
            vec![("h", float())],
            slots(&[("top", None), ("side", Some(4))]),
            "The face lifted along its normal.",
        ),
        shape(
            "inset",
            Role::Template,
            vec![("r", float())],
            slots(&[("top", None), ("side", Some(4))]),
            "A smaller face within it.",
        ),
    ]
}
