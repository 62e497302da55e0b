//! The children: symbols, parameters, addresses, and nets by midpoints.
//!
//! A 2×2 split of a net of (m + 1)(n + 1) points of 16 bytes reads it and a record of 32 bytes once
//! and writes four times that, and does (n + 1)·m(m + 1)/2 + 2(m + 1)·n(n + 1)/2 midpoints of 4
//! components: 0.5 flop a byte for bicubic nets, which memory bandwidth bounds, 1.2 for degree 8, less the
//! halvings that `halve` puts off. Sweeps go over rows first (u, from the left), then over columns (v): the
//! same bits as the kernels. A sweep is compiled for each degree, so that a line stays in registers.

use super::BLOCK;
use super::match_modules::fired;
use super::program::{self, Input, Registers};
use crate::patch::{MAX_DEGREE, net_points};
use crate::plan::code::ChildCode;
use crate::plan::layout::Header;
use crate::plan::tables::{Production, Stage};
use glam::Vec4;
use rayon::ThreadPool;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Where the children go: exactly the modules that the scan counted.
pub struct Output<'a> {
    pub records: &'a mut [u32],
    pub nets: &'a mut [[f32; 4]],
}

/// Writes the children of all modules; false if one's address did not fit.
///
/// Where the growth is closed `rules` and `offsets` are not read.
pub fn emit(
    threads: &ThreadPool,
    stage: &Stage,
    input: &Input,
    nets: &[[f32; 4]],
    rules: &[u32],
    offsets: &[u32],
    out: Output,
) -> bool {
    let n = input.len();
    let words_of_rules = stage.rule_words();
    let offset = |i: usize| match stage.closed {
        Some(growth) => i * growth as usize,
        None => offsets[i] as usize,
    };
    let (words, points) = (input.layout.record_words, input.layout.net_points());
    // Of large nets a task takes fewer, so that there are enough tasks to share out.
    let part = (BLOCK * 16 / points).clamp(1, BLOCK);
    // The tasks' ranges of the output are known, so each gets its own slices.
    let mut parts = Vec::with_capacity(n.div_ceil(part));
    let (mut records, mut out_nets) = (out.records, out.nets);
    for start in (0..n).step_by(part) {
        let modules = start..n.min(start + part);
        let count = offset(modules.end) - offset(start);
        let (r, rest) = records.split_at_mut(count * words);
        records = rest;
        let (p, rest) = out_nets.split_at_mut(count * points);
        out_nets = rest;
        parts.push((modules, Output { records: r, nets: p }));
    }
    let workers = threads.current_num_threads().min(parts.len());
    let parts = Mutex::new(parts.into_iter());
    let fits = AtomicBool::new(true);
    let work = || {
        let mut registers: Vec<_> = stage.productions.iter().map(|_| Registers::default()).collect();
        let mut splitter = Splitter::new(input.layout.net.unwrap_or([1; 2]));
        loop {
            let next = parts.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((modules, out)) = next else { return };
            let nets = &nets[modules.start * points..modules.end * points];
            let rules = match stage.closed {
                Some(_) => None,
                None => Some(&rules[modules.clone()]),
            };
            let part = input.part(modules);
            if !emit_part(stage, &words_of_rules, &part, nets, rules, (&mut registers, &mut splitter), out) {
                fits.store(false, Ordering::Relaxed);
            }
        }
    };
    // The calling thread is one of the workers. If it only waited, a system might put two others on one core
    // when they wake (Linux does on two cores), and leaves them there step after step.
    threads.in_place_scope(|scope| {
        (1..workers).for_each(|_| scope.spawn(|_| work()));
        work();
    });
    fits.into_inner()
}

fn emit_part(
    stage: &Stage,
    words_of_rules: &[u32],
    part: &Input,
    nets: &[[f32; 4]],
    rules: Option<&[u32]>,
    (registers, splitter): (&mut [Registers], &mut Splitter),
    out: Output,
) -> bool {
    let (words, points) = (part.layout.record_words, part.layout.net_points());
    let mut ready = vec![false; stage.productions.len()];
    let mut at = 0;
    let mut fits = true;
    for i in 0..part.len() {
        let rule = fired(stage, part, rules, i);
        let word = words_of_rules[rule];
        let (halves, live) = (word & 3, word >> 4 & 15);
        let count = (word >> 8 & 255) as usize;
        let record = part.record(i);
        let children = &mut out.records[at * words..][..count * words];
        if let Some(production) = stage.productions.get(rule) {
            let code = &stage.code.children[rule];
            if !ready[rule] {
                program::run(&code.graph, part, &mut registers[rule]);
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
    let cells = production.successors();
    let mut fits = true;
    for ((cell, successor), child) in cells.zip(out.chunks_exact_mut(record.len())) {
        child.fill(0);
        let next = header.child(production.halves(), cell as u32 >> 1, cell as u32 & 1);
        fits &= next.is_some();
        Header { symbol: successor.symbol as u16, ..next.unwrap_or(header) }.write(child);
        for &(register, at) in &code.args[cell] {
            child[at] = registers.column(register)[i];
        }
    }
    fits
}

/// 2⁻ⁿ.
const HALVINGS: [f32; MAX_DEGREE as usize + 1] =
    [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03125, 0.015625, 0.0078125, 0.00390625];

/// Halves a Bézier curve of N points: hands out the points of the first half, one by one with their
/// numbers, and returns the second half. The triangle of midpoints stands in one array: after each
/// level its first point is the next one of the first half, and at last it is the second half.
///
/// The halvings are put off: sums are made of sums, and each point that comes out is scaled once. A power
/// of two scales exactly, so this changes no bit of what is not denormal; and
/// [`MAX_COORDINATE`](crate::patch::validate::MAX_COORDINATE) keeps the sums finite.
#[inline(always)]
fn halve<const N: usize>(mut p: [Vec4; N], mut first: impl FnMut(usize, Vec4)) -> [Vec4; N] {
    first(0, p[0]);
    // Written out: of loops in loops the compiler keeps arrays in memory.
    macro_rules! level {
        ($level:literal: $($k:literal)*) => {
            if $level < N {
                $(if $k + $level < N {
                    p[$k] += p[$k + 1];
                })*
                first($level, p[0] * HALVINGS[$level]);
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
    std::array::from_fn(|k| p[k] * HALVINGS[N - 1 - k])
}

/// Halves every row of a net, to its halves along v.
type AlongV = fn(&[[f32; 4]], &mut [[f32; 4]], &mut [[f32; 4]]);

fn along_v<const C: usize>(net: &[[f32; 4]], first: &mut [[f32; 4]], second: &mut [[f32; 4]]) {
    // Arrays of a known length leave no bound to be checked.
    let rows = net.as_chunks::<C>().0.iter();
    let halves = first.as_chunks_mut::<C>().0.iter_mut().zip(second.as_chunks_mut::<C>().0);
    for (row, (first, second)) in rows.zip(halves) {
        *second = halve(row.map(Vec4::from_array), |k, p| first[k] = p.to_array()).map(|p| p.to_array());
    }
}

/// Halves every column of a net of so many columns, to its halves along u.
type AlongU = fn(&[[f32; 4]], usize, &mut [[f32; 4]], &mut [[f32; 4]]);

fn along_u<const R: usize>(
    net: &[[f32; 4]],
    columns: usize,
    first: &mut [[f32; 4]],
    second: &mut [[f32; 4]],
) {
    let points = R * columns;
    let (net, first, second) = (&net[..points], &mut first[..points], &mut second[..points]);
    for c in 0..columns {
        let column = std::array::from_fn(|r| Vec4::from_array(net[r * columns + c]));
        let last = halve::<R>(column, |r, p| first[r * columns + c] = p.to_array());
        (0..R).for_each(|r| second[r * columns + c] = last[r].to_array());
    }
}

/// By degree, from 1.
const ALONG_U: [AlongU; MAX_DEGREE as usize] = [
    along_u::<2>,
    along_u::<3>,
    along_u::<4>,
    along_u::<5>,
    along_u::<6>,
    along_u::<7>,
    along_u::<8>,
    along_u::<9>,
];
const ALONG_V: [AlongV; MAX_DEGREE as usize] = [
    along_v::<2>,
    along_v::<3>,
    along_v::<4>,
    along_v::<5>,
    along_v::<6>,
    along_v::<7>,
    along_v::<8>,
    along_v::<9>,
];

/// All four quarters of a small net, which stays in registers.
type Quarters = fn(&[[f32; 4]], &mut [[f32; 4]]);

fn quarters<const R: usize, const C: usize>(net: &[[f32; 4]], out: &mut [[f32; 4]]) {
    let columns: [[[Vec4; R]; 2]; C] = std::array::from_fn(|c| {
        let mut first = [Vec4::ZERO; R];
        let column = std::array::from_fn(|r| Vec4::from_array(net[r * C + c]));
        let second = halve(column, |r, p| first[r] = p);
        [first, second]
    });
    let (upper, lower) = out.split_at_mut(2 * R * C);
    for (half, out) in [upper, lower].into_iter().enumerate() {
        let (left, right) = out.split_at_mut(R * C);
        let (left, right) = (left.as_chunks_mut::<C>().0, right.as_chunks_mut::<C>().0);
        for (r, (left, right)) in left.iter_mut().zip(right).enumerate() {
            let row: [Vec4; C] = std::array::from_fn(|c| columns[c][half][r]);
            *right = halve(row, |k, p| left[k] = p.to_array()).map(|p| p.to_array());
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
    along_u: AlongU,
    along_v: AlongV,
    columns: usize,
    /// Both halves along u, where v is halved too, and where cells go that do not live: small enough
    /// to stay in the first cache.
    scratch: [Vec<[f32; 4]>; 4],
}

impl Splitter {
    fn new(degree: [u8; 2]) -> Splitter {
        let [u, v] = degree.map(|d| d as usize - 1);
        Splitter {
            quarters: QUARTERS.get(u).and_then(|row| row.get(v)).copied(),
            along_u: ALONG_U[u],
            along_v: ALONG_V[v],
            columns: v + 2,
            scratch: [0; 4].map(|_| vec![[0.0; 4]; net_points(degree)]),
        }
    }

    /// Writes the live children of a net one after the other (K eq. 3 with reading E1: upper left
    /// L P Lᵀ, upper right L P Rᵀ, lower left R P Lᵀ, lower right R P Rᵀ).
    fn split(&mut self, net: &[[f32; 4]], halves: u32, live: u32, out: &mut [[f32; 4]]) {
        let (along_u, along_v, columns) = (self.along_u, self.along_v, self.columns);
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
            2 => along_v(net, cell(0).unwrap_or(nowhere), cell(1).unwrap_or(nowhere_too)),
            _ => {
                along_u(net, columns, upper, lower);
                for (half, [left, right]) in [(upper, [0, 1]), (lower, [2, 3])] {
                    if live >> left & 3 != 0 {
                        let (left, right) = (cell(left), cell(right));
                        along_v(half, left.unwrap_or(nowhere), right.unwrap_or(nowhere_too));
                    }
                }
            }
        }
    }
}
