//! Expressions as flat register programs over blocks of modules.
//!
//! Every instruction fills one register, a column with a word for each module of the block; equal
//! instructions are one. The operations are the rows of [`crate::language::ops`].

use super::BLOCK;
use crate::language::expr::{Expr, ExprKind};
use crate::language::ops::{Cpu, Op};
use crate::plan::Plan;
use crate::plan::layout::Layout;
use crate::plan::tables::Stage;
use std::collections::HashMap;

/// What the passes read of a chunk, beside its nets.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    pub records: &'a [u32],
    pub layout: Layout,
    /// The uniforms' words.
    pub uniforms: &'a [u32],
    /// The attribute `step`.
    pub step: u32,
}

impl<'a> Input<'a> {
    /// The modules of block `block`.
    pub fn block(&self, block: usize) -> Input<'a> {
        let words = self.layout.record_words;
        let start = block * BLOCK * words;
        let end = self.records.len().min(start + BLOCK * words);
        Input { records: &self.records[start..end], ..*self }
    }
    /// Modules.
    pub fn len(&self) -> usize {
        self.records.len() / self.layout.record_words
    }
    /// No module at all.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }
    /// The record of module `i`.
    #[inline]
    pub fn record(&self, i: usize) -> &'a [u32] {
        &self.records[i * self.layout.record_words..][..self.layout.record_words]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Instruction {
    Literal(u32),
    /// A word of the record.
    Field(usize),
    /// A word of the environment.
    Uniform(usize),
    Level,
    Step,
    /// The registers of its arguments.
    Call(Op, [usize; 3]),
}

/// A program; instruction n fills register n.
#[derive(Default)]
pub struct Program {
    instructions: Vec<Instruction>,
    known: HashMap<Instruction, usize>,
}

/// The registers of one program over one block.
#[derive(Default)]
pub struct Registers(Vec<u32>);

impl Registers {
    /// The column of a register.
    pub fn column(&self, register: usize) -> &[u32; BLOCK] {
        self.0[register * BLOCK..][..BLOCK].try_into().expect("a register holds a block")
    }
}

impl Program {
    fn push(&mut self, instruction: Instruction) -> usize {
        let next = self.instructions.len();
        *self.known.entry(instruction).or_insert_with(|| {
            self.instructions.push(instruction);
            next
        })
    }

    /// Adds an expression; the register that holds its value. `fields` says in which word of the
    /// record each field of the predecessor begins, `uniforms` the same of the environment.
    fn add(&mut self, e: &Expr, fields: &[usize], uniforms: &[usize]) -> usize {
        let instruction = match &e.kind {
            ExprKind::Literal(value) => Instruction::Literal(value.words()[0]),
            ExprKind::Binder(n) => Instruction::Field(fields[*n]),
            ExprKind::Uniform(n) => Instruction::Uniform(uniforms[*n]),
            ExprKind::Attribute("step") => Instruction::Step,
            ExprKind::Attribute(_) => Instruction::Level,
            ExprKind::Call(op, args) => {
                let mut registers = [0; 3];
                for (r, a) in registers.iter_mut().zip(args) {
                    *r = self.add(a, fields, uniforms);
                }
                Instruction::Call(*op, registers)
            }
            // `plan::supported` has refused all others.
            _ => Instruction::Literal(0),
        };
        self.push(instruction)
    }

    /// Runs the program over a block of at most [`BLOCK`] modules.
    pub fn run(&self, block: &Input, registers: &mut Registers) {
        registers.0.resize(self.instructions.len().max(1) * BLOCK, 0);
        for (n, instruction) in self.instructions.iter().enumerate() {
            let (before, rest) = registers.0.split_at_mut(n * BLOCK);
            let out = &mut rest[..BLOCK];
            let arg = |r: usize| &before[r * BLOCK..][..BLOCK];
            let words = block.layout.record_words;
            match *instruction {
                Instruction::Literal(word) => out.fill(word),
                Instruction::Uniform(at) => out.fill(block.uniforms[at]),
                Instruction::Step => out.fill(block.step),
                Instruction::Field(at) => {
                    let column = block.records.iter().skip(at).step_by(words);
                    out.iter_mut().zip(column).for_each(|(o, w)| *o = *w);
                }
                Instruction::Level => {
                    let heads = block.records.iter().step_by(words);
                    out.iter_mut().zip(heads).for_each(|(o, w)| *o = (w >> 16 & 0xff).max(w >> 24));
                }
                Instruction::Call(op, [a, b, c]) => match op.row().cpu {
                    Some(Cpu::One(f)) => f(arg(a), out),
                    Some(Cpu::Two(f)) => f(arg(a), arg(b), out),
                    Some(Cpu::Three(f)) => f(arg(a), arg(b), arg(c), out),
                    None => out.fill(0),
                },
            }
        }
    }

    /// Registers to run it with.
    pub fn registers(&self) -> Registers {
        Registers(vec![0; self.instructions.len().max(1) * BLOCK])
    }
}

/// One production: whether it fires, and the parameters of its children.
pub struct ProductionProgram {
    pub matching: Program,
    /// Registers of `matching`: all must be 1.
    pub guards: Vec<usize>,
    /// For a rule that rewrites a symbol to itself: (register of `matching`, word of the record);
    /// where all are equal nothing fires.
    pub unchanged: Option<Vec<(usize, usize)>>,
    pub children: Program,
    /// For each live cell (register of `children`, word of the child's record).
    pub args: [Vec<(usize, usize)>; 4],
}

/// The programs of a stage.
pub struct StageProgram {
    pub productions: Vec<ProductionProgram>,
    /// The rule table.
    pub words: Vec<u32>,
}

impl StageProgram {
    pub fn new(plan: &Plan, stage: &Stage) -> StageProgram {
        let (uniforms, _) = plan.environment_layout();
        let symbols = &plan.tables.symbols;
        let production = |p: &crate::plan::tables::Production| {
            let fields = &symbols[p.predecessor].words;
            let mut matching = Program::default();
            let guards = p.guards.iter().map(|g| matching.add(g, fields, &uniforms)).collect();
            let unchanged = p.relabels_itself().then(|| {
                let args = p.cells[0].iter().flat_map(|c| &c.args);
                args.zip(fields).map(|(a, &at)| (matching.add(a, fields, &uniforms), at)).collect()
            });
            let mut children = Program::default();
            let args = std::array::from_fn(|cell| match &p.cells[cell] {
                None => Vec::new(),
                Some(s) => {
                    let places = &symbols[s.symbol].words;
                    s.args
                        .iter()
                        .zip(places)
                        .map(|(a, &at)| (children.add(a, fields, &uniforms), at))
                        .collect()
                }
            });
            ProductionProgram { matching, guards, unchanged, children, args }
        };
        StageProgram {
            productions: stage.productions.iter().map(production).collect(),
            words: stage.rule_words(),
        }
    }
}
