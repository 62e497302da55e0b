//! Children that are sums of weighted points around, as those of affine rules are: without registers in memory.
//!
//! Chaikin's rule takes 4 loads, 6 operations and 2 stores of four lanes a module, and no more; [`super::lanes`], which
//! does what is no such sum, writes every result to the nearest cache and reads it again. Products are added in the
//! order in which the rule adds them, so the bits are the same.

use super::lanes::{LANES, Op, window};
use super::program::Input;
use glam::{BVec4A, Vec4};

/// A point so many places to the right, times the constant in a register, or its negative.
#[derive(Clone, Copy)]
struct Term {
    place: i32,
    weight: Option<usize>,
    negative: bool,
}

impl Term {
    fn negated(self) -> Term {
        Term { negative: !self.negative, ..self }
    }
}

/// Points of one child, in the order in which they are added.
pub struct Sum(Vec<Term>);

/// The most points that go into one child here.
const MOST: usize = 8;

impl Sum {
    /// What a register holds, if it is a sum.
    pub fn of(ops: &[Op], register: usize) -> Option<Sum> {
        let mut terms = Vec::new();
        add(ops, register, &mut terms)?;
        (terms.len() <= MOST).then_some(Sum(terms))
    }

    /// Writes one child of each module of a block.
    pub fn run(&self, part: &Input, start: usize, constants: &[f32], child: Child, out: &mut [[u32; LANES]]) {
        let count = out.len() / child.growth;
        let term = |k: usize| {
            let Term { place, weight, negative } = self.0[k];
            let weight = weight.map_or(1.0, |register| constants[register]);
            let points = bytemuck::cast_slice(window(part, start, place, count));
            (Vec4::splat(if negative { -weight } else { weight }), points)
        };
        let out = bytemuck::cast_slice_mut(out);
        match self.0.len() {
            1 => write([0].map(term), child, out),
            2 => write([0, 1].map(term), child, out),
            3 => write([0, 1, 2].map(term), child, out),
            4 => write([0, 1, 2, 3].map(term), child, out),
            5 => write([0, 1, 2, 3, 4].map(term), child, out),
            6 => write([0, 1, 2, 3, 4, 5].map(term), child, out),
            7 => write([0, 1, 2, 3, 4, 5, 6].map(term), child, out),
            _ => write([0, 1, 2, 3, 4, 5, 6, 7].map(term), child, out),
        }
    }
}

/// One of the children of each module.
#[derive(Clone, Copy)]
pub struct Child {
    pub number: usize,
    pub growth: usize,
    /// A record with nothing but its symbol.
    pub symbol: Vec4,
    /// The lanes that hold coordinates.
    pub lanes: BVec4A,
}

#[inline(always)]
fn write<const TERMS: usize>(
    terms: [(Vec4, &[[f32; LANES]]); TERMS],
    child: Child,
    out: &mut [[f32; LANES]],
) {
    let Child { number, growth, symbol, lanes } = child;
    // A lane without a coordinate may hold a symbol, a number so small that arithmetic takes long over it.
    let point = |point: [f32; LANES]| Vec4::select(lanes, Vec4::from_array(point), Vec4::ZERO);
    let count = out.len() / growth;
    let (weights, points) = (terms.map(|term| term.0), terms.map(|term| &term.1[..count]));
    for (n, children) in out.chunks_exact_mut(growth).enumerate() {
        let mut sum = point(points[0][n]) * weights[0];
        for k in 1..TERMS {
            sum += point(points[k][n]) * weights[k];
        }
        children[number] = Vec4::select(lanes, sum, symbol).to_array();
    }
}

/// Adds what a register holds, if it is a sum: one side of every sum is a single term, since a + (b + c) is not
/// (a + b) + c.
fn add(ops: &[Op], register: usize, terms: &mut Vec<Term>) -> Option<()> {
    if let Some(term) = product(ops, register) {
        terms.push(term);
        return Some(());
    }
    match ops[register] {
        Op::Call { name: "+", args: 2, registers: [a, b, _], .. } => {
            let (rest, last) = match (product(ops, b), product(ops, a)) {
                (Some(last), _) => (a, last),
                (None, Some(last)) => (b, last),
                (None, None) => return None,
            };
            add(ops, rest, terms)?;
            terms.push(last);
        }
        Op::Call { name: "-", args: 2, registers: [a, b, _], .. } => {
            let last = product(ops, b)?;
            add(ops, a, terms)?;
            terms.push(last.negated());
        }
        _ => return None,
    }
    Some(())
}

fn product(ops: &[Op], register: usize) -> Option<Term> {
    match ops[register] {
        Op::Load(place) => Some(Term { place, weight: None, negative: false }),
        Op::Call { name: "-", args: 1, registers: [a, ..], .. } => Some(product(ops, a)?.negated()),
        Op::Call { name: "*", registers: [a, b, _], .. } => match (&ops[a], &ops[b]) {
            (&Op::Load(place), _) if is_constant(ops, b) => {
                Some(Term { place, weight: Some(b), negative: false })
            }
            (_, &Op::Load(place)) if is_constant(ops, a) => {
                Some(Term { place, weight: Some(a), negative: false })
            }
            _ => None,
        },
        _ => None,
    }
}

/// Whether a register is the same for all modules.
fn is_constant(ops: &[Op], register: usize) -> bool {
    match &ops[register] {
        Op::Load(_) => false,
        Op::Uniform(_) | Op::Constant(_) => true,
        Op::Call { args, registers, .. } => registers[..*args].iter().all(|&r| is_constant(ops, r)),
    }
}

/// What the registers hold that are the same for all modules; 0 in others.
pub fn constants(ops: &[Op], environment: &[u32]) -> Vec<f32> {
    let mut words: Vec<u32> = Vec::with_capacity(ops.len());
    for op in ops {
        words.push(match op {
            Op::Load(_) => 0,
            Op::Uniform(at) => environment[*at],
            Op::Constant(word) => *word,
            Op::Call { cpu, args, registers, .. } => {
                let read: Vec<u32> = registers[..*args].iter().map(|&r| words[r]).collect();
                cpu.word(&read).unwrap_or(0)
            }
        });
    }
    words.into_iter().map(f32::from_bits).collect()
}
