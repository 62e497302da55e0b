//! Coefficients: exact where they are written so, else in double precision.

use crate::language::rational::Rational;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A coefficient.
#[derive(Clone, Copy, Debug)]
pub enum Number {
    Exact(Rational),
    Float(f64),
}

impl Number {
    pub const ZERO: Number = Number::Exact(Rational::ZERO);
    pub const ONE: Number = Number::Exact(Rational::ONE);

    pub fn to_f64(self) -> f64 {
        match self {
            Number::Exact(x) => x.to_f64(),
            Number::Float(x) => x,
        }
    }

    /// The fraction, where it is known.
    pub fn exact(self) -> Option<Rational> {
        match self {
            Number::Exact(x) => Some(x),
            Number::Float(_) => None,
        }
    }

    pub fn is_zero(self) -> bool {
        match self {
            Number::Exact(x) => x.is_zero(),
            Number::Float(x) => x == 0.0,
        }
    }

    pub fn whole(n: i64) -> Number {
        Rational::new(n.into(), 1).map_or(Number::Float(n as f64), Number::Exact)
    }

    /// `self` to a power of at least 0.
    pub fn power(self, exponent: u32) -> Number {
        (0..exponent).fold(Number::ONE, |product, _| product * self)
    }

    /// Equal; within rounding where one of them is not exact.
    pub fn is(self, other: Number) -> bool {
        match (self, other) {
            (Number::Exact(a), Number::Exact(b)) => a == b,
            (a, b) => {
                let (a, b) = (a.to_f64(), b.to_f64());
                // Coefficients that come from the rules are f32.
                (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(1.0)
            }
        }
    }

    fn both(
        self,
        other: Number,
        exact: fn(Rational, Rational) -> Option<Rational>,
        float: fn(f64, f64) -> f64,
    ) -> Number {
        let fraction = match (self, other) {
            (Number::Exact(a), Number::Exact(b)) => exact(a, b),
            _ => None,
        };
        fraction.map_or_else(|| Number::Float(float(self.to_f64(), other.to_f64())), Number::Exact)
    }
}

impl Add for Number {
    type Output = Number;
    fn add(self, other: Number) -> Number {
        self.both(other, Rational::checked_add, |a, b| a + b)
    }
}

impl Sub for Number {
    type Output = Number;
    fn sub(self, other: Number) -> Number {
        self.both(other, Rational::checked_sub, |a, b| a - b)
    }
}

impl Mul for Number {
    type Output = Number;
    fn mul(self, other: Number) -> Number {
        self.both(other, Rational::checked_mul, |a, b| a * b)
    }
}

impl Div for Number {
    type Output = Number;
    fn div(self, other: Number) -> Number {
        self.both(other, Rational::checked_div, |a, b| a / b)
    }
}

impl Neg for Number {
    type Output = Number;
    fn neg(self) -> Number {
        Number::ZERO - self
    }
}

/// A fraction where it is a short one, else seven digits.
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let text = self.exact().map(|x| x.to_string()).filter(|text| text.len() <= 12);
        f.pad(&text.unwrap_or_else(|| decimal(self.to_f64())))
    }
}

/// Seven significant digits, without zeros at the end.
pub fn decimal(x: f64) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) {
        return format!("{x:.6e}");
    }
    let digits = 6 - x.abs().max(1e-4).log10().floor() as i32;
    let text = format!("{x:.*}", digits.clamp(0, 12) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}
