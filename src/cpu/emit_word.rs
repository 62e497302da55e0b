//! The children of a curve's modules: symbols and parameters, which may be made of what stands around.
//!
//! A module of 16 bytes that becomes two reads 16, with its neighbours from the caches, and writes 32: Chaikin's rule
//! for points of three coordinates does 12 flops for it, 0.25 a byte, which memory bandwidth bounds.

use super::BLOCK;
use super::lanes::Lanes;
use super::match_modules::fired;
use super::program::{self, Input, Registers};
use crate::plan::tables::{Production, Stage};
use rayon::ThreadPool;
use std::sync::{Mutex, PoisonError};

/// Writes the children of all modules to `out`, which holds exactly those that the scan counted.
///
/// Where the growth is closed `rules` and `offsets` are not read.
pub fn emit_word(
    threads: &ThreadPool,
    stage: &Stage,
    input: &Input,
    rules: &[u32],
    offsets: &[u32],
    out: &mut [u32],
) {
    let input = &Input { offsets, ..*input };
    let (n, words) = (input.len(), input.layout.record_words);
    let offset = |i: usize| match stage.closed {
        Some(growth) => i * growth as usize,
        None => offsets[i] as usize,
    };
    let mut parts = Vec::with_capacity(n.div_ceil(BLOCK));
    let mut rest = out;
    for start in (0..n).step_by(BLOCK) {
        let modules = start..n.min(start + BLOCK);
        let (part, left) = rest.split_at_mut((offset(modules.end) - offset(start)) * words);
        rest = left;
        parts.push((modules, part));
    }
    let lanes = match &stage.productions[..] {
        [production] if stage.closed.is_some() => Lanes::new(production, &stage.code.children[0], words),
        _ => None,
    };
    let workers = threads.current_num_threads().min(parts.len());
    let parts = Mutex::new(parts.into_iter());
    let work = || {
        let mut registers: Vec<_> = stage.productions.iter().map(|_| Registers::default()).collect();
        loop {
            let next = parts.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((modules, out)) = next else { return };
            if let Some(lanes) = &lanes {
                lanes.run(&input.part(modules), out);
                continue;
            }
            let rules = stage.closed.is_none().then(|| &rules[modules.clone()]);
            emit_part(stage, &input.part(modules), rules, &mut registers, out);
        }
    };
    // The calling thread is one of the workers, as in `emit`.
    threads.in_place_scope(|scope| {
        (1..workers).for_each(|_| scope.spawn(|_| work()));
        work();
    });
}

fn emit_part(
    stage: &Stage,
    part: &Input,
    rules: Option<&[u32]>,
    registers: &mut [Registers],
    out: &mut [u32],
) {
    let words = part.layout.record_words;
    if let (None, [production]) = (rules, &stage.productions[..]) {
        program::run(&stage.code.children[0].graph, part, &mut registers[0]);
        return all_the_same(stage, production, part.len(), &registers[0], out, words);
    }
    let mut ready = vec![false; stage.productions.len()];
    let mut at = 0;
    for i in 0..part.len() {
        let rule = fired(stage, part, rules, i);
        if rule == stage.retired() as usize {
            continue;
        }
        let Some(production) = stage.productions.get(rule) else {
            copy(part.record(i), &mut out[at..at + words]);
            if let Some(link) = part.layout.link {
                out[at + link] = part.hangs[part.first + i];
            }
            at += words;
            continue;
        };
        let code = &stage.code.children[rule];
        if !ready[rule] {
            program::run(&code.graph, part, &mut registers[rule]);
            ready[rule] = true;
        }
        for (cell, successor) in production.successors() {
            let args = &code.args[cell];
            let child = &mut out[at..at + words];
            at += words;
            only_symbol(child, successor.symbol);
            for &(register, word) in args {
                child[word] = registers[rule].column(register)[i];
            }
        }
    }
}

/// A record of no parameters. Those of 16 bytes, of most words of symbols and points, are one store.
fn only_symbol(record: &mut [u32], symbol: usize) {
    match <&mut [u32; 4]>::try_from(&mut *record) {
        Ok(record) => *record = [symbol as u32, 0, 0, 0],
        Err(_) => {
            record.fill(0);
            record[0] = symbol as u32;
        }
    }
}

fn copy(record: &[u32], to: &mut [u32]) {
    match (<&[u32; 4]>::try_from(record), <&mut [u32; 4]>::try_from(&mut *to)) {
        (Ok(record), Ok(to)) => *to = *record,
        _ => to.copy_from_slice(record),
    }
}

/// One production for all modules: word by word of the children, so that columns are read in a row.
fn all_the_same(
    stage: &Stage,
    production: &Production,
    n: usize,
    registers: &Registers,
    out: &mut [u32],
    words: usize,
) {
    let growth = production.cells();
    for (c, successor) in production.successors() {
        let args = &stage.code.children[0].args[c];
        let mut columns: [Option<&[u32; BLOCK]>; 4] = [None; 4];
        if words == 4 {
            for &(register, word) in args {
                columns[word] = Some(registers.column(register));
            }
            let zeros = &[0; BLOCK];
            let [_, x, y, z] = columns.map(|column| column.unwrap_or(zeros));
            let (children, symbol) = (out.as_chunks_mut::<4>().0, successor.symbol as u32);
            for (i, child) in children.iter_mut().skip(c).step_by(growth).take(n).enumerate() {
                *child = [symbol, x[i], y[i], z[i]];
            }
            continue;
        }
        for i in 0..n {
            let child = &mut out[(i * growth + c) * words..][..words];
            only_symbol(child, successor.symbol);
            for &(register, word) in args {
                child[word] = registers.column(register)[i];
            }
        }
    }
}
