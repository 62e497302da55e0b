//! The children: symbols, parameters, addresses, and nets by midpoints.
//!
//! A bicubic 2×2 split reads 256 + 32 bytes and writes 4·(256 + 32), and does 84 midpoints of
//! 4 components: 0.5 flop a byte, so memory bandwidth bounds it. Sweeps go over rows first (u,
//! from the left), then over columns (v), always (a + b)·0.5: the same bits as the kernel.

use super::BLOCK;
use super::program::{self, Input, Registers};
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
            || (0..stage.productions.len()).map(|_| Registers::default()).collect::<Vec<_>>(),
            |registers, (block, out)| {
                let start = block * BLOCK;
                let block = input.block(block);
                let nets = &nets[start * points..][..block.len() * points];
                let rules = match stage.closed {
                    Some(_) => None,
                    None => Some(&rules[start..][..block.len()]),
                };
                emit_block(stage, words_of_rules, &block, nets, rules, registers, out)
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
    registers: &mut [Registers],
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
        split_net(net, halves, live, &mut out.nets[at * points..][..count * points]);
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

type Row = [Vec4; 4];

#[inline(always)]
fn midpoint(a: Vec4, b: Vec4) -> Vec4 {
    (a + b) * 0.5
}

/// Both halves of a cubic Bézier curve.
#[inline(always)]
fn halve(p: Row) -> [Row; 2] {
    let (ab, bc, cd) = (midpoint(p[0], p[1]), midpoint(p[1], p[2]), midpoint(p[2], p[3]));
    let (abc, bcd) = (midpoint(ab, bc), midpoint(bc, cd));
    let middle = midpoint(abc, bcd);
    [[p[0], ab, abc, middle], [middle, bcd, cd, p[3]]]
}

/// Writes the live children of a bicubic net, row by row (K eq. 3 with reading E1: upper left
/// L P Lᵀ, upper right L P Rᵀ, lower left R P Lᵀ, lower right R P Rᵀ).
#[inline]
fn split_net(net: &[[f32; 4]], halves: u32, live: u32, out: &mut [[f32; 4]]) {
    if halves == 0 {
        if live != 0 {
            out.copy_from_slice(net);
        }
        return;
    }
    let p: [Row; 4] = std::array::from_fn(|r| std::array::from_fn(|c| Vec4::from_array(net[4 * r + c])));
    let mut out = out.chunks_exact_mut(16);
    if halves == 2 {
        write_rows(&p, 2, live & 3, &mut out);
        return;
    }
    let columns: [[Row; 2]; 4] = std::array::from_fn(|c| halve([p[0][c], p[1][c], p[2][c], p[3][c]]));
    let half =
        |hu: usize| -> [Row; 4] { std::array::from_fn(|r| std::array::from_fn(|c| columns[c][hu][r])) };
    write_rows(&half(0), halves & 2, live & 3, &mut out);
    write_rows(&half(1), halves & 2, live >> 2, &mut out);
}

/// Writes the live ones of the two halves along v, or the rows as they are where v is not halved.
#[inline(always)]
fn write_rows(rows: &[Row; 4], halve_v: u32, live: u32, out: &mut std::slice::ChunksExactMut<[f32; 4]>) {
    let store = |net: &mut [[f32; 4]], r: usize, row: Row| {
        for c in 0..4 {
            net[4 * r + c] = row[c].to_array();
        }
    };
    if halve_v == 0 {
        if live & 1 != 0
            && let Some(net) = out.next()
        {
            (0..4).for_each(|r| store(net, r, rows[r]));
        }
        return;
    }
    let left = if live & 1 != 0 { out.next() } else { None };
    let right = if live & 2 != 0 { out.next() } else { None };
    match (left, right) {
        (Some(left), Some(right)) => {
            for (r, row) in rows.iter().enumerate() {
                let [l, h] = halve(*row);
                store(left, r, l);
                store(right, r, h);
            }
        }
        (Some(left), None) => (0..4).for_each(|r| store(left, r, halve(rows[r])[0])),
        (None, Some(right)) => (0..4).for_each(|r| store(right, r, halve(rows[r])[1])),
        (None, None) => {}
    }
}
