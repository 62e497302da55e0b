//! Which rule fires on each module: the first, by priority, of its symbol whose guards all hold.

use super::BLOCK;
use super::program::{Input, ProductionProgram, Registers, StageProgram};
use crate::plan::tables::Stage;
use rayon::prelude::*;

/// Fills `rules`; whether any rule fired.
pub fn match_modules(stage: &Stage, program: &StageProgram, input: &Input, rules: &mut [u32]) -> bool {
    let keep = stage.keep();
    rules
        .par_chunks_mut(BLOCK)
        .enumerate()
        .map_init(
            || Registers::default(),
            |registers, (block, rules)| {
                match_block(stage, program, &input.block(block), rules, registers);
                rules.iter().any(|&r| r < keep)
            },
        )
        .reduce(|| false, |a, b| a | b)
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
