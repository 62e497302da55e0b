//! What an expression of a rule is while the points are not known: a value that is the same wherever they are, a
//! linear combination of them, or neither.

use super::number::Number;
use crate::language::Span;
use crate::language::eval;
use crate::language::expr::{Expr, ExprKind, Value};
use crate::language::rational::Rational;

/// Coefficients of points by their index, in ascending order; none of them is 0.
pub type Row = Vec<(u32, Number)>;

/// A linear combination of points.
#[derive(Clone, Debug, Default)]
pub struct Point {
    pub row: Row,
    /// Rounding of the combination as it is written, in single precision: at most so many units of 2⁻²⁴ times the greatest
    /// coordinate (Higham, *Accuracy and Stability of Numerical Algorithms*, section 3.3).
    pub rounding: f64,
}

#[derive(Clone, Debug)]
pub enum Form {
    /// Its value as the backends have it, and for an int or a float the number that it stands for.
    Known(Value, Number),
    Point(Point),
    /// What stands in the way, and where.
    Other(String, Span),
}

impl Point {
    /// The control point of this index.
    pub fn control(index: u32) -> Point {
        Point { row: vec![(index, Number::ONE)], rounding: 0.0 }
    }

    /// Σ |coefficient|: the greatest coordinate it has where those of the points are 1 at most.
    pub fn magnitude(&self) -> f64 {
        self.row.iter().map(|(_, x)| x.to_f64().abs()).sum()
    }

    fn times(&self, factor: Number) -> Point {
        let product = |&(i, x): &(u32, Number)| (i, x * factor);
        let mut scaled = Point {
            row: self.row.iter().map(product).collect(),
            rounding: self.rounding * factor.to_f64().abs(),
        };
        scaled.row.retain(|(_, x)| !x.is_zero());
        scaled
    }

    /// One more operation that rounds.
    fn rounded(mut self) -> Point {
        self.rounding += self.magnitude();
        self
    }

    fn plus(&self, other: &Point) -> Point {
        let (mut a, mut b) = (self.row.iter().peekable(), other.row.iter().peekable());
        let mut row = Row::with_capacity(self.row.len() + other.row.len());
        loop {
            let (x, y) = (a.peek().map(|x| x.0), b.peek().map(|y| y.0));
            let entry = match (x, y) {
                (Some(i), Some(j)) if i == j => a.next().zip(b.next()).map(|(x, y)| (i, x.1 + y.1)),
                (Some(i), Some(j)) if i > j => b.next().copied(),
                (None, _) => b.next().copied(),
                _ => a.next().copied(),
            };
            match entry {
                None => break,
                Some((_, x)) if x.is_zero() => {}
                Some(entry) => row.push(entry),
            }
        }
        Point { row, rounding: self.rounding + other.rounding }
    }
}

impl Form {
    /// A value that is written, or that a param has.
    pub fn known(value: Value, exact: bool) -> Form {
        let number = match &value {
            Value::Int(i) if exact => Number::whole((*i).into()),
            Value::Int(i) => Number::Float((*i).into()),
            Value::Float(x) => match Rational::nearest_simple(*x).filter(|_| exact) {
                Some(fraction) => Number::Exact(fraction),
                None => Number::Float((*x).into()),
            },
            _ => Number::ZERO,
        };
        Form::Known(value, number)
    }

    /// As a combination of points: the zero vector is one, of no point.
    fn point(&self) -> Option<Point> {
        match self {
            Form::Point(point) => Some(point.clone()),
            Form::Known(value, _) => {
                let parts = value.components();
                (parts.len() > 1 && parts.iter().all(|x| *x == 0.0)).then(Point::default)
            }
            Form::Other(..) => None,
        }
    }

    /// The point that a field holds.
    ///
    /// # Errors
    /// What stands in the way, and where, if anything but `span`.
    pub fn into_point(self, span: Span) -> Result<Point, (String, Span)> {
        match self {
            Form::Other(what, at) => Err((what, at)),
            form => form.point().ok_or(("the point stands still, whatever the others do".to_string(), span)),
        }
    }
}

/// What the names of an expression mean.
pub struct Scope<'a> {
    pub uniforms: &'a [Form],
    /// The predecessor's fields, then those that the rule reads around it.
    pub fields: &'a [Form],
    pub lets: &'a [Form],
    pub step: u32,
    /// Coefficients are fractions wherever that is possible; else they are what the backends have.
    pub exact: bool,
}

/// The form of an expression.
pub fn evaluate(e: &Expr, scope: &Scope) -> Form {
    let other = |what: &str| Form::Other(what.to_string(), e.span);
    let all = |args: &[Expr]| args.iter().map(|a| evaluate(a, scope)).collect::<Vec<_>>();
    let named =
        |forms: &[Form], n: usize| forms.get(n).cloned().unwrap_or_else(|| other("a name has no value"));
    match &e.kind {
        ExprKind::Literal(value) => Form::known(value.clone(), scope.exact),
        ExprKind::Binder(n) => named(scope.fields, *n),
        ExprKind::Let(n) => named(scope.lets, *n),
        ExprKind::Uniform(n) => named(scope.uniforms, *n),
        ExprKind::Attribute("step") => Form::known(Value::Int(scope.step as i32), scope.exact),
        ExprKind::Attribute(name) => other(&format!("it depends on `{name}`")),
        ExprKind::Call(op, args) => {
            call(op.row().name, &all(args), e, scope.exact, &|values| eval::apply(*op, values))
        }
        ExprKind::Vector(args) => match known(&all(args)) {
            Ok(values) => {
                let literals = values.into_iter().map(|v| Expr::literal(v, e.span)).collect();
                let vector = Expr { kind: ExprKind::Vector(literals), ..e.clone() };
                eval::eval(&vector, &[]).map_or_else(|_| other("a vector"), |v| Form::known(v, scope.exact))
            }
            Err(why) => why.unwrap_or_else(|| other("a vector is made of a point")),
        },
        ExprKind::Component(base, n) => match evaluate(base, scope) {
            Form::Known(value, _) => match value.components().get(*n) {
                Some(x) => Form::known(Value::Float(*x), scope.exact),
                None => other("a component"),
            },
            Form::Point(_) => other("it reads a single coordinate of a point"),
            why => why,
        },
        ExprKind::Element(list, index) => match evaluate(index, scope) {
            Form::Known(Value::Int(i), _) => {
                let at = usize::try_from(i).unwrap_or(0).min(list.len().saturating_sub(1));
                list.get(at).map_or_else(|| other("a list"), |v| Form::known(v.clone(), scope.exact))
            }
            Form::Other(what, span) => Form::Other(what, span),
            _ => other("an index depends on the points"),
        },
        ExprKind::Random { function, .. } => other(&format!("it depends on `{function}`, which is random")),
        ExprKind::Sample(..) | ExprKind::OfRoot(_) => other("it depends on a query"),
    }
}

/// The values, if all are known; else the first that is neither known nor a point.
fn known(forms: &[Form]) -> Result<Vec<Value>, Option<Form>> {
    if let Some(why) = forms.iter().find(|f| matches!(f, Form::Other(..))) {
        return Err(Some(why.clone()));
    }
    let value = |f: &Form| match f {
        Form::Known(value, _) => Some(value.clone()),
        _ => None,
    };
    forms.iter().map(value).collect::<Option<Vec<_>>>().ok_or(None)
}

fn call(name: &str, args: &[Form], e: &Expr, exact: bool, apply: &dyn Fn(&[Value]) -> Option<Value>) -> Form {
    if let ("if", [Form::Known(Value::Bool(condition), _), then, otherwise]) = (name, args) {
        return if *condition { then.clone() } else { otherwise.clone() };
    }
    match known(args) {
        Ok(values) => match apply(&values) {
            Some(value @ Value::Float(_)) if exact => {
                let float = Number::Float(value.components()[0].into());
                let number = arithmetic(name, args).unwrap_or(float);
                Form::Known(value, number)
            }
            Some(value) => Form::known(value, exact),
            None => Form::Other(format!("`{name}` has no value here"), e.span),
        },
        Err(Some(why)) => why,
        Err(None) => combination(name, args).map_or_else(|what| Form::Other(what, e.span), Form::Point),
    }
}

/// The number that an operation on numbers gives, where fractions are closed under it.
fn arithmetic(name: &str, args: &[Form]) -> Option<Number> {
    let numbers = args.iter().map(|arg| match arg {
        Form::Known(Value::Int(_) | Value::Float(_), x) => Some(*x),
        _ => None,
    });
    match (name, numbers.collect::<Option<Vec<Number>>>()?.as_slice()) {
        ("+", &[a, b]) => Some(a + b),
        ("-", &[a, b]) => Some(a - b),
        ("*", &[a, b]) => Some(a * b),
        ("/", &[a, b]) if !b.is_zero() => Some(a / b),
        ("-", &[a]) => Some(-a),
        ("float", &[a]) => Some(a),
        _ => None,
    }
}

/// An operation of which at least one argument is a point.
fn combination(name: &str, args: &[Form]) -> Result<Point, String> {
    use Form::{Known, Point as P};
    let added = || "a vector that stands still is added to a point".to_string();
    match (name, args) {
        ("-", [P(a)]) => Ok(a.times(Number::whole(-1))),
        ("+" | "-", [a, b]) => {
            let (a, b) = (a.point().ok_or_else(added)?, b.point().ok_or_else(added)?);
            let b = if name == "-" { b.times(Number::whole(-1)) } else { b };
            Ok(a.plus(&b).rounded())
        }
        ("*", [P(a), Known(Value::Float(_), x)] | [Known(Value::Float(_), x), P(a)]) => {
            Ok(a.times(*x).rounded())
        }
        ("/", [P(a), Known(Value::Float(_), x)]) if !x.is_zero() => Ok(a.times(Number::ONE / *x).rounded()),
        ("*", [P(_), P(_)]) => Err("points are multiplied with each other".to_string()),
        // (a - a·t) + b·t
        ("mix", [a, b, Known(Value::Float(_), t)]) => {
            let (a, b) = (a.point().ok_or_else(added)?, b.point().ok_or_else(added)?);
            let less = a.plus(&a.times(*t).rounded().times(Number::whole(-1))).rounded();
            Ok(less.plus(&b.times(*t).rounded()).rounded())
        }
        ("if", _) => Err("a condition depends on the points".to_string()),
        _ => Err(format!("`{name}` of a point is no combination of points")),
    }
}
