//! Values and arithmetic of the language, from its page "Numbers".

use std::cmp::Ordering;

/// An exact rational in lowest terms, the denominator positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    pub numerator: i128,
    pub denominator: i128,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Of numerals only; neither int nor float before it meets something that is.
    Exact(Ratio),
    Int(i32),
    Float(f64),
    Bool(bool),
    Vector(Vec<f64>),
    List(Vec<Value>),
}

impl Ratio {
    pub fn new(numerator: i128, denominator: i128) -> Ratio {
        assert_ne!(denominator, 0, "a constant divided by 0");
        let sign = denominator.signum();
        let divisor = gcd(numerator.abs(), denominator.abs()).max(1) * sign;
        Ratio { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    pub fn whole(number: i128) -> Ratio {
        Ratio::new(number, 1)
    }

    /// A numeral: digits, perhaps a point, perhaps an exponent of ten.
    pub fn parse(text: &str) -> Ratio {
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let (digits, decimals) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all: i128 = format!("{digits}{decimals}").parse().unwrap_or_else(|_| panic!("numeral {text}"));
        let exponent: i32 = exponent.parse().unwrap_or_else(|_| panic!("numeral {text}"));
        let scale = exponent - decimals.len() as i32;
        let power = 10i128.pow(scale.unsigned_abs());
        if scale >= 0 { Ratio::whole(all * power) } else { Ratio::new(all, power) }
    }

    fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    fn arithmetic(self, operator: char, other: Ratio) -> Ratio {
        let (a, b) = (self.numerator, self.denominator);
        let (c, d) = (other.numerator, other.denominator);
        let times = |x: i128, y: i128| x.checked_mul(y).expect("rationals are exact in i128");
        let sum = |x: i128, y: i128| x.checked_add(y).expect("rationals are exact in i128");
        match operator {
            '+' => Ratio::new(sum(times(a, d), times(c, b)), times(b, d)),
            '-' => Ratio::new(sum(times(a, d), -times(c, b)), times(b, d)),
            '*' => Ratio::new(times(a, c), times(b, d)),
            '/' => Ratio::new(times(a, d), times(b, c)),
            // The dividend's sign: a/b − (c/d)·trunc((a/b)/(c/d)).
            '%' => Ratio::new(times(a, d) % times(c, b), times(b, d)),
            _ => unreachable!(),
        }
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Two values of one type, after int has become float where the other is float.
enum Pair {
    Exact(Ratio, Ratio),
    Int(i32, i32),
    Float(f64, f64),
    Bool(bool, bool),
    Vector(Vec<f64>, Vec<f64>),
}

impl Value {
    /// What a rational is where nothing else decides: whole = int, else float.
    pub fn settle(self) -> Value {
        match self {
            Value::Exact(r) if r.denominator == 1 => {
                Value::Int(r.numerator.try_into().expect("an int literal beyond i32 is an error"))
            }
            Value::Exact(r) => Value::Float(r.to_f64()),
            Value::List(items) => Value::List(items.into_iter().map(Value::settle).collect()),
            other => other,
        }
    }

    /// As a value of the declared type: int becomes float, never the other way.
    pub fn coerce(self, ty: &str) -> Value {
        match (ty, self.settle()) {
            ("float", Value::Int(i)) => Value::Float(i as f64),
            ("int", v @ Value::Int(_)) | ("float", v @ Value::Float(_)) | ("bool", v @ Value::Bool(_)) => v,
            ("vec2" | "vec3" | "vec4", v @ Value::Vector(_)) => v,
            (_, v) => panic!("{v:?} is no {ty}"),
        }
    }

    pub fn bool(self) -> bool {
        match self {
            Value::Bool(b) => b,
            other => panic!("{other:?} is no bool"),
        }
    }

    pub fn int(self) -> i32 {
        match self.settle() {
            Value::Int(i) => i,
            other => panic!("{other:?} is no int"),
        }
    }

    pub fn float(self) -> f64 {
        match self.settle() {
            Value::Int(i) => i as f64,
            Value::Float(x) => x,
            other => panic!("{other:?} is no number"),
        }
    }

    pub fn vector(self) -> Vec<f64> {
        match self {
            Value::Vector(v) => v,
            other => panic!("{other:?} is no vector"),
        }
    }

    pub fn negate(self) -> Value {
        match self {
            Value::Exact(r) => Value::Exact(Ratio::new(-r.numerator, r.denominator)),
            Value::Int(i) => Value::Int(i.wrapping_neg()),
            Value::Float(x) => Value::Float(-x),
            Value::Vector(v) => Value::Vector(v.into_iter().map(|x| -x).collect()),
            other => panic!("−{other:?}"),
        }
    }

    /// `+ - * / %`.
    pub fn arithmetic(self, operator: char, other: Value) -> Value {
        let scaled = |v: Vec<f64>, s: f64| v.into_iter().map(|x| float_op(operator, x, s)).collect();
        match (self, other) {
            (Value::Vector(v), s) if !matches!(s, Value::Vector(_)) => Value::Vector(scaled(v, s.float())),
            (s, Value::Vector(v)) if !matches!(s, Value::Vector(_)) => {
                let s = s.float();
                Value::Vector(v.into_iter().map(|x| float_op(operator, s, x)).collect())
            }
            (a, b) => match pair(a, b) {
                Pair::Exact(a, b) => Value::Exact(a.arithmetic(operator, b)),
                Pair::Int(a, b) => Value::Int(int_op(operator, a, b)),
                Pair::Float(a, b) => Value::Float(float_op(operator, a, b)),
                Pair::Vector(a, b) => {
                    Value::Vector(a.into_iter().zip(b).map(|(a, b)| float_op(operator, a, b)).collect())
                }
                Pair::Bool(..) => panic!("bools have no `{operator}`"),
            },
        }
    }

    /// `==`.
    pub fn equals(self, other: Value) -> bool {
        match pair(self, other) {
            Pair::Exact(a, b) => a == b,
            Pair::Int(a, b) => a == b,
            Pair::Float(a, b) => a == b,
            Pair::Bool(a, b) => a == b,
            Pair::Vector(..) => panic!("== on vectors is an error"),
        }
    }

    /// `None` where a NaN stands on either side.
    pub fn order(self, other: Value) -> Option<Ordering> {
        match pair(self, other) {
            Pair::Exact(a, b) => {
                let difference = a.arithmetic('-', b);
                Some(difference.numerator.cmp(&0))
            }
            Pair::Int(a, b) => Some(a.cmp(&b)),
            Pair::Float(a, b) => a.partial_cmp(&b),
            Pair::Bool(..) | Pair::Vector(..) => panic!("only numbers have an order"),
        }
    }

    /// Both as values of one type: what `if(c, a, b)`, `min` and `max` return.
    pub fn unify(self, other: Value) -> (Value, Value) {
        match pair(self.settle(), other.settle()) {
            Pair::Exact(..) => unreachable!("settled"),
            Pair::Int(a, b) => (Value::Int(a), Value::Int(b)),
            Pair::Float(a, b) => (Value::Float(a), Value::Float(b)),
            Pair::Bool(a, b) => (Value::Bool(a), Value::Bool(b)),
            Pair::Vector(a, b) => (Value::Vector(a), Value::Vector(b)),
        }
    }
}

fn pair(a: Value, b: Value) -> Pair {
    match (a, b) {
        (Value::Exact(a), Value::Exact(b)) => Pair::Exact(a, b),
        (a, b) => match (a.settle(), b.settle()) {
            (Value::Int(a), Value::Int(b)) => Pair::Int(a, b),
            (Value::Bool(a), Value::Bool(b)) => Pair::Bool(a, b),
            (Value::Vector(a), Value::Vector(b)) if a.len() == b.len() => Pair::Vector(a, b),
            (a, b) => Pair::Float(a.float(), b.float()),
        },
    }
}

/// i32 wraps, `x / 0 = x`, `x % 0 = 0`, `%` has the dividend's sign.
fn int_op(operator: char, a: i32, b: i32) -> i32 {
    match operator {
        '+' => a.wrapping_add(b),
        '-' => a.wrapping_sub(b),
        '*' => a.wrapping_mul(b),
        '/' if b == 0 => a,
        '/' => a.wrapping_div(b),
        '%' if b == 0 => 0,
        '%' => a.wrapping_rem(b),
        _ => unreachable!(),
    }
}

fn float_op(operator: char, a: f64, b: f64) -> f64 {
    match operator {
        '+' => a + b,
        '-' => a - b,
        '*' => a * b,
        '/' => a / b,
        '%' => a % b,
        _ => unreachable!(),
    }
}
