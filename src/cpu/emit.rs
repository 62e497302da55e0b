//! The children: symbols, parameters, addresses, and nets by midpoints.
//!
//! A 2×2 split of a net of (m + 1)(n + 1) points of 16 bytes reads it and a record of 32 bytes once
//! and writes four times that, and does (n + 1)·m(m + 1)/2 + 2(m + 1)·n(n + 1)/2 midpoints of 4
//! components: 0.5 flop a byte for bicubic nets, which memory bandwidth bounds, 1.2 for degree 8. Sweeps go
//! over rows first (u, from the left), then over columns (v), always (a + b)·0.5: the same bits as
//! the kernels. A sweep is compiled for each degree, so that a line stays in registers.

use super::BLOCK;
use super::program::{self, Input, Registers};
use crate::patch::MAX_DEGREE;
use crate::plan::code::ChildCode;
use crate::plan::layout::Header;
use crate::plan::tables::{Production, Stage};
use glam::Vec4;
use rayon::prelude::*;

/// Where the children go: exactly the modules that the scan counted.
pub struct Output<'a> {
    pub records: &'a mut [u32],
    pub nets: &'a mut [[f32; 4]],
}

/// Writes the children of all modules; false if one's address did not fit.
///
/// Where the growth is closed `rules` and `offsets` are not read.
pub fn emit(
    stage: &Stage,
    words_of_rules: &[u32],
    input: &Input,
    nets: &[[f32; 4]],
    rules: &[u32],
    offsets: &[u32],
    out: Output,
) -> bool {
    let n = input.len();
    let offset = |i: usize| match stage.closed {
        Some(growth) => i * growth as usize,
        None => offsets[i] as usize,
    };
    let (words, points) = (input.layout.record_words, input.layout.net_points());
    // The blocks' ranges of the output are known, so each task gets its own slices.
    let mut blocks = Vec::with_capacity(n.div_ceil(BLOCK));
    let (mut records, mut out_nets) = (out.records, out.nets);
    for block in 0..n.div_ceil(BLOCK) {
        let (start, end) = (block * BLOCK, n.min((block + 1) * BLOCK));
        let count = offset(end) - offset(start);
        let (r, rest) = records.split_at_mut(count * words);
        records = rest;
        let (p, rest) = out_nets.split_at_mut(count * points);
        out_nets = rest;
        blocks.push((block, Output { records: r, nets: p }));
    }
    blocks
        .into_par_iter()
        .map_init(
            || {
                let registers: Vec<_> = stage.productions.iter().map(|_| Registers::default()).collect();
                (registers, Splitter::new(input.layout.degree))
            },
            |(registers, splitter), (block, out)| {
                let start = block * BLOCK;
                let block = input.block(block);
                let nets = &nets[start * points..][..block.len() * points];
                let rules = match stage.closed {
                    Some(_) => None,
                    None => Some(&rules[start..][..block.len()]),
                };
                emit_block(stage, words_of_rules, &block, nets, rules, (registers, splitter), out)
            },
        )
        .reduce(|| true, |a, b| a & b)
}

fn emit_block(
    stage: &Stage,
    words_of_rules: &[u32],
    block: &Input,
    nets: &[[f32; 4]],
    rules: Option<&[u32]>,
    (registers, splitter): (&mut [Registers], &mut Splitter),
    out: Output,
) -> bool {
    let (words, points) = (block.layout.record_words, block.layout.net_points());
    let rule_of = |i: usize| match rules {
        Some(rules) => rules[i] as usize,
        None => stage.rules[stage.by_symbol[(block.record(i)[0] & 0xffff) as usize][0]].productions.start,
    };
    let mut ready = vec![false; stage.productions.len()];
    let mut at = 0;
    let mut fits = true;
    for i in 0..block.len() {
        let rule = rule_of(i);
        let word = words_of_rules[rule];
        let (halves, live) = (word & 3, word >> 4 & 15);
        let count = (word >> 8 & 7) as usize;
        let record = block.record(i);
        let children = &mut out.records[at * words..][..count * words];
        if let Some(production) = stage.productions.get(rule) {
            let code = &stage.code.children[rule];
            if !ready[rule] {
                program::run(&code.graph, block, &mut registers[rule]);
                ready[rule] = true;
            }
            fits &= write_records(production, code, &registers[rule], record, i, children);
        } else if count == 1 {
            children.copy_from_slice(record);
        }
        let net = &nets[i * points..][..points];
        splitter.split(net, halves, live, &mut out.nets[at * points..][..count * points]);
        at += count;
    }
    fits
}

/// The records of the live cells, in order; false if an address did not fit.
fn write_records(
    production: &Production,
    code: &ChildCode,
    registers: &Registers,
    record: &[u32],
    i: usize,
    out: &mut [u32],
) -> bool {
    let header = Header::read(record);
    let cells = (0..4).filter_map(|c| Some((c, production.cells[c].as_ref()?)));
    let mut fits = true;
    for ((cell, successor), child) in cells.zip(out.chunks_exact_mut(record.len())) {
        child.fill(0);
        let next = header.child(production.halves, cell as u32 >> 1, cell as u32 & 1);
        fits &= next.is_some();
        Header { symbol: successor.symbol as u16, ..next.unwrap_or(header) }.write(child);
        for &(register, at) in &code.args[cell] {
            child[at] = registers.column(register)[i];
        }
    }
    fits
}

#[inline(always)]
fn midpoint(a: Vec4, b: Vec4) -> Vec4 {
    (a + b) * 0.5
}

/// Both halves of a Bézier curve of N points. The triangle of midpoints stands in one array: after
/// each level its first point is the next one of the first half, and at last it is the second half.
#[inline(always)]
fn halve<const N: usize>(mut p: [Vec4; N]) -> [[Vec4; N]; 2] {
    let mut first = p;
    // Written out: of loops in loops the compiler keeps arrays in memory.
    macro_rules! level {
        ($level:literal: $($k:literal)*) => {
            if $level < N {
                $(if $k + $level < N {
                    p[$k] = midpoint(p[$k], p[$k + 1]);
                })*
                first[$level] = p[0];
            }
        };
    }
    level!(1: 0 1 2 3 4 5 6 7);
    level!(2: 0 1 2 3 4 5 6);
    level!(3: 0 1 2 3 4 5);
    level!(4: 0 1 2 3 4);
    level!(5: 0 1 2 3);
    level!(6: 0 1 2);
    level!(7: 0 1);
    level!(8: 0);
    [first, p]
}

/// How the points of a net lie: those of a line are `along` apart, the lines `across`.
#[derive(Clone, Copy)]
struct Lines {
    count: usize,
    along: usize,
    across: usize,
}

/// Halves every line of a net.
type Sweep = fn(&[[f32; 4]], Lines, &mut [[f32; 4]], &mut [[f32; 4]]);

fn sweep<const N: usize>(net: &[[f32; 4]], lines: Lines, first: &mut [[f32; 4]], second: &mut [[f32; 4]]) {
    let Lines { count, along, across } = lines;
    for line in 0..count {
        let start = line * across;
        let [a, b] = halve::<N>(std::array::from_fn(|k| Vec4::from_array(net[start + k * along])));
        (0..N).for_each(|k| first[start + k * along] = a[k].to_array());
        (0..N).for_each(|k| second[start + k * along] = b[k].to_array());
    }
}

/// By degree, from 1.
const SWEEPS: [Sweep; MAX_DEGREE as usize] =
    [sweep::<2>, sweep::<3>, sweep::<4>, sweep::<5>, sweep::<6>, sweep::<7>, sweep::<8>, sweep::<9>];

/// All four quarters of a small net, which stays in registers.
type Quarters = fn(&[[f32; 4]], &mut [[f32; 4]]);

fn quarters<const R: usize, const C: usize>(net: &[[f32; 4]], out: &mut [[f32; 4]]) {
    let columns: [[[Vec4; R]; 2]; C] =
        std::array::from_fn(|c| halve(std::array::from_fn(|r| Vec4::from_array(net[r * C + c]))));
    let (upper, lower) = out.split_at_mut(2 * R * C);
    for (half, out) in [upper, lower].into_iter().enumerate() {
        let (left, right) = out.split_at_mut(R * C);
        let (left, right) = (left.as_chunks_mut::<C>().0, right.as_chunks_mut::<C>().0);
        for (r, (left, right)) in left.iter_mut().zip(right).enumerate() {
            let [a, b] = halve::<C>(std::array::from_fn(|c| columns[c][half][r]));
            (*left, *right) = (a.map(|p| p.to_array()), b.map(|p| p.to_array()));
        }
    }
}

/// By degrees from 1, up to bicubic.
const QUARTERS: [[Quarters; 3]; 3] = [
    [quarters::<2, 2>, quarters::<2, 3>, quarters::<2, 4>],
    [quarters::<3, 2>, quarters::<3, 3>, quarters::<3, 4>],
    [quarters::<4, 2>, quarters::<4, 3>, quarters::<4, 4>],
];

/// Splits nets of one degree.
struct Splitter {
    quarters: Option<Quarters>,
    sweeps: [Sweep; 2],
    /// The columns of a net, then its rows.
    lines: [Lines; 2],
    /// Both halves along u, where v is halved too, and where cells go that do not live: small enough
    /// to stay in the first cache.
    scratch: [Vec<[f32; 4]>; 4],
}

impl Splitter {
    fn new([m, n]: [u8; 2]) -> Splitter {
        let (rows, columns) = (m as usize + 1, n as usize + 1);
        let down = Lines { count: columns, along: columns, across: 1 };
        let right = Lines { count: rows, along: 1, across: columns };
        let small = QUARTERS.get(m as usize - 1).and_then(|row| row.get(n as usize - 1));
        Splitter {
            quarters: small.copied(),
            sweeps: [SWEEPS[m as usize - 1], SWEEPS[n as usize - 1]],
            lines: [down, right],
            scratch: [0; 4].map(|_| vec![[0.0; 4]; rows * columns]),
        }
    }

    /// Writes the live children of a net one after the other (K eq. 3 with reading E1: upper left
    /// L P Lᵀ, upper right L P Rᵀ, lower left R P Lᵀ, lower right R P Rᵀ).
    fn split(&mut self, net: &[[f32; 4]], halves: u32, live: u32, out: &mut [[f32; 4]]) {
        let ([along_u, along_v], [columns, rows]) = (self.sweeps, self.lines);
        let [upper, lower, nowhere, nowhere_too] = &mut self.scratch;
        if let (3, 15, Some(quarters)) = (halves, live, self.quarters) {
            return quarters(net, out);
        }
        let mut out = out.chunks_exact_mut(net.len());
        let mut cell = |c: u32| if live >> c & 1 != 0 { out.next() } else { None };
        match halves {
            0 => {
                if let Some(out) = cell(0) {
                    out.copy_from_slice(net);
                }
            }
            1 => along_u(net, columns, cell(0).unwrap_or(nowhere), cell(2).unwrap_or(nowhere_too)),
            2 => along_v(net, rows, cell(0).unwrap_or(nowhere), cell(1).unwrap_or(nowhere_too)),
            _ => {
                along_u(net, columns, upper, lower);
                for (half, [left, right]) in [(upper, [0, 1]), (lower, [2, 3])] {
                    if live >> left & 3 != 0 {
                        let (left, right) = (cell(left), cell(right));
                        along_v(half, rows, left.unwrap_or(nowhere), right.unwrap_or(nowhere_too));
                    }
                }
            }
        }
    }
}
