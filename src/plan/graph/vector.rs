//! Operations on vectors as rows of scalars.

use super::{Graph, NodeId};
use crate::language::expr::Type;

impl Graph {
    pub(super) fn expand_vector(&mut self, name: &str, args: &[Vec<NodeId>]) -> Vec<NodeId> {
        match (name, args) {
            ("fract", [v]) => v.iter().map(|&x| self.fract(x)).collect(),
            ("%", [a, b]) => vec![self.remainder(a[0], b[0])],
            ("mix", [a, b, t]) if a.len() == 1 => vec![self.mix(Graph::scalar_call, a[0], b[0], t[0])],
            ("mix", [a, b, t]) => (0..a.len()).map(|i| self.mix(Graph::float, a[i], b[i], t[0])).collect(),
            ("smoothstep", [low, high, x]) => vec![self.smoothstep(low[0], high[0], x[0])],
            ("dot", [a, b]) => vec![self.dot(a, b)],
            ("length", [v]) => vec![self.length(v)],
            ("distance", [a, b]) => {
                let difference: Vec<NodeId> =
                    a.iter().zip(b).map(|(&x, &y)| self.scalar_call("-", &[x, y])).collect();
                vec![self.length(&difference)]
            }
            ("normalize", [v]) => {
                let length = self.length(v);
                v.iter().map(|&x| self.float("/", &[x, length])).collect()
            }
            ("noise", [p]) => vec![self.float("noise #", &[p[0], p[1], p[2]])],
            ("frame *", [frame, v]) => self.in_frame(frame, v),
            ("cross", [a, b]) if a.len() == 2 => vec![self.minor(a, b, 0, 1)],
            ("cross", [a, b]) => [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minor(a, b, i, j)).to_vec(),
            ("rotate", [v, angle]) => self.rotate_plane(v, angle[0]),
            ("rotate", [v, axis, angle]) => self.rotate_about(v, axis, angle[0]),
            ("if", [condition, a, b]) => {
                let types = [Type::Bool, Type::Float, Type::Float];
                (0..a.len()).map(|i| self.call("if", &types, &[condition[0], a[i], b[i]])).collect()
            }
            _ => self.each(name, args),
        }
    }

    /// The scalar row for each component; a single number goes with every component.
    pub(super) fn each(&mut self, name: &str, args: &[Vec<NodeId>]) -> Vec<NodeId> {
        let length = args.iter().map(Vec::len).max().unwrap_or(0);
        let pick = |i: usize| -> Vec<NodeId> { args.iter().map(|a| a[i.min(a.len() - 1)]).collect() };
        (0..length).map(|i| self.float(name, &pick(i))).collect()
    }

    pub(super) fn fract(&mut self, x: NodeId) -> NodeId {
        let floor = self.scalar_call("floor", &[x]);
        self.scalar_call("-", &[x, floor])
    }

    /// a − b·trunc(a / b)
    pub(super) fn remainder(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let quotient = self.scalar_call("/", &[a, b]);
        let whole = self.scalar_call("trunc", &[quotient]);
        let product = self.scalar_call("*", &[b, whole]);
        self.scalar_call("-", &[a, product])
    }

    /// (a − a·t) + b·t: drivers take a·(1 − t) + b·t for an interpolation and compute another.
    pub(super) fn mix(
        &mut self,
        call: fn(&mut Graph, &str, &[NodeId]) -> NodeId,
        a: NodeId,
        b: NodeId,
        t: NodeId,
    ) -> NodeId {
        let (part, second) = (call(self, "*", &[a, t]), call(self, "*", &[b, t]));
        let first = call(self, "-", &[a, part]);
        call(self, "+", &[first, second])
    }

    /// t·t·(3 − 2t) with t = clamp((x − low) / (high − low), 0, 1)
    pub(super) fn smoothstep(&mut self, low: NodeId, high: NodeId, x: NodeId) -> NodeId {
        let (above, width) = (self.scalar_call("-", &[x, low]), self.scalar_call("-", &[high, low]));
        let ratio = self.scalar_call("/", &[above, width]);
        let (zero, one) = (self.number(0.0), self.number(1.0));
        let t = self.scalar_call("clamp", &[ratio, zero, one]);
        let (two, three) = (self.number(2.0), self.number(3.0));
        let twice = self.scalar_call("*", &[two, t]);
        let rest = self.scalar_call("-", &[three, twice]);
        let square = self.scalar_call("*", &[t, t]);
        self.scalar_call("*", &[square, rest])
    }

    /// Products summed from left to right.
    pub(super) fn dot(&mut self, a: &[NodeId], b: &[NodeId]) -> NodeId {
        let products: Vec<NodeId> = a.iter().zip(b).map(|(&x, &y)| self.scalar_call("*", &[x, y])).collect();
        products.into_iter().reduce(|sum, p| self.scalar_call("+", &[sum, p])).unwrap_or(0)
    }

    pub(super) fn length(&mut self, v: &[NodeId]) -> NodeId {
        let square = self.dot(v, v);
        self.float("sqrt", &[square])
    }

    pub(super) fn minor(&mut self, a: &[NodeId], b: &[NodeId], i: usize, j: usize) -> NodeId {
        let (first, second) = (self.scalar_call("*", &[a[i], b[j]]), self.scalar_call("*", &[a[j], b[i]]));
        self.scalar_call("-", &[first, second])
    }

    /// Components along the three axes of a frame, whose components stand one axis after the other.
    pub(super) fn in_frame(&mut self, frame: &[NodeId], v: &[NodeId]) -> Vec<NodeId> {
        (0..3).map(|k| self.dot(&[frame[k], frame[3 + k], frame[6 + k]], v)).collect()
    }

    pub(super) fn sine_and_cosine(&mut self, degrees: NodeId) -> (NodeId, NodeId) {
        let angle = self.float("radians", &[degrees]);
        (self.float("sin", &[angle]), self.float("cos", &[angle]))
    }

    pub(super) fn rotate_plane(&mut self, v: &[NodeId], degrees: NodeId) -> Vec<NodeId> {
        let (sin, cos) = self.sine_and_cosine(degrees);
        let (xc, ys) = (self.float("*", &[v[0], cos]), self.float("*", &[v[1], sin]));
        let (xs, yc) = (self.float("*", &[v[0], sin]), self.float("*", &[v[1], cos]));
        vec![self.float("-", &[xc, ys]), self.float("+", &[xs, yc])]
    }

    /// Rodrigues: v·cos + (k × v)·sin + k·(k·v)·(1 − cos)
    pub(super) fn rotate_about(&mut self, v: &[NodeId], axis: &[NodeId], degrees: NodeId) -> Vec<NodeId> {
        let (sin, cos) = self.sine_and_cosine(degrees);
        let length = self.length(axis);
        let k: Vec<NodeId> = axis.iter().map(|&x| self.float("/", &[x, length])).collect();
        let side = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minor(&k, v, i, j));
        let one = self.number(1.0);
        let rest = self.float("-", &[one, cos]);
        let dot = self.dot(&k, v);
        let along = self.float("*", &[dot, rest]);
        let component = |graph: &mut Graph, i: usize| {
            let (a, b) = (graph.float("*", &[v[i], cos]), graph.float("*", &[side[i], sin]));
            let c = graph.float("*", &[k[i], along]);
            let sum = graph.float("+", &[a, b]);
            graph.float("+", &[sum, c])
        };
        (0..3).map(|i| component(self, i)).collect()
    }
}
