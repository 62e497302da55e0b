//! Random numbers, and the draw among alternatives.

use super::{Graph, Names, Node, NodeId, Scalar, Subject};
use crate::language::expr::Type;

impl Graph {
    /// The hash behind one random number: of the seed, for a module the step of the whole run, what names
    /// it (of a patch module root and order key), the rule, and the call in it.
    pub(super) fn draw(&mut self, names: &Names, call: u32) -> NodeId {
        let (mut hash, step) = match names.subject {
            Subject::Module(_) => (self.seed(names), Some(self.push(Node::RunStep))),
            Subject::Vertex { seed } => (self.push(Node::Uniform(Scalar::Int, seed)), None),
        };
        let path: Vec<NodeId> =
            names.path.iter().map(|&word| self.push(Node::Field(Scalar::Int, word))).collect();
        let site = names.site;
        let place = [self.int(site), self.int(call)];
        for word in step.into_iter().chain(path).chain(place) {
            hash = self.ints("hash #", &[hash, word]);
        }
        hash
    }

    pub(super) fn random(&mut self, function: &str, hash: NodeId, args: &[NodeId]) -> NodeId {
        if function == "randn" {
            return self.normal(hash);
        }
        let unit = self.call("unit #", &[Type::Int], &[hash]);
        match *args {
            [low, high] => {
                let width = self.scalar_call("-", &[high, low]);
                let above = self.scalar_call("*", &[width, unit]);
                self.scalar_call("+", &[low, above])
            }
            _ => unit,
        }
    }

    /// Twelve 16-bit slices, summed as integers, less their mean: standard deviation 1.
    pub(super) fn normal(&mut self, hash: NodeId) -> NodeId {
        let mut sum = self.int((-6i32 * 65_535) as u32);
        for n in 0..6 {
            let number = self.int(n);
            let word = self.ints("hash #", &[hash, number]);
            let slices = self.ints("slices #", &[word]);
            sum = self.ints("+", &[sum, slices]);
        }
        let sum = self.call("float", &[Type::Int], &[sum]);
        let scale = self.number(1.0 / 65_536.0);
        self.float("*", &[sum, scale])
    }

    /// The draw among alternatives: whether any weight is positive, and the index drawn. Weights
    /// count in 65,536ths, as integers, up to 32,767 over their number.
    pub fn choice(&mut self, weights: &[NodeId], names: &Names) -> (NodeId, NodeId) {
        let most = 32_767.0 / weights.len() as f32;
        let (zero, most) = (self.number(0.0), self.number(most));
        let unit = self.number(65_536.0);
        let mut total = self.int(0);
        let mut ends = Vec::with_capacity(weights.len());
        for &weight in weights {
            let weight = self.float("clamp", &[weight, zero, most]);
            let scaled = self.float("*", &[weight, unit]);
            let whole = self.float("round", &[scaled]);
            let fixed = self.call("int", &[Type::Float], &[whole]);
            total = self.ints("+", &[total, fixed]);
            ends.push(total);
        }
        // A site of its own, so that a call of `rand` in the rule does not move it.
        let hash = self.draw(names, u32::MAX);
        let drawn = self.ints("scale #", &[hash, total]);
        let mut index = self.int(weights.len() as u32 - 1);
        for (n, &end) in ends.iter().enumerate().rev().skip(1) {
            let below = self.ints("<", &[drawn, end]);
            let here = self.int(n as u32);
            index = self.call("if", &[Type::Bool, Type::Int, Type::Int], &[below, here, index]);
        }
        let none = self.int(0);
        (self.ints(">", &[total, none]), index)
    }
}
