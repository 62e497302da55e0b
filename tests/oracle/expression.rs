//! Expressions, evaluated by walking the syntax tree once for every module.

use super::lots;
use super::value::{Ratio, Value};
use burgeon::language::syntax::{BinaryOp, Const, Expr, ExprKind, Param as ParamDecl, UnaryOp};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Where names get their values from, nearest first: a binder hides a const, which hides an attribute.
pub struct Scope<'a> {
    /// Names that the predecessor and its `let`s bind.
    pub bound: Vec<(String, Value)>,
    pub constants: &'a Constants,
    pub attributes: &'a dyn Fn(&str) -> Option<Value>,
    /// The hash of the call of `rand` or `randn` that stands at this place of the text.
    pub random: Option<&'a dyn Fn(u32) -> u32>,
}

impl Scope<'_> {
    pub fn bound(&self, name: &str) -> Option<&Value> {
        self.bound.iter().find(|(n, _)| n == name).map(|(_, value)| value)
    }

    fn lookup(&self, name: &str) -> Value {
        let bound = self.bound(name).cloned();
        bound
            .or_else(|| self.constants.get(name).cloned())
            .or_else(|| (self.attributes)(name))
            .or(match name {
                "pi" => Some(Value::Float(std::f64::consts::PI)),
                "tau" => Some(Value::Float(std::f64::consts::TAU)),
                // A param that is there undeclared.
                "detail" => Some(Value::Int(1)),
                _ => None,
            })
            .unwrap_or_else(|| panic!("the oracle does not know the name `{name}`"))
    }
}

/// The values of consts and params.
#[derive(Clone, Debug, Default)]
pub struct Constants {
    values: HashMap<String, Value>,
}

/// A const or param as written; the value of a param may be overridden.
#[derive(Clone, Copy)]
pub enum Declaration<'a> {
    Const(&'a Const),
    Param(&'a ParamDecl),
}

impl Declaration<'_> {
    fn parts(&self) -> (&str, Option<&str>, &Expr) {
        match self {
            Declaration::Const(c) => (&c.name.text, c.ty.as_ref().map(|t| t.text.as_str()), &c.value),
            Declaration::Param(p) => (&p.name.text, p.ty.as_ref().map(|t| t.text.as_str()), &p.value),
        }
    }
}

impl Constants {
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.values.get(name)
    }

    /// These constants and, hiding them, those of an inner scope. Declarations stand in any order.
    pub fn extended(&self, declarations: &[Declaration], overrides: &[(String, Value)]) -> Constants {
        let mut inner = self.clone();
        for declaration in declarations {
            inner.values.remove(declaration.parts().0);
        }
        for declaration in declarations {
            inner.define(*declaration, declarations, overrides, 0);
        }
        inner
    }

    /// Defines a constant, after all those that it reads.
    fn define(
        &mut self,
        wanted: Declaration,
        all: &[Declaration],
        overrides: &[(String, Value)],
        depth: usize,
    ) {
        let (name, ty, expr) = wanted.parts();
        assert!(depth <= all.len(), "`{name}` is defined by itself");
        if self.values.contains_key(name) {
            return;
        }
        for read in names(expr) {
            if let Some(other) = all.iter().find(|d| d.parts().0 == read) {
                self.define(*other, all, overrides, depth + 1);
            }
        }
        let scope = Scope { bound: Vec::new(), constants: self, attributes: &|_| None, random: None };
        let written = evaluate(expr, &scope).settle();
        let set = overrides.iter().find(|(n, _)| n == name && matches!(wanted, Declaration::Param(_)));
        // An override takes the type that the declaration has, written or not.
        let ty = ty.unwrap_or(match written {
            Value::Int(_) => "int",
            Value::Float(_) => "float",
            Value::Bool(_) => "bool",
            _ => "",
        });
        let value = set.map_or(written, |(_, value)| value.clone());
        let value = if ty.is_empty() { value } else { value.coerce(ty) };
        self.values.insert(name.to_string(), value);
    }
}

/// All names in an expression.
fn names(expr: &Expr) -> Vec<&str> {
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::Bool(_) => Vec::new(),
        ExprKind::Name(name) => vec![name],
        ExprKind::Call(_, all) | ExprKind::Vector(all) | ExprKind::List(all) => {
            all.iter().flat_map(names).collect()
        }
        ExprKind::Field(e, _) | ExprKind::Unary(_, e) => names(e),
        ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => [names(a), names(b)].concat(),
    }
}

/// Where the calls of `rand` and `randn` in an expression stand in the text.
pub fn random_calls(expr: &Expr) -> Vec<u32> {
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::Bool(_) | ExprKind::Name(_) => Vec::new(),
        ExprKind::Call(name, args) => {
            let own = matches!(name.text.as_str(), "rand" | "randn").then_some(name.span.start);
            own.into_iter().chain(args.iter().flat_map(random_calls)).collect()
        }
        ExprKind::Vector(all) | ExprKind::List(all) => all.iter().flat_map(random_calls).collect(),
        ExprKind::Field(e, _) | ExprKind::Unary(_, e) => random_calls(e),
        ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => [random_calls(a), random_calls(b)].concat(),
    }
}

pub fn evaluate(expr: &Expr, scope: &Scope) -> Value {
    match &expr.kind {
        ExprKind::Number(number) => Value::Exact(Ratio::parse(&number.text)),
        ExprKind::Bool(b) => Value::Bool(*b),
        ExprKind::Name(name) => scope.lookup(name),
        ExprKind::Call(name, args) if matches!(name.text.as_str(), "rand" | "randn") => {
            let hash = scope.random.unwrap_or_else(|| panic!("the oracle draws no `{}` here", name.text));
            let bounds: Vec<f64> = args.iter().map(|a| evaluate(a, scope).float()).collect();
            Value::Float(lots::number(&name.text, &bounds, hash(name.span.start)))
        }
        ExprKind::Call(name, args) => {
            // A function's arguments have types, so a numeral settles here.
            let args = args.iter().map(|a| evaluate(a, scope).settle()).collect();
            call(&name.text, args)
        }
        ExprKind::Vector(items) => Value::Vector(items.iter().map(|e| evaluate(e, scope).float()).collect()),
        ExprKind::List(items) => Value::List(items.iter().map(|e| evaluate(e, scope)).collect()),
        ExprKind::Field(vector, axis) => {
            let axis = ["x", "y", "z", "w"].iter().position(|a| *a == axis.text).expect("x, y, z or w");
            Value::Float(evaluate(vector, scope).vector()[axis])
        }
        ExprKind::Index(list, index) => element(evaluate(list, scope), evaluate(index, scope).int()),
        ExprKind::Unary(UnaryOp::Neg, e) => evaluate(e, scope).negate(),
        ExprKind::Unary(UnaryOp::Not, e) => Value::Bool(!evaluate(e, scope).bool()),
        ExprKind::Binary(op, a, b) => binary(*op, evaluate(a, scope), evaluate(b, scope)),
    }
}

/// An index is clamped.
fn element(list: Value, index: i32) -> Value {
    match list {
        Value::List(items) => items[(index.max(0) as usize).min(items.len() - 1)].clone().settle(),
        other => panic!("{other:?} is no list"),
    }
}

fn binary(op: BinaryOp, a: Value, b: Value) -> Value {
    let ordered =
        |a: Value, b: Value, holds: fn(Ordering) -> bool| Value::Bool(a.order(b).is_some_and(holds));
    match op {
        BinaryOp::Or => Value::Bool(a.bool() | b.bool()),
        BinaryOp::And => Value::Bool(a.bool() & b.bool()),
        BinaryOp::Equal => Value::Bool(a.equals(b)),
        BinaryOp::NotEqual => Value::Bool(!a.equals(b)),
        BinaryOp::Less => ordered(a, b, Ordering::is_lt),
        BinaryOp::LessEqual => ordered(a, b, Ordering::is_le),
        BinaryOp::Greater => ordered(a, b, Ordering::is_gt),
        BinaryOp::GreaterEqual => ordered(a, b, Ordering::is_ge),
        BinaryOp::Add => a.arithmetic('+', b),
        BinaryOp::Sub => a.arithmetic('-', b),
        BinaryOp::Mul => a.arithmetic('*', b),
        BinaryOp::Div => a.arithmetic('/', b),
        BinaryOp::Rem => a.arithmetic('%', b),
    }
}

/// The functions of the reference, but for `noise`, which is no more than its own text. Anything else
/// stops the oracle: better no answer than a guess.
fn call(name: &str, args: Vec<Value>) -> Value {
    if args.iter().any(|a| matches!(a, Value::Vector(_))) {
        return vector_call(name, args);
    }
    let count = args.len();
    let mut args = args.into_iter();
    let mut next = || args.next().expect("too few arguments");
    match (name, count) {
        ("if", 3) => {
            let condition = next().bool();
            let (a, b) = next().unify(next());
            if condition { a } else { b }
        }
        ("min", 2) => least(next(), next()),
        ("max", 2) => greatest(next(), next()),
        ("clamp", 3) => {
            let (x, low, high) = (next(), next(), next());
            least(greatest(x, low), high)
        }
        ("abs", 1) => match next() {
            Value::Int(i) => Value::Int(i.wrapping_abs()),
            x => Value::Float(x.float().abs()),
        },
        ("sign", 1) => match next() {
            Value::Int(i) => Value::Int(i.signum()),
            x => Value::Float(x.float()).order(Value::Int(0)).map_or(Value::Float(0.0), sign),
        },
        ("int", 1) => match next() {
            Value::Bool(b) => Value::Int(b as i32),
            Value::Int(i) => Value::Int(i),
            x => Value::Int(x.float().clamp(-2147483648.0, 2147483520.0) as i32),
        },
        ("float", 1) => match next() {
            Value::Bool(b) => Value::Float(f64::from(b)),
            x => Value::Float(x.float()),
        },
        _ => {
            let numbers: Vec<f64> = args.map(Value::float).collect();
            let known = number_call(name, &numbers);
            Value::Float(known.unwrap_or_else(|| panic!("the oracle does not know `{name}` of {count}")))
        }
    }
}

/// Functions of floats.
fn number_call(name: &str, args: &[f64]) -> Option<f64> {
    Some(match (name, args) {
        ("floor", [x]) => x.floor(),
        ("ceil", [x]) => x.ceil(),
        ("round", [x]) => x.round_ties_even(),
        ("trunc", [x]) => x.trunc(),
        ("fract", [x]) => x - x.floor(),
        ("sqrt", [x]) => x.sqrt(),
        // Clamped to what f32 holds.
        ("exp", [x]) => x.clamp(-87.0, 88.0).exp(),
        ("exp2", [x]) => x.clamp(-126.0, 127.0).exp2(),
        // Where there is none, the least float.
        ("log" | "log2", [x]) if *x <= 0.0 => f32::MIN.into(),
        ("log", [x]) => x.ln(),
        ("log2", [x]) => x.log2(),
        ("pow", [_, 0.0]) => 1.0,
        ("pow", [x, y]) => x.max(0.0).powf(*y) * f64::from(*x > 0.0),
        ("sin", [x]) => x.sin(),
        ("cos", [x]) => x.cos(),
        ("tan", [x]) => x.tan(),
        ("asin", [x]) => x.clamp(-1.0, 1.0).asin(),
        ("acos", [x]) => x.clamp(-1.0, 1.0).acos(),
        ("atan", [x]) => x.atan(),
        ("atan2", [y, x]) => y.atan2(*x),
        ("radians", [x]) => x.to_radians(),
        ("degrees", [x]) => x.to_degrees(),
        ("step", [edge, x]) => f64::from(*x >= *edge),
        ("mix", [a, b, t]) => a + (b - a) * t,
        ("smoothstep", [low, high, x]) => {
            let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }
        ("abs", [x]) => x.abs(),
        ("sign", [x]) => f64::from(*x > 0.0) - f64::from(*x < 0.0),
        ("min", [a, b]) => a.min(*b),
        ("max", [a, b]) => a.max(*b),
        ("clamp", [x, low, high]) => x.max(*low).min(*high),
        _ => return None,
    })
}

/// Functions of vectors; most go by components.
fn vector_call(name: &str, args: Vec<Value>) -> Value {
    let part = |value: &Value, axis: usize| match value {
        Value::Vector(v) => v[axis],
        number => number.clone().float(),
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    match (name, args.as_slice()) {
        ("if", [condition, a, b]) => {
            if condition.clone().bool() {
                a.clone()
            } else {
                b.clone()
            }
        }
        ("length", [Value::Vector(v)]) => Value::Float(length(v)),
        ("distance", [a, b]) => Value::Float(length(&a.clone().arithmetic('-', b.clone()).vector())),
        ("dot", [Value::Vector(a), Value::Vector(b)]) => Value::Float(dot(a, b)),
        ("normalize", [Value::Vector(v)]) => Value::Vector(v.iter().map(|x| x / length(v)).collect()),
        ("cross", [Value::Vector(a), Value::Vector(b)]) if a.len() == 2 => {
            Value::Float(a[0] * b[1] - a[1] * b[0])
        }
        ("cross", [Value::Vector(a), Value::Vector(b)]) => Value::Vector(cross(a, b).to_vec()),
        ("rotate", [Value::Vector(v), angle]) => {
            let (sin, cos) = angle.clone().float().to_radians().sin_cos();
            Value::Vector(vec![v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos])
        }
        ("rotate", [Value::Vector(v), Value::Vector(axis), angle]) => {
            let (sin, cos) = angle.clone().float().to_radians().sin_cos();
            let k: Vec<f64> = axis.iter().map(|x| x / length(axis)).collect();
            let (side, along) = (cross(&k, v), dot(&k, v));
            let turned = |i: usize| v[i] * cos + side[i] * sin + k[i] * along * (1.0 - cos);
            Value::Vector([0, 1, 2].map(turned).to_vec())
        }
        _ => {
            let axes = args.iter().map(|a| if let Value::Vector(v) = a { v.len() } else { 0 }).max();
            let component = |axis: usize| {
                let numbers: Vec<f64> = args.iter().map(|a| part(a, axis)).collect();
                number_call(name, &numbers).unwrap_or_else(|| panic!("the oracle does not know `{name}`"))
            };
            Value::Vector((0..axes.unwrap_or(0)).map(component).collect())
        }
    }
}

fn cross(a: &[f64], b: &[f64]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sign(order: Ordering) -> Value {
    Value::Float(order as i8 as f64)
}

fn least(a: Value, b: Value) -> Value {
    let (a, b) = a.unify(b);
    if b.clone().order(a.clone()) == Some(Ordering::Less) { b } else { a }
}

fn greatest(a: Value, b: Value) -> Value {
    let (a, b) = a.unify(b);
    if b.clone().order(a.clone()) == Some(Ordering::Greater) { b } else { a }
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
