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
        .map_init(Desk::default, |desk, (block, rules)| {
            let block = input.block(block);
            match_block(stage, &block, rules, desk);
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
            let halves = words[rule as usize] & 3;
            if halves != 0 {
                let header = Header::read(block.record(i));
                status.too_deep |= u32::from(header.child(halves, 0, 0).is_none());
            }
        } else if rule == stage.retired() {
            status.retired_symbols |= 1 << ((block.record(i)[0] & 0xffff) % 32);
        }
    }
    status
}

/// The rule id of module `i`: that which was matched, or, where nothing is, what its symbol says.
#[inline]
pub fn fired(stage: &Stage, part: &Input, rules: Option<&[u32]>, i: usize) -> usize {
    match rules {
        Some(rules) => rules[i] as usize,
        None => stage
            .first_production((part.record(i)[0] & 0xffff) as usize)
            .expect("where the stage is closed each symbol has a rule"),
    }
}

const UNDECIDED: u32 = u32::MAX;

/// What a thread needs for one block after the other.
#[derive(Default)]
struct Desk {
    registers: Registers,
    /// Of the modules, and of as many beside them as a context sees.
    symbols: Vec<u32>,
    /// For each module whether a rule fires on it, 1 or 0. Plain loops over columns, which vectorise.
    fires: Vec<u32>,
}

fn match_block(stage: &Stage, block: &Input, rules: &mut [u32], desk: &mut Desk) {
    let Desk { registers, symbols, fires } = desk;
    let (n, halo) = (rules.len(), block.layout.halo());
    let first = block.first - halo;
    symbols.clear();
    symbols.extend((first..first + n + 2 * halo).map(|i| block.symbol(i)));
    rules.fill(UNDECIDED);
    for (rule, code) in stage.rules.iter().zip(&stage.code.rules) {
        let predecessor = rule.predecessor as u32;
        fires.clear();
        fires.extend(symbols[halo..][..n].iter().map(|&symbol| u32::from(symbol == predecessor)));
        // Where modules stand side by side the symbols of a context are looked at first: most rules of symbols ask for
        // no more, and need no registers.
        let (context, guards) = match halo {
            0 => (&[][..], &code.guards[..]),
            _ => (&rule.context[..], &code.guards[rule.context.len()..]),
        };
        for near in context {
            let there = &symbols[halo.wrapping_add_signed(near.place.offset() as isize)..][..n];
            fires
                .iter_mut()
                .zip(there)
                .for_each(|(fires, &symbol)| *fires &= u32::from(symbol == near.symbol));
        }
        if fires.iter().all(|&fires| fires == 0) {
            continue;
        }
        let draws = code.choice.is_some() || code.unchanged.iter().any(Option::is_some);
        if draws || !guards.is_empty() {
            program::run(&code.graph, block, registers);
        }
        for &guard in guards {
            let holds = registers.column(guard);
            fires.iter_mut().zip(holds).for_each(|(fires, &holds)| *fires &= u32::from(holds != 0));
        }
        let production = rule.productions.start as u32;
        if !draws {
            for (id, &fires) in rules.iter_mut().zip(&*fires) {
                *id = if *id == UNDECIDED && fires != 0 { production } else { *id };
            }
            continue;
        }
        let choice = code.choice.map(|choice| registers.column(choice));
        for (i, id) in rules.iter_mut().enumerate().filter(|(i, id)| **id == UNDECIDED && fires[*i] != 0) {
            let drawn = choice.map_or(0, |choice| choice[i]);
            let idle = unchanged(code, drawn as usize, registers, block, i);
            *id = if idle { stage.idle(rule.predecessor) } else { production + drawn };
        }
    }
    for (rule, &symbol) in rules.iter_mut().zip(&symbols[halo..]) {
        if *rule == UNDECIDED {
            *rule = stage.idle(symbol as usize);
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
