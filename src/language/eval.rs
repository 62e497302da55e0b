//! The host's evaluator: constants, axiom arguments, counts of `run:`, derived consts.
//!
//! It uses the same rows of the table as the backends, one word at a time. For rows that no
//! backend runs yet it has functions of its own in f32, so that every constant folds.

use super::elementary;
use super::expr::{Expr, ExprKind, Type, Value};
use super::numbers::clamped;
use super::ops::{self, Op, Row};
use super::syntax::Span;

/// Why an expression has no value on the host.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvalError {
    #[error("`{what}` has no value here: only constants and params have one before the run")]
    NotConstant { what: String, span: Span },
    #[error("`{what}` cannot be computed on the host")]
    NotOnHost { what: &'static str, span: Span },
}

impl EvalError {
    /// Where it stands.
    pub fn span(&self) -> Span {
        match self {
            EvalError::NotConstant { span, .. } | EvalError::NotOnHost { span, .. } => *span,
        }
    }
}

/// The value of an expression over uniforms alone.
pub fn eval(expr: &Expr, uniforms: &[Value]) -> Result<Value, EvalError> {
    let not_constant = |what: String| EvalError::NotConstant { what, span: expr.span };
    let all = |args: &[Expr]| args.iter().map(|a| eval(a, uniforms)).collect::<Result<Vec<_>, _>>();
    match &expr.kind {
        ExprKind::Literal(value) => Ok(value.clone()),
        ExprKind::Uniform(index) => {
            uniforms.get(*index).cloned().ok_or_else(|| not_constant(format!("uniform {index}")))
        }
        ExprKind::Call(op, args) => apply(*op, &all(args)?)
            .ok_or_else(|| EvalError::NotOnHost { what: op.row().name, span: expr.span }),
        ExprKind::Vector(args) => {
            let components: Option<Vec<f32>> = all(args)?.iter().map(scalar).collect();
            components
                .and_then(|c| vector(&c))
                .ok_or(EvalError::NotOnHost { what: "a vector", span: expr.span })
        }
        ExprKind::Component(base, index) => {
            let value = eval(base, uniforms)?;
            let component = value.components().get(*index).copied();
            component.map(Value::Float).ok_or(EvalError::NotOnHost { what: "a component", span: expr.span })
        }
        ExprKind::Element(list, index) => {
            let Value::Int(index) = eval(index, uniforms)? else {
                return Err(EvalError::NotOnHost { what: "an index", span: expr.span });
            };
            let last = list.len().saturating_sub(1);
            let element = list.get(usize::try_from(index).unwrap_or(0).min(last));
            element.cloned().ok_or(EvalError::NotOnHost { what: "an empty list", span: expr.span })
        }
        ExprKind::Binder(_) => Err(not_constant("a bound name".into())),
        ExprKind::Let(_) => Err(not_constant("a name after `let`".into())),
        ExprKind::Attribute(name) => Err(not_constant(name.to_string())),
        ExprKind::Random { function, .. } => Err(not_constant(function.to_string())),
        ExprKind::OfRoot(_) | ExprKind::Sample(..) => Err(not_constant("a query".into())),
    }
}

/// The value of an operation. `None` if the host has none for it, or if the arguments have not
/// the types of its row.
pub fn apply(op: Op, args: &[Value]) -> Option<Value> {
    let row = op.row();
    if row.args.len() != args.len() || row.args.iter().zip(args).any(|(ty, value)| *ty != value.ty()) {
        return None;
    }
    match row.cpu {
        Some(cpu) => {
            let words: Vec<u32> = args.iter().flat_map(Value::words).collect();
            Some(Value::from_words(&row.result, &[cpu.word(&words)?]))
        }
        None => host(row, args),
    }
}

/// Rows that no backend runs yet.
fn host(row: &Row, args: &[Value]) -> Option<Value> {
    if let [Value::Bool(condition), then, otherwise] = args {
        return Some(if *condition { then.clone() } else { otherwise.clone() });
    }
    let columns: Vec<&[f32]> = args.iter().map(Value::components).collect();
    match columns.as_slice() {
        [a] => one(row.name, a),
        [a, b] => two(row.name, a, b),
        [a, b, c] => three(row.name, a, b, c),
        _ => None,
    }
}

fn one(name: &str, a: &[f32]) -> Option<Value> {
    match name {
        "fract" => components(a, &[0.0], |x, _| x - x.floor()),
        "length" => Some(Value::Float(length(a))),
        "normalize" => components(a, &[length(a)], |x, length| x / length),
        _ => by_component(name, &[a]),
    }
}

fn two(name: &str, a: &[f32], b: &[f32]) -> Option<Value> {
    match (name, a, b) {
        ("%", ..) => components(a, b, |x, y| x - y * (x / y).trunc()),
        ("dot", ..) => Some(Value::Float(dot(a, b))),
        ("distance", ..) => {
            let difference: Vec<f32> = pairs(a, b).map(|(x, y)| x - y).collect();
            Some(Value::Float(length(&difference)))
        }
        ("cross", &[ax, ay], &[bx, by]) => Some(Value::Float(ax * by - ay * bx)),
        ("cross", &[..], &[..]) => cross(a, b).map(Value::Vec3),
        ("rotate", &[x, y], &[angle]) => {
            let (sin, cos) = sine_and_cosine(angle);
            Some(Value::Vec2([x * cos - y * sin, x * sin + y * cos]))
        }
        _ => by_component(name, &[a, b]),
    }
}

fn three(name: &str, a: &[f32], b: &[f32], c: &[f32]) -> Option<Value> {
    match (name, b, c) {
        ("mix", _, &[t]) => components(a, b, |x, y| (x - x * t) + y * t),
        // Its arguments are the two edges, then the place between them.
        ("smoothstep", &[high], &[x]) => components(a, &[high], |low, high| {
            let t = clamped((x - low) / (high - low), 0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }),
        ("rotate", _, &[angle]) => turn(a, b, angle).map(Value::Vec3),
        _ => by_component(name, &[a, b, c]),
    }
}

/// The row of floats of that name for each component; a number goes with each component of a vector.
fn by_component(name: &str, columns: &[&[f32]]) -> Option<Value> {
    let cpu = ops::find(name, &vec![Type::Float; columns.len()]).ok()?.row().cpu?;
    let length = columns.iter().map(|column| column.len()).max()?;
    let word = |i: usize| {
        let args: Option<Vec<u32>> =
            columns.iter().map(|c| Some(c.get(i % c.len().max(1))?.to_bits())).collect();
        cpu.word(&args?).map(f32::from_bits)
    };
    vector(&(0..length).map(word).collect::<Option<Vec<f32>>>()?)
}

fn components(a: &[f32], b: &[f32], f: impl Fn(f32, f32) -> f32) -> Option<Value> {
    vector(&pairs(a, b).map(|(x, y)| f(x, y)).collect::<Vec<_>>())
}

/// Of an angle in degrees, as the backends have it.
fn sine_and_cosine(degrees: f32) -> (f32, f32) {
    let angle = degrees * 0.017453292;
    (elementary::sin(angle), elementary::cos(angle))
}

/// `v` about an axis, by Rodrigues' formula.
fn turn(v: &[f32], axis: &[f32], angle: f32) -> Option<[f32; 3]> {
    let length = length(axis);
    let k: Vec<f32> = axis.iter().map(|x| x / length).collect();
    let (sin, cos) = sine_and_cosine(angle);
    let (side, along) = (cross(&k, v)?, dot(&k, v) * (1.0 - cos));
    let component = |i: usize| Some(v.get(i)? * cos + side[i] * sin + k.get(i)? * along);
    Some([component(0)?, component(1)?, component(2)?])
}

fn cross(a: &[f32], b: &[f32]) -> Option<[f32; 3]> {
    let (&[ax, ay, az], &[bx, by, bz]) = (a, b) else { return None };
    Some([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    pairs(a, b).map(|(x, y)| x * y).sum()
}

fn length(a: &[f32]) -> f32 {
    dot(a, a).sqrt()
}

/// Component by component; a number goes with each component of a vector.
fn pairs<'a>(a: &'a [f32], b: &'a [f32]) -> impl Iterator<Item = (f32, f32)> + 'a {
    a.iter().copied().cycle().zip(b.iter().copied().cycle()).take(a.len().max(b.len()))
}

fn scalar(value: &Value) -> Option<f32> {
    match value {
        Value::Float(x) => Some(*x),
        _ => None,
    }
}

/// A number from one component, a vector from several.
fn vector(components: &[f32]) -> Option<Value> {
    Some(match *components {
        [x] => Value::Float(x),
        [x, y] => Value::Vec2([x, y]),
        [x, y, z] => Value::Vec3([x, y, z]),
        [x, y, z, w] => Value::Vec4([x, y, z, w]),
        _ => return None,
    })
}

impl Value {
    /// The components of a vector, or a float as its only one; none of other values.
    pub fn components(&self) -> &[f32] {
        match self {
            Value::Float(x) => std::slice::from_ref(x),
            Value::Vec2(v) => v,
            Value::Vec3(v) => v,
            Value::Vec4(v) => v,
            Value::Bool(_) | Value::Int(_) | Value::List(_) => &[],
        }
    }
}
