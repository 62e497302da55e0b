//! Typed expressions, built only from the operations of [`super::ops`].

use super::ops::Op;
use super::syntax::Span;
use std::fmt;

/// The types of the language. All are static.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Type {
    Bool,
    /// i32, wrapping.
    Int,
    /// f32.
    Float,
    Vec2,
    Vec3,
    Vec4,
    /// A constant list: element type and length.
    List(Box<Type>, usize),
}

impl Type {
    /// How many 4-byte words a parameter of this type takes. Lists are constants, never parameters.
    pub fn words(&self) -> usize {
        match self {
            Type::Bool | Type::Int | Type::Float => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            Type::List(element, length) => element.words() * length,
        }
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Type::Bool => f.write_str("bool"),
            Type::Int => f.write_str("int"),
            Type::Float => f.write_str("float"),
            Type::Vec2 => f.write_str("vec2"),
            Type::Vec3 => f.write_str("vec3"),
            Type::Vec4 => f.write_str("vec4"),
            Type::List(element, length) => write!(f, "list of {length} {element}"),
        }
    }
}

/// A value of the language.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bool(bool),
    Int(i32),
    Float(f32),
    Vec2([f32; 2]),
    Vec3([f32; 3]),
    Vec4([f32; 4]),
    List(Vec<Value>),
}

impl Value {
    pub fn ty(&self) -> Type {
        match self {
            Value::Bool(_) => Type::Bool,
            Value::Int(_) => Type::Int,
            Value::Float(_) => Type::Float,
            Value::Vec2(_) => Type::Vec2,
            Value::Vec3(_) => Type::Vec3,
            Value::Vec4(_) => Type::Vec4,
            Value::List(v) => Type::List(Box::new(v.first().map_or(Type::Float, Value::ty)), v.len()),
        }
    }

    /// The value as the 4-byte words that stand in records and in the environment buffer:
    /// bool as 0 or 1, int as two's complement, float as its bits.
    pub fn words(&self) -> Vec<u32> {
        match self {
            Value::Bool(b) => vec![*b as u32],
            Value::Int(i) => vec![*i as u32],
            Value::Float(x) => vec![x.to_bits()],
            Value::Vec2(v) => v.iter().map(|x| x.to_bits()).collect(),
            Value::Vec3(v) => v.iter().map(|x| x.to_bits()).collect(),
            Value::Vec4(v) => v.iter().map(|x| x.to_bits()).collect(),
            Value::List(v) => v.iter().flat_map(Value::words).collect(),
        }
    }

    /// The inverse of [`Value::words`]. `words` must hold `ty.words()` of them.
    pub fn from_words(ty: &Type, words: &[u32]) -> Value {
        let f = |i: usize| f32::from_bits(words[i]);
        match ty {
            Type::Bool => Value::Bool(words[0] != 0),
            Type::Int => Value::Int(words[0] as i32),
            Type::Float => Value::Float(f(0)),
            Type::Vec2 => Value::Vec2([f(0), f(1)]),
            Type::Vec3 => Value::Vec3([f(0), f(1), f(2)]),
            Type::Vec4 => Value::Vec4([f(0), f(1), f(2), f(3)]),
            Type::List(element, length) => {
                let n = element.words();
                Value::List((0..*length).map(|i| Value::from_words(element, &words[i * n..])).collect())
            }
        }
    }
}

/// As the language writes it.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let float = |x: f32| match x.abs() {
            size if size == 0.0 || (1e-4..1e7).contains(&size) => x.to_string(),
            _ => format!("{x:e}"),
        };
        let vector = |v: &[f32]| v.iter().map(|&x| float(x)).collect::<Vec<_>>().join(", ");
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::Int(i) => write!(f, "{i}"),
            Value::Float(x) => f.write_str(&float(*x)),
            Value::Vec2(v) => write!(f, "({})", vector(v)),
            Value::Vec3(v) => write!(f, "({})", vector(v)),
            Value::Vec4(v) => write!(f, "({})", vector(v)),
            Value::List(list) => {
                let list: Vec<String> = list.iter().map(Value::to_string).collect();
                write!(f, "[{}]", list.join(", "))
            }
        }
    }
}

/// A typed expression. Two that say the same are equal wherever they stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub ty: Type,
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    Literal(Value),
    /// Index into [`Rule::binders`](super::system::Rule::binders); in what is worked out at the points of a curve into
    /// the [fields](super::system::ShapeArg::PerPoint) of these.
    Binder(usize),
    /// Index into [`Rule::lets`](super::system::Rule::lets).
    Let(usize),
    /// Index into [`System::uniforms`](super::system::System::uniforms).
    Uniform(usize),
    /// What the engine knows of the module or the run: `level`, `step`, `centroid`, `nth` …
    /// Its name; its type stands in [`Expr::ty`].
    Attribute(&'static str),
    /// A row of the table of operations.
    Call(Op, Vec<Expr>),
    /// A component of a vector: 0..=3.
    Component(Box<Expr>, usize),
    /// A vector from its components, each of type float.
    Vector(Vec<Expr>),
    /// An element of a constant list, the index clamped.
    Element(Vec<Value>, Box<Expr>),
    /// `rand`, `randn`: the counter-based generator; `site` = index of the call in the rule.
    Random {
        function: &'static str,
        args: Vec<Expr>,
        site: usize,
    },
    /// The value of a host-bound grid query at a point: index into `System::queries`.
    Sample(usize, Box<Expr>),
    /// The value of a host-bound query for the module's root: index into `System::queries`. The
    /// checker binds it by `?E(d)`; plans read it in the binder's place.
    OfRoot(usize),
}

impl Expr {
    pub fn literal(value: Value, span: Span) -> Expr {
        Expr { ty: value.ty(), kind: ExprKind::Literal(value), span }
    }

    /// Calls `visit` on this expression and all below it, outermost first.
    pub fn walk<'a>(&'a self, visit: &mut impl FnMut(&'a Expr)) {
        visit(self);
        match &self.kind {
            ExprKind::Call(_, args) | ExprKind::Vector(args) | ExprKind::Random { args, .. } => {
                args.iter().for_each(|a| a.walk(visit))
            }
            ExprKind::Component(e, _) | ExprKind::Element(_, e) | ExprKind::Sample(_, e) => e.walk(visit),
            ExprKind::Literal(_)
            | ExprKind::Binder(_)
            | ExprKind::Let(_)
            | ExprKind::Uniform(_)
            | ExprKind::Attribute(_)
            | ExprKind::OfRoot(_) => {}
        }
    }
}
