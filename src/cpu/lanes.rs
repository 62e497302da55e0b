//! Children of points whose coordinates all go the same way, as those of affine rules do: four lanes a record.
//!
//! Where the coordinates of a child are one expression, each over its own coordinate of the points around, a record is
//! a vector as it lies in memory: nothing is gathered into columns and scattered again. The operations are the same,
//! lane by lane, and so are the bits. Sums of weighted points, most rules of curves, need no registers in memory:
//! [`super::sums`].

use super::program::Input;
use super::sums::{self, Child, Sum};
use crate::language::ops::Cpu;
use crate::plan::code::ChildCode;
use crate::plan::graph::{Graph, Node, NodeId, Scalar};
use crate::plan::tables::Production;
use glam::{BVec4A, Vec4};

/// Words of a record.
pub const LANES: usize = 4;
/// Modules that are done at once: their registers stay in the nearest cache.
const BLOCK: usize = 64;

/// One operation on all lanes; what it reads stands before it.
pub enum Op {
    /// The record so many places to the right, without its symbol.
    Load(i32),
    /// A word of the environment in all lanes, or a constant.
    Uniform(usize),
    Constant(u32),
    /// A row of the table of operations.
    Call {
        name: &'static str,
        cpu: Cpu,
        args: usize,
        registers: [usize; 3],
    },
}

/// The children of a production as operations on lanes.
pub struct Lanes {
    ops: Vec<Op>,
    /// For each child its symbol and the register of its coordinates.
    children: Vec<(u32, usize)>,
    /// What the children are, if all are sums of points.
    sums: Option<Vec<Sum>>,
    /// Coordinates of a point, 1 to 3.
    coordinates: usize,
    /// All symbols are 0, and so are numbers in their lane: records are read where they lie.
    in_place: bool,
}

impl Lanes {
    /// `None` where the records are of another size, or coordinates go different ways.
    pub fn new(production: &Production, code: &ChildCode, record_words: usize) -> Option<Lanes> {
        let coordinates = code.args.first()?.len();
        if record_words != LANES || !(1..LANES).contains(&coordinates) {
            return None;
        }
        let mut builder = Builder { graph: &code.graph, ops: Vec::new(), known: Vec::new() };
        let mut children = Vec::new();
        for (cell, args) in code.args.iter().enumerate() {
            let symbol = production.successor(cell)?.symbol as u32;
            let in_order = args.iter().map(|arg| arg.1).eq(1..coordinates + 1);
            let floats = args.iter().all(|arg| code.graph.scalar(arg.0) == Scalar::Float);
            if !in_order || !floats {
                return None;
            }
            let nodes: Vec<NodeId> = args.iter().map(|arg| arg.0).collect();
            children.push((symbol, builder.lane(&nodes)?));
        }
        let in_place = production.predecessor == 0;
        let ops = builder.ops;
        let sums = children.iter().map(|&(_, register)| Sum::of(&ops, register)).collect();
        Some(Lanes { ops, children, sums, coordinates, in_place })
    }

    /// Writes the children of all modules of a part.
    pub fn run(&self, part: &Input, out: &mut [u32]) {
        let growth = self.children.len();
        let lanes = BVec4A::from_array(std::array::from_fn(|lane| (1..=self.coordinates).contains(&lane)));
        let outs = out.as_chunks_mut::<LANES>().0.chunks_mut(BLOCK * growth);
        if let Some(sums) = &self.sums {
            let constants = sums::constants(&self.ops, part.environment);
            for (block, out) in outs.enumerate() {
                for (number, (sum, &(symbol, _))) in sums.iter().zip(&self.children).enumerate() {
                    sum.run(
                        part,
                        block * BLOCK,
                        &constants,
                        Child { number, growth, symbol: of_symbol(symbol), lanes },
                        out,
                    );
                }
            }
            return;
        }
        let mut registers = vec![0u32; self.ops.len() * BLOCK * LANES];
        let register = |n: usize| n * BLOCK * LANES..(n + 1) * BLOCK * LANES;
        for (n, op) in self.ops.iter().enumerate() {
            match *op {
                Op::Uniform(at) => registers[register(n)].fill(part.environment[at]),
                Op::Constant(word) => registers[register(n)].fill(word),
                Op::Load(_) | Op::Call { .. } => {}
            }
        }
        for (block, out) in outs.enumerate() {
            let (start, count) = (block * BLOCK, out.len() / growth);
            for (n, op) in self.ops.iter().enumerate() {
                let (before, rest) = registers.split_at_mut(n * BLOCK * LANES);
                let to = &mut rest[..count * LANES];
                let arg = |r: usize| match self.ops[r] {
                    Op::Load(offset) if self.in_place => window(part, start, offset, count),
                    _ => &before[r * BLOCK * LANES..][..count * LANES],
                };
                match *op {
                    Op::Load(_) if self.in_place => {}
                    Op::Load(offset) => load(part, start, offset, to),
                    Op::Uniform(_) | Op::Constant(_) => {}
                    Op::Call { cpu, registers: [a, b, c], .. } => match cpu {
                        Cpu::One(f) => f(arg(a), to),
                        Cpu::Two(f) => f(arg(a), arg(b), to),
                        Cpu::Three(f) => f(arg(a), arg(b), arg(c), to),
                    },
                }
            }
            for (c, &(symbol, from)) in self.children.iter().enumerate() {
                let points = match self.ops[from] {
                    Op::Load(offset) if self.in_place => window(part, start, offset, count),
                    _ => &registers[register(from)],
                };
                let points = points.as_chunks::<LANES>().0;
                let children = out[c..].iter_mut().step_by(growth);
                let symbol = of_symbol(symbol);
                children.zip(points).for_each(|(to, point)| *to = with_symbol(point, lanes, symbol));
            }
        }
    }
}

/// The records of some modules, so many places to the right.
pub fn window<'a>(part: &Input<'a>, start: usize, offset: i32, count: usize) -> &'a [u32] {
    let first = (part.first as i64 + start as i64 + i64::from(offset)) as usize;
    &part.window[first * LANES..][..count * LANES]
}

/// Symbols would be numbers so small that arithmetic takes long over them.
fn load(part: &Input, start: usize, offset: i32, to: &mut [u32]) {
    let records = window(part, start, offset, to.len() / LANES).as_chunks::<LANES>().0;
    let coordinates = BVec4A::new(false, true, true, true);
    for (to, record) in to.as_chunks_mut::<LANES>().0.iter_mut().zip(records) {
        *to = with_symbol(record, coordinates, Vec4::ZERO);
    }
}

/// The lanes of a record that hold coordinates; the others of `symbol`.
#[inline(always)]
fn with_symbol(record: &[u32; LANES], coordinates: BVec4A, symbol: Vec4) -> [u32; LANES] {
    let record = Vec4::from_array(record.map(f32::from_bits));
    Vec4::select(coordinates, record, symbol).to_array().map(f32::to_bits)
}

/// A record with nothing but a symbol.
pub fn of_symbol(symbol: u32) -> Vec4 {
    Vec4::new(f32::from_bits(symbol), 0.0, 0.0, 0.0)
}

struct Builder<'a> {
    graph: &'a Graph,
    ops: Vec<Op>,
    /// Nodes of the coordinates, and the register that holds them.
    known: Vec<(Vec<NodeId>, usize)>,
}

impl Builder<'_> {
    /// The register of one node a coordinate.
    fn lane(&mut self, nodes: &[NodeId]) -> Option<usize> {
        if let Some((_, register)) = self.known.iter().find(|(known, _)| known == nodes) {
            return Some(*register);
        }
        let all = || nodes.iter().map(|&n| self.graph.nodes[n]);
        let op = match self.graph.nodes[nodes[0]] {
            Node::Field(ty, 1) if all().eq((1..=nodes.len()).map(|w| Node::Field(ty, w))) => Op::Load(0),
            Node::Near(ty, offset, 1) if all().eq((1..=nodes.len()).map(|w| Node::Near(ty, offset, w))) => {
                Op::Load(offset)
            }
            Node::Uniform(_, at) if nodes.iter().all(|n| *n == nodes[0]) => Op::Uniform(at),
            Node::Literal(_, word) | Node::Held(word) if nodes.iter().all(|n| *n == nodes[0]) => {
                Op::Constant(word)
            }
            Node::Call(op, _) => {
                let row = op.row();
                let cpu = row.cpu?;
                let mut args = Vec::new();
                for &n in nodes {
                    match self.graph.nodes[n] {
                        Node::Call(other, list) if other == op => args.push(list),
                        _ => return None,
                    }
                }
                let mut registers = [0; 3];
                for (k, register) in registers.iter_mut().enumerate().take(row.args.len()) {
                    let nodes: Vec<NodeId> = args.iter().map(|list| list[k]).collect();
                    *register = self.lane(&nodes)?;
                }
                Op::Call { name: row.symbol(), cpu, args: row.args.len(), registers }
            }
            _ => return None,
        };
        self.ops.push(op);
        self.known.push((nodes.to_vec(), self.ops.len() - 1));
        Some(self.ops.len() - 1)
    }
}
