//! Exact rationals: what an expression of numerals is until a type is asked of it.

use std::cmp::Ordering;
use std::fmt;

/// A fraction in lowest terms over i128. Operations that leave that range give `None`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rational {
    numerator: i128,
    /// Positive.
    denominator: i128,
}

impl Rational {
    pub const ZERO: Rational = Rational { numerator: 0, denominator: 1 };
    pub const ONE: Rational = Rational { numerator: 1, denominator: 1 };

    /// `numerator / denominator`; `None` for a zero denominator.
    pub fn new(numerator: i128, denominator: i128) -> Option<Rational> {
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs());
        let divisor = i128::try_from(divisor).ok().filter(|d| *d != 0)?;
        let (n, d) = (numerator / divisor, denominator / divisor);
        match d.cmp(&0) {
            Ordering::Equal => None,
            Ordering::Greater => Some(Rational { numerator: n, denominator: d }),
            Ordering::Less => Some(Rational { numerator: n.checked_neg()?, denominator: d.checked_neg()? }),
        }
    }

    /// Reads a numeral: digits, a fraction, an exponent.
    pub fn parse(text: &str) -> Option<Rational> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let fraction = fraction.trim_end_matches('0');
        let mut value: i128 = 0;
        for digit in whole.chars().chain(fraction.chars()) {
            value = value.checked_mul(10)?.checked_add(digit.to_digit(10)? as i128)?;
        }
        if value == 0 {
            return Some(Rational::ZERO);
        }
        let shift = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        let power = 10i128.checked_pow(shift.unsigned_abs())?;
        if shift >= 0 { Rational::new(value.checked_mul(power)?, 1) } else { Rational::new(value, power) }
    }

    /// The float's exact value, where i128 holds it.
    pub fn from_f32(x: f32) -> Option<Rational> {
        if !x.is_finite() {
            return None;
        }
        let bits = x.to_bits();
        let exponent = ((bits >> 23) & 0xff) as i32;
        let fraction = (bits & 0x7f_ffff) as i128;
        let (mantissa, power) = match exponent {
            0 => (fraction, -149),
            _ => (fraction | 0x80_0000, exponent - 150),
        };
        let mantissa = if x < 0.0 { -mantissa } else { mantissa };
        if mantissa == 0 {
            return Some(Rational::ZERO);
        }
        let zeros = mantissa.trailing_zeros() as i32;
        let (mantissa, power) = (mantissa >> zeros, power + zeros);
        let scale = if power.abs() < 127 { 1i128 << power.abs() } else { return None };
        if power >= 0 {
            Rational::new(mantissa.checked_mul(scale)?, 1)
        } else {
            Rational::new(mantissa, scale)
        }
    }

    /// The simplest fraction that rounds to this float, where its denominator is at most 4,096: two such are farther
    /// apart than floats below 1 are, so it is the one that was written. Else the float's exact value.
    pub fn nearest_simple(x: f32) -> Option<Rational> {
        const MOST: i128 = 4096;
        let exact = Rational::from_f32(x)?;
        if exact.denominator <= MOST {
            return Some(exact);
        }
        // Convergents of the continued fraction, until one rounds to the float.
        let (mut rest, mut before, mut last) = (exact, (0i128, 1i128), (1i128, 0i128));
        loop {
            let whole = rest.numerator.div_euclid(rest.denominator);
            let next = (
                whole.checked_mul(last.0).and_then(|n| n.checked_add(before.0)),
                whole.checked_mul(last.1).and_then(|d| d.checked_add(before.1)),
            );
            let (Some(n), Some(d)) = next else { return Some(exact) };
            if d > MOST {
                return Some(exact);
            }
            let convergent = Rational::new(n, d)?;
            if convergent.to_f32() == Some(x) {
                return Some(convergent);
            }
            (before, last) = (last, (n, d));
            rest = Rational::ONE.checked_div(rest.checked_sub(Rational::new(whole, 1)?)?)?;
        }
    }

    /// Numerator and denominator, which is positive.
    pub fn parts(self) -> (i128, i128) {
        (self.numerator, self.denominator)
    }

    /// The value within two units in the last place of a double.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    pub fn is_zero(self) -> bool {
        self.numerator == 0
    }

    pub fn is_negative(self) -> bool {
        self.numerator < 0
    }

    /// Without a fraction: its type is int.
    pub fn is_whole(self) -> bool {
        self.denominator == 1
    }

    /// The value as an int, if it is whole and in range.
    pub fn to_i32(self) -> Option<i32> {
        if self.is_whole() { i32::try_from(self.numerator).ok() } else { None }
    }

    /// The nearest float, ties to even; `None` beyond the range of f32.
    pub fn to_f32(self) -> Option<f32> {
        // Long division in binary: `mantissa * 2^exponent`, and whether anything is left over.
        const BITS: u32 = 26;
        let (n, d) = (self.numerator.unsigned_abs(), self.denominator.unsigned_abs());
        if n == 0 {
            return Some(0.0);
        }
        let (mut mantissa, mut rest, mut exponent) = (n / d, n % d, 0i32);
        while mantissa < 1 << BITS && rest != 0 {
            rest <<= 1;
            mantissa = mantissa << 1 | (rest >= d) as u128;
            if rest >= d {
                rest -= d;
            }
            exponent -= 1;
        }
        // Keep 24 bits, fewer where the float is subnormal.
        let width = 128 - mantissa.leading_zeros() as i32;
        let last = (exponent + width - 24).max(-149);
        let drop = last - exponent;
        if drop > 0 {
            let (kept, dropped) =
                if drop < 128 { (mantissa >> drop, mantissa & ((1 << drop) - 1)) } else { (0, mantissa) };
            let half = if drop <= 128 { 1u128 << (drop - 1) } else { u128::MAX };
            let up = match dropped.cmp(&half) {
                Ordering::Greater => true,
                Ordering::Equal => rest != 0 || kept & 1 == 1,
                Ordering::Less => false,
            };
            mantissa = kept + up as u128;
            exponent = last;
        }
        // Both factors and the product are exact in f64, and the product is an f32 by construction.
        let magnitude = (mantissa as f64 * 2f64.powi(exponent)) as f32;
        let value = if self.numerator < 0 { -magnitude } else { magnitude };
        value.is_finite().then_some(value)
    }

    pub fn checked_neg(self) -> Option<Rational> {
        Some(Rational { numerator: self.numerator.checked_neg()?, ..self })
    }

    pub fn checked_add(self, other: Rational) -> Option<Rational> {
        // Over the common denominator, so that sums of like fractions stay in range.
        let common = gcd(self.denominator.unsigned_abs(), other.denominator.unsigned_abs()) as i128;
        let (a, b) = (other.denominator / common, self.denominator / common);
        let sum = self.numerator.checked_mul(a)?.checked_add(other.numerator.checked_mul(b)?)?;
        Rational::new(sum, self.denominator.checked_mul(a)?)
    }

    pub fn checked_sub(self, other: Rational) -> Option<Rational> {
        self.checked_add(other.checked_neg()?)
    }

    pub fn checked_mul(self, other: Rational) -> Option<Rational> {
        // Crosswise in lowest terms first, for the same reason.
        let a = Rational::new(self.numerator, other.denominator)?;
        let b = Rational::new(other.numerator, self.denominator)?;
        let numerator = a.numerator.checked_mul(b.numerator)?;
        Rational::new(numerator, a.denominator.checked_mul(b.denominator)?)
    }

    /// `None` for a zero divisor, too.
    pub fn checked_div(self, other: Rational) -> Option<Rational> {
        self.checked_mul(Rational::new(other.denominator, other.numerator)?)
    }

    /// The remainder with the sign of `self`; `None` for a zero divisor.
    pub fn checked_rem(self, other: Rational) -> Option<Rational> {
        let quotient = self.checked_div(other)?;
        let whole = Rational { numerator: quotient.numerator / quotient.denominator, denominator: 1 };
        self.checked_sub(other.checked_mul(whole)?)
    }

    /// How it compares; `None` if that leaves the range.
    pub fn checked_cmp(self, other: Rational) -> Option<Ordering> {
        Some(self.checked_sub(other)?.numerator.cmp(&0))
    }
}

impl fmt::Display for Rational {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.denominator {
            1 => write!(f, "{}", self.numerator),
            d => write!(f, "{}/{d}", self.numerator),
        }
    }
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
