//! Which rule fires on each module: the first, by priority, of its symbol whose guards all hold.

use super::BLOCK;
use super::program::{self, Input, Registers};
use crate::plan::code::RuleCode;
use crate::plan::layout::Header;
use crate::plan::step::Status;
use crate::plan::tables::Stage;
use rayon::prelude::*;

/// Fills `rules`, and says what the chunk has to say.
pub fn match_modules(stage: &Stage, words: &[u32], input: &Input, rules: &mut [u32]) -> Status {
    rules
        .par_chunks_mut(BLOCK)
        .enumerate()
        .map_init(Default::default, |(registers, symbols), (block, rules)| {
            let block = input.block(block);
            match_block(stage, &block, rules, registers, symbols);
            status(stage, words, &block, rules)
        })
        .reduce(Status::default, |a, b| Status {
            fired: a.fired | b.fired,
            too_deep: a.too_deep | b.too_deep,
            retired_symbols: a.retired_symbols | b.retired_symbols,
            ..a
        })
}

/// What the chunk has to say of rules that were matched.
pub fn status(stage: &Stage, words: &[u32], block: &Input, rules: &[u32]) -> Status {
    let mut status = Status::default();
    for (i, &rule) in rules.iter().enumerate() {
        if rule < stage.keep() {
            status.fired = 1;
            if block.layout.is_curve() {
                continue;
            }
            let header = Header::read(block.record(i));
            status.too_deep |= header.child(words[rule as usize] & 3, 0, 0).is_none() as u32;
        } else if rule == stage.retired() {
            status.retired_symbols |= 1 << ((block.record(i)[0] & 0xffff) % 32);
        }
    }
    status
}

const UNDECIDED: u32 = u32::MAX;

fn match_block(
    stage: &Stage,
    block: &Input,
    rules: &mut [u32],
    registers: &mut Registers,
    symbols: &mut Vec<usize>,
) {
    let heads = block.records.iter().step_by(block.layout.record_words);
    symbols.clear();
    symbols.extend(heads.map(|head| (head & 0xffff) as usize));
    rules.fill(UNDECIDED);
    let mut present = vec![false; stage.by_symbol.len()];
    symbols.iter().for_each(|&symbol| present[symbol] = true);
    for (rule, code) in stage.rules.iter().zip(&stage.code.rules) {
        let predecessor = rule.predecessor;
        if !present[predecessor] {
            continue;
        }
        program::run(&code.graph, block, registers);
        let registers = &*registers;
        let guards: Vec<&[u32; BLOCK]> = code.guards.iter().map(|&guard| registers.column(guard)).collect();
        let choice = code.choice.map(|choice| registers.column(choice));
        for (i, (id, &symbol)) in rules.iter_mut().zip(&*symbols).enumerate() {
            let fires = *id == UNDECIDED && symbol == predecessor && guards.iter().all(|guard| guard[i] != 0);
            if fires {
                let drawn = choice.map_or(0, |choice| choice[i]);
                let idle = unchanged(code, drawn as usize, registers, block, i);
                *id = if idle { stage.idle(predecessor) } else { rule.productions.start as u32 + drawn };
            }
        }
    }
    for (rule, &symbol) in rules.iter_mut().zip(&*symbols) {
        if *rule == UNDECIDED {
            *rule = stage.idle(symbol);
        }
    }
}

/// Whether alternative `n` leaves the module as it is.
fn unchanged(rule: &RuleCode, n: usize, registers: &Registers, block: &Input, i: usize) -> bool {
    match &rule.unchanged[n] {
        None => false,
        Some(args) => args.iter().all(|&(node, at)| registers.column(node)[i] == block.record(i)[at]),
    }
}
