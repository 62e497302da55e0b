//! The invariants of a watertight mesh, found again from its triangles and leaves without the trees'
//! neighbours: by lists of all leaves, and by sets of all points on a line.

use burgeon::cpu::tessellate::Tessellator;
use burgeon::patch::Net;
use burgeon::tessellate::lattice::{FULL, NOWHERE, Node, along};
use burgeon::tessellate::passes::{Corner, FAN};
use burgeon::tessellate::surface::{Patches, orders};
use burgeon::tessellate::topology::{curve_of, entries, incidence, side_at, turned};
use std::collections::{BTreeSet, HashMap};

/// What a check found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checked {
    pub leaves: usize,
    pub vertices: usize,
    pub triangles: usize,
    pub border_edges: usize,
    pub most_on_an_edge: usize,
    /// V − E + F
    pub characteristic: i64,
    /// The largest sampled error over the tolerance.
    pub error: f64,
}

/// Where an edge or a point lies: on a curve, or on a line of lattice points of a root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Line {
    Curve(u32),
    /// Root, coordinate that is constant, its value.
    Inner(u32, usize, u32),
    /// A diagonal or a spoke of one leaf.
    Inside(u32, [[u32; 2]; 2]),
}

struct Check<'a> {
    t: &'a Tessellator,
    words: &'a [u32],
    /// By their cells, and the shapes that occur.
    leaves: HashMap<(u32, [u32; 2], [u32; 2]), Node>,
    shapes: BTreeSet<[u32; 2]>,
}

impl Check<'_> {
    /// The line of an edge of a root, and its ends along it.
    fn line(&self, root: u32, [p, q]: [[u32; 2]; 2]) -> (Line, [u32; 2]) {
        // All of a collapsed side is one point: that which lies straight across from the other end.
        let (p, q) = (self.straight(root, p, q), self.straight(root, q, p));
        for constant in 0..2 {
            if p[constant] != q[constant] {
                continue;
            }
            let mut ends = [p[1 - constant], q[1 - constant]];
            if let Some(side) = side_at(p[constant], constant) {
                assert_eq!(along(side), 1 - constant);
                let curve = curve_of(self.words, root, side);
                assert_ne!(curve, NOWHERE, "an edge on a collapsed side");
                let own = entries(self.words, curve).iter().map(|&e| incidence(e));
                let (_, _, turn) = own.clone().find(|e| (e.0, e.1) == (root, side)).expect("its own entry");
                ends = ends.map(|t| turned(t, turn));
                ends.sort();
                return (Line::Curve(curve), ends);
            }
            ends.sort();
            // A leaf with two neighbouring sides that are one point is but an edge, seen from both of the others.
            for d in [0, 1] {
                let mut place = [ends[0]; 2];
                place[constant] = p[constant] - d;
                let leaf = self.covering(root, place);
                let collapsed = |side: u32| self.collapsed(leaf, side);
                if (collapsed(0) || collapsed(1)) && (collapsed(2) || collapsed(3)) {
                    return (Line::Inside(root, [leaf.low(), leaf.corner(3)]), [0, 1]);
                }
            }
            return (Line::Inner(root, constant, p[constant]), ends);
        }
        let mut ends = [p, q];
        ends.sort();
        (Line::Inside(root, ends), [0, 1])
    }

    /// Whether a side of a leaf lies on a side of its root that is one point.
    fn collapsed(&self, leaf: &Node, side: u32) -> bool {
        let border = leaf.corner([0, 1, 0, 2][side as usize])[usize::from(side >= 2)];
        side_at(border, usize::from(side >= 2)) == Some(side)
            && curve_of(self.words, leaf.root, side) == NOWHERE
    }

    fn straight(&self, root: u32, mut p: [u32; 2], q: [u32; 2]) -> [u32; 2] {
        for constant in 0..2 {
            if let Some(side) = side_at(p[constant], constant)
                && curve_of(self.words, root, side) == NOWHERE
            {
                p[1 - constant] = q[1 - constant];
            }
        }
        p
    }

    /// The leaf that covers a lattice cell, by trying all shapes.
    fn covering(&self, root: u32, p: [u32; 2]) -> &Node {
        let of_shape = |depth: &[u32; 2]| {
            let cell = [0, 1].map(|k| p[k] / (FULL >> depth[k]));
            self.leaves.get(&(root, *depth, cell))
        };
        let mut found = self.shapes.iter().filter_map(of_shape);
        let leaf = found.next().expect("a leaf covers every place");
        assert!(found.next().is_none(), "leaves overlap");
        leaf
    }

    /// How many leaves that are no holes have this edge.
    fn expected(&self, line: Line, [a, _]: [u32; 2]) -> usize {
        match line {
            Line::Inside(..) => 2,
            Line::Inner(root, constant, value) => {
                let place = |d: u32| {
                    let mut p = [a; 2];
                    p[constant] = value - d;
                    p
                };
                [0, 1].into_iter().filter(|&d| !self.covering(root, place(d)).is_hole()).count()
            }
            Line::Curve(curve) => {
                let live = |&&entry: &&u32| {
                    let (root, side, turn) = incidence(entry);
                    let mut p = [(side & 1) * (FULL - 1); 2];
                    p[along(side)] = if turn { FULL - a - 1 } else { a };
                    !self.covering(root, p).is_hole()
                };
                entries(self.words, curve).iter().filter(live).count()
            }
        }
    }
}

/// Checks T1 to T4, T6 (with a tolerance in the model's units) and the count for T7.
pub fn check(t: &Tessellator, nets: &[Net], tolerance: Option<f32>) -> Checked {
    let tree = t.tree();
    let words = t.topology().words();
    let leaves = (0..tree.nodes.len()).filter(|&n| tree.is_leaf(n as u32)).map(|n| tree.nodes[n]);
    let count = leaves.clone().filter(|n| !n.is_hole()).count();
    let shapes = leaves.clone().map(|n| n.depth()).collect();
    let all = leaves.clone().count();
    let leaves: HashMap<_, _> = leaves.map(|n| ((n.root, n.depth(), [n.i, n.j]), n)).collect();
    assert_eq!(leaves.len(), all, "two leaves of one cell");
    let check = Check { t, words, leaves, shapes };
    let (out, mesh) = (t.out(), t.mesh());
    let mut found = Checked { leaves: count, vertices: mesh.positions.len(), ..Checked::default() };
    found.triangles = out.cells.len();

    // The triangles again, as corners: they must come in the order of the indices.
    let mut corners = Vec::new();
    for node in (0..tree.nodes.len() as u32).filter(|&n| tree.is_leaf(n)) {
        tree.triangles(node, t.trees().marks[node as usize], |triangle| {
            corners.push(tree.corners(node, triangle));
        });
    }
    assert_eq!(corners.len(), out.cells.len());
    let place = |corner: Corner| match corner {
        Corner::At { root, p } => (root, p),
        Corner::Centre { node } => {
            assert_ne!(t.trees().marks[node as usize] & FAN, 0);
            (tree.nodes[node as usize].root, tree.nodes[node as usize].centre())
        }
    };

    let mut areas: HashMap<u32, u64> = HashMap::new();
    let mut edges: HashMap<(Line, [u32; 2]), Vec<[u32; 2]>> = HashMap::new();
    let mut on_line: HashMap<Line, BTreeSet<u32>> = HashMap::new();
    let mut used = vec![false; mesh.positions.len()];
    for (((triangle, cell), index), &written) in corners.iter().zip(out.indices.chunks(3)).zip(&out.cells) {
        assert_eq!(*cell, written);
        let node = &tree.nodes[*cell as usize];
        let places = triangle.map(place);
        assert!(places.iter().all(|p| p.0 == node.root), "a triangle of two roots");
        let p = places.map(|p| p.1);
        let (low, size) = (node.low(), node.size());
        for q in p {
            assert!((0..2).all(|k| low[k] <= q[k] && q[k] <= low[k] + size[k]), "a vertex outside its leaf");
        }
        let d = |a: [u32; 2], b: [u32; 2], k: usize| i64::from(b[k]) - i64::from(a[k]);
        let area = d(p[0], p[1], 0) * d(p[0], p[2], 1) - d(p[0], p[1], 1) * d(p[0], p[2], 0);
        assert!(area > 0, "a triangle turned over");
        *areas.entry(*cell).or_default() += area as u64;
        let mirrored = t.topology().orientation(node.root).mirrors();
        let index = if mirrored { [index[0], index[2], index[1]] } else { [index[0], index[1], index[2]] };
        assert!(
            index[0] != index[1] && index[1] != index[2] && index[2] != index[0],
            "a degenerate triangle"
        );
        for (k, &v) in index.iter().enumerate() {
            used[v as usize] = true;
            let next = (k + 1) % 3;
            let (line, ends) = check.line(node.root, [p[k], p[next]]);
            on_line.entry(line).or_default().extend(ends);
            let mut pair = [v, index[next]];
            pair.sort();
            edges.entry((line, ends)).or_default().push(pair);
        }
    }
    assert!(used.iter().all(|&u| u), "a vertex of no triangle");

    // Leaves are covered once, but for triangles at collapsed sides.
    for (n, node) in tree.nodes.iter().enumerate() {
        if !tree.is_leaf(n as u32) || node.is_hole() {
            continue;
        }
        let size = node.size();
        let whole = 2 * u64::from(size[0]) * u64::from(size[1]);
        let touches = (0..4).any(|side| check.collapsed(node, side));
        let covered = areas.get(&(n as u32)).copied().unwrap_or(0);
        assert!(covered == whole || touches && covered < whole, "{node:?}: {covered} of {whole}");
    }

    // T1, T2: each edge as often as leaves have it. No two edges between the same two vertices.
    let mut by_pair: HashMap<[u32; 2], (Line, [u32; 2])> = HashMap::new();
    for ((line, ends), pairs) in &edges {
        assert!(pairs.iter().all(|p| p == &pairs[0]), "one edge of different vertices: {line:?} {ends:?}");
        assert_eq!(pairs.len(), check.expected(*line, *ends), "{line:?} {ends:?}");
        let before = by_pair.insert(pairs[0], (*line, *ends));
        assert_eq!(before, None, "{:?} is two edges: {line:?} {ends:?}", pairs[0]);
        found.border_edges += usize::from(pairs.len() == 1);
        found.most_on_an_edge = found.most_on_an_edge.max(pairs.len());
        // No vertex inside an edge.
        if !matches!(line, Line::Inside(..)) {
            assert_eq!(on_line[line].range(ends[0] + 1..ends[1]).next(), None, "a T-vertex on {line:?}");
        }
    }
    found.characteristic = mesh.positions.len() as i64 - edges.len() as i64 + found.triangles as i64;

    // T3: every patch of a border vertex computes the same bits. Where a vertex goes is computed once: see
    // `placement`.
    let degree = nets[0].degree;
    let points: Vec<[f32; 4]> = nets.iter().flat_map(|n| n.points.iter().copied()).collect();
    let orders = orders(degree);
    let rational = points.iter().any(|p| p[3] != 1.0);
    let patches = Patches { degree, rational, nets: &points, orders: &orders };
    for (triangle, index) in corners.iter().zip(out.indices.chunks(3)).filter(|_| !t.is_displaced()) {
        let root = tree.nodes[triangle.1 as usize].root;
        let mirrored = t.topology().orientation(root).mirrors();
        let net = patches.control(root, tree.orientation(root));
        let index = if mirrored { [index[0], index[2], index[1]] } else { [index[0], index[1], index[2]] };
        for (corner, v) in triangle.0.into_iter().zip(index) {
            let bits = net.position(place(corner).1).to_array().map(f32::to_bits);
            assert_eq!(bits, mesh.positions[v as usize].map(f32::to_bits), "a patch that disagrees");
        }
    }

    // T4: no two vertices in one place, but where a patch lies on another: those are two sheets.
    let mut places: HashMap<[u32; 3], usize> = HashMap::new();
    let sheets = (1..nets.len()).any(|n| nets[..n].contains(&nets[n]));
    for (v, p) in mesh.positions.iter().enumerate().filter(|_| !sheets) {
        let before = places.insert(p.map(f32::to_bits), v);
        assert_eq!(before, None, "two vertices at {p:?}");
    }

    // T6: the surface at the same parameter is near.
    if let Some(tolerance) = tolerance {
        for (triangle, cell) in &corners {
            let node = &tree.nodes[*cell as usize];
            let net = &nets[node.root as usize];
            let orientation = t.topology().orientation(node.root);
            let parameters = triangle.map(|c| orientation.uv(place(c).1).map(f64::from));
            let exact = |uv: [f64; 2]| net.view().evaluate(uv[0], uv[1]).position.map(f64::from);
            let corners = parameters.map(exact);
            for weights in
                [[1.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0], [1.0, 1.0, 0.0]]
            {
                let sum: f64 = weights.iter().sum();
                let mix = |values: [f64; 3]| (0..3).map(|k| weights[k] * values[k]).sum::<f64>() / sum;
                let uv = [0, 1].map(|k| mix(parameters.map(|p| p[k])));
                let on_triangle = [0, 1, 2].map(|k| mix(corners.map(|c| c[k])));
                let on_surface = exact(uv);
                let off: f64 = (0..3).map(|k| (on_surface[k] - on_triangle[k]).powi(2)).sum::<f64>().sqrt();
                found.error = found.error.max(off / f64::from(tolerance));
            }
        }
        assert!(found.error <= 1.0, "{} of the tolerance", found.error);
    }
    assert_eq!(check.t.status().vertices as usize, mesh.positions.len());
    found
}
