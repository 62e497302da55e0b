//! What the host gives: values of roots, and grids.

use super::{Graph, Names, Node, NodeId, Scalar};
use crate::language::expr::Type;

/// A coordinate among the points of a grid's axis.
struct Axis {
    /// Points.
    size: NodeId,
    /// The points on either side, and the nearest.
    low: NodeId,
    high: NodeId,
    near: NodeId,
    /// From 0 at `low` to 1 at `high`.
    between: NodeId,
}

impl Graph {
    /// The words of the value that the host gives the module's root.
    pub(super) fn of_root(&mut self, query: usize, ty: Scalar, names: &Names) -> Vec<NodeId> {
        let root = self.push(Node::Field(Scalar::Int, 1));
        self.given(query, ty, root, names)
    }

    /// The words of value `n` of a query.
    pub(super) fn given(&mut self, query: usize, ty: Scalar, n: NodeId, names: &Names) -> Vec<NodeId> {
        let words = names.environment.queries[query];
        let base = self.push(Node::Uniform(Scalar::Int, names.environment.given.values(query)));
        let stride = self.int(words as u32);
        let offset = self.ints("*", &[n, stride]);
        let first = self.ints("+", &[base, offset]);
        let place = |graph: &mut Graph, word: usize| {
            let word = graph.int(word as u32);
            graph.ints("+", &[first, word])
        };
        let places: Vec<NodeId> = (0..words).map(|w| place(self, w)).collect();
        places.into_iter().map(|at| self.push(Node::Given(ty, at))).collect()
    }

    /// The value of a grid at a point: along each axis the two points of the grid next to it, and
    /// how far it lies between them; then z first, since x is fastest.
    pub(super) fn sample(
        &mut self,
        query: usize,
        ty: Scalar,
        point: &[NodeId],
        names: &Names,
    ) -> Vec<NodeId> {
        let axes: Vec<Axis> = (0..3).map(|axis| self.axis(query, axis, point[axis], names)).collect();
        let [x, y, z] = [&axes[0], &axes[1], &axes[2]];
        if ty != Scalar::Float {
            let n = self.grid_point(x, y, [x.near, y.near, z.near]);
            return self.given(query, ty, n, names);
        }
        let mut corners = Vec::with_capacity(8);
        for n in 0..8 {
            let side = |axis: &Axis, bit: usize| if n >> bit & 1 == 0 { axis.low } else { axis.high };
            let at = self.grid_point(x, y, [side(x, 0), side(y, 1), side(z, 2)]);
            corners.push(self.given(query, ty, at, names));
        }
        for axis in [x, y, z] {
            let pairs: Vec<Vec<NodeId>> = corners
                .chunks_exact(2)
                .map(|pair| {
                    let words = pair[0].iter().zip(&pair[1]);
                    words.map(|(&a, &b)| self.mix(Graph::float, a, b, axis.between)).collect()
                })
                .collect();
            corners = pairs;
        }
        corners.swap_remove(0)
    }

    /// Where a coordinate lies among the points of an axis.
    fn axis(&mut self, query: usize, axis: usize, coordinate: NodeId, names: &Names) -> Axis {
        let given = names.environment.given;
        let [size, from, density] = [
            Node::Uniform(Scalar::Int, given.size(query, axis)),
            Node::Uniform(Scalar::Float, given.from(query, axis)),
            Node::Uniform(Scalar::Float, given.density(query, axis)),
        ]
        .map(|node| self.push(node));
        let one = self.int(1);
        let last = self.ints("-", &[size, one]);
        let end = self.call("float", &[Type::Int], &[last]);
        let above = self.float("-", &[coordinate, from]);
        let place = self.float("*", &[above, density]);
        let zero = self.number(0.0);
        let place = self.float("clamp", &[place, zero, end]);
        let floor = self.float("floor", &[place]);
        let low = self.call("int", &[Type::Float], &[floor]);
        let next = self.ints("+", &[low, one]);
        let high = self.ints("min", &[next, last]);
        let between = self.float("-", &[place, floor]);
        let round = self.float("round", &[place]);
        let near = self.call("int", &[Type::Float], &[round]);
        Axis { size, low, high, near, between }
    }

    /// The number of a grid's point.
    fn grid_point(&mut self, x: &Axis, y: &Axis, [i, j, k]: [NodeId; 3]) -> NodeId {
        let slice = self.ints("*", &[k, y.size]);
        let row = self.ints("+", &[slice, j]);
        let start = self.ints("*", &[row, x.size]);
        self.ints("+", &[start, i])
    }
}
