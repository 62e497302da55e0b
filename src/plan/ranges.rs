//! Sets of numbers: the values with which a condition holds.
//!
//! Ints, bools and floats all stand as integers in their order: of floats the n-th above 0 as n, so that both zeros
//! are one. What is no number stands apart from all of them.

use crate::language::expr::Value;

const LOW: i64 = -1 << 40;
const HIGH: i64 = 1 << 40;
const NO_NUMBER: i64 = 1 << 41;

/// Intervals, ends included, in order and apart from each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Set(Vec<(i64, i64)>);

impl Set {
    pub fn none() -> Set {
        Set(Vec::new())
    }

    pub fn all() -> Set {
        Set(vec![(LOW, HIGH), (NO_NUMBER, NO_NUMBER)])
    }

    pub fn no_number() -> Set {
        Set::one(NO_NUMBER)
    }

    pub fn one(value: i64) -> Set {
        Set::between(value, value)
    }

    pub fn between(low: i64, high: i64) -> Set {
        Set(if low <= high { vec![(low, high)] } else { Vec::new() })
    }

    pub fn and(&self, other: &Set) -> Set {
        let meet = |a: &(i64, i64), b: &(i64, i64)| (a.0.max(b.0), a.1.min(b.1));
        let pairs = self.0.iter().flat_map(|a| other.0.iter().map(move |b| meet(a, b)));
        Set(pairs.filter(|(low, high)| low <= high).collect())
    }

    pub fn or(&self, other: &Set) -> Set {
        self.not().and(&other.not()).not()
    }

    pub fn not(&self) -> Set {
        let mut rest = Set::all();
        for &(low, high) in &self.0 {
            rest = rest.and(&Set(vec![(LOW, low - 1), (high + 1, NO_NUMBER)]));
        }
        rest
    }

    pub fn covers(&self, other: &Set) -> bool {
        self.not().and(other).0.is_empty()
    }
}

/// A comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Less,
    Most,
    More,
    Least,
    Equal,
    Other,
}

impl Relation {
    pub fn of(name: &str) -> Option<Relation> {
        Some(match name {
            "<" => Relation::Less,
            "<=" => Relation::Most,
            ">" => Relation::More,
            ">=" => Relation::Least,
            "==" => Relation::Equal,
            "!=" => Relation::Other,
            _ => return None,
        })
    }

    /// With its sides exchanged.
    pub fn turned(self) -> Relation {
        match self {
            Relation::Less => Relation::More,
            Relation::Most => Relation::Least,
            Relation::More => Relation::Less,
            Relation::Least => Relation::Most,
            Relation::Equal | Relation::Other => self,
        }
    }

    /// All values that stand so to this bool, int or float.
    pub fn to(self, value: &Value) -> Set {
        let at = match *value {
            Value::Bool(b) => i64::from(b),
            Value::Int(i) => i64::from(i),
            Value::Float(x) if !x.is_nan() => {
                let size = i64::from(x.abs().to_bits());
                if x < 0.0 { -size } else { size }
            }
            // Nothing is equal to what is no number, or less or more than it.
            _ => return if self == Relation::Other { Set::all() } else { Set::none() },
        };
        match self {
            Relation::Less => Set::between(LOW, at - 1),
            Relation::Most => Set::between(LOW, at),
            Relation::More => Set::between(at + 1, HIGH),
            Relation::Least => Set::between(at, HIGH),
            Relation::Equal => Set::one(at),
            Relation::Other => Set::one(at).not(),
        }
    }
}
