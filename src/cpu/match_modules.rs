//! Which rule fires on each module: the first, by priority, of its symbol whose guards all hold.

use super::BLOCK;
use super::program::{Input, ProductionProgram, Registers, StageProgram};
use crate::plan::layout::Header;
use crate::plan::step::Status;
use crate::plan::tables::Stage;
use rayon::prelude::*;

/// Fills `rules`, and says what the chunk has to say.
pub fn match_modules(stage: &Stage, program: &StageProgram, input: &Input, rules: &mut [u32]) -> Status {
    rules
        .par_chunks_mut(BLOCK)
        .enumerate()
        .map_init(
            Registers::default,
            |registers, (block, rules)| {
                let block = input.block(block);
                match_block(stage, program, &block, rules, registers);
                status(stage, program, &block, rules)
            },
        )
        .reduce(Status::default, |a, b| Status {
            fired: a.fired | b.fired,
            too_deep: a.too_deep | b.too_deep,
            retired_symbols: a.retired_symbols | b.retired_symbols,
            ..a
        })
}

fn status(stage: &Stage, program: &StageProgram, block: &Input, rules: &[u32]) -> Status {
    let mut status = Status::default();
    for (i, &rule) in rules.iter().enumerate() {
        if rule < stage.keep() {
            let header = Header::read(block.record(i));
            status.fired = 1;
            status.too_deep |= header.child(program.words[rule as usize] & 3, 0, 0).is_none() as u32;
        } else if rule == stage.retired() {
            status.retired_symbols |= 1 << ((block.record(i)[0] & 0xffff) % 32);
        }
    }
    status
}

const UNDECIDED: u32 = u32::MAX;

fn match_block(
    stage: &Stage,
    program: &StageProgram,
    block: &Input,
    rules: &mut [u32],
    registers: &mut Registers,
) {
    let symbol = |i: usize| (block.record(i)[0] & 0xffff) as usize;
    let mut present = vec![false; stage.by_symbol.len()];
    for (i, rule) in rules.iter_mut().enumerate() {
        *rule = UNDECIDED;
        present[symbol(i)] = true;
    }
    for (id, production) in stage.productions.iter().enumerate() {
        let predecessor = production.predecessor;
        if !present[predecessor] {
            continue;
        }
        let compiled = &program.productions[id];
        compiled.matching.run(block, registers);
        for (i, rule) in rules.iter_mut().enumerate() {
            if *rule == UNDECIDED && symbol(i) == predecessor && holds(compiled, registers, i) {
                let idle = unchanged(compiled, registers, block.record(i), i);
                *rule = if idle { stage.idle(predecessor) } else { id as u32 };
            }
        }
    }
    for (i, rule) in rules.iter_mut().enumerate() {
        if *rule == UNDECIDED {
            *rule = stage.idle(symbol(i));
        }
    }
}

fn holds(production: &ProductionProgram, registers: &Registers, i: usize) -> bool {
    production.guards.iter().all(|&g| registers.column(g)[i] != 0)
}

fn unchanged(production: &ProductionProgram, registers: &Registers, record: &[u32], i: usize) -> bool {
    match &production.unchanged {
        None => false,
        Some(args) => args.iter().all(|&(register, at)| registers.column(register)[i] == record[at]),
    }
}
