//! The numbers of "Tensor Product Surfaces as Rewriting Process", by requirement.
//!
//! Each check takes a [`Backend`], so that the oracle and the engine answer to the same numbers.

use crate::oracle::{self, Net, Param};
use std::collections::HashMap;

/// One module as a check sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub symbol: String,
    pub params: Vec<Param>,
    pub root: usize,
    pub cell: oracle::Cell,
    pub net: Net,
}

/// From a text and nets to words.
pub type Derive<'a> = dyn Fn(&str, &[Net]) -> Vec<Vec<Seen>> + 'a;

/// Something that derives words.
pub struct Backend<'a> {
    /// The word after every step, index 0 the axiom, of the last system of a text; all its files
    /// hold the nets given.
    pub derive: &'a Derive<'a>,
    /// How far a coordinate of size 1 may be off.
    pub tolerance: f64,
}

impl Backend<'_> {
    fn words(&self, text: &str, nets: &[Net]) -> Vec<Vec<Seen>> {
        (self.derive)(text, nets)
    }

    fn near(&self, a: [f64; 4], b: [f64; 4]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= self.tolerance * b.abs().max(1.0))
    }

    #[track_caller]
    fn assert_near(&self, a: [f64; 4], b: [f64; 4]) {
        assert!(self.near(a, b), "{a:?} and {b:?}");
    }
}

/// How the oracle's words are seen.
pub fn seen_by_oracle(word: &oracle::Word) -> Vec<Seen> {
    let seen = |m: &oracle::Module| Seen {
        symbol: m.symbol.clone(),
        params: m.params.clone(),
        root: m.root,
        cell: m.cell(),
        net: (*m.net).clone(),
    };
    word.modules.iter().map(seen).collect()
}

/// How an engine's words are seen.
pub fn seen_by_engine(word: &burgeon::patch::Word) -> Vec<Seen> {
    use burgeon::language::Value;
    let param = |value: Value| match value {
        Value::Int(i) => Param::Int(i),
        Value::Bool(b) => Param::Bool(b),
        Value::Float(x) => Param::Float(x as f64),
        other => panic!("{other:?}"),
    };
    let seen = |(index, m): (usize, &burgeon::patch::Module)| Seen {
        symbol: word.symbols[m.symbol].name.clone(),
        params: word.params(index).iter().map(param).collect(),
        root: m.root as usize,
        cell: oracle::Cell {
            du: m.cell.du as u32,
            dv: m.cell.dv as u32,
            i: m.cell.i as u64,
            j: m.cell.j as u64,
        },
        net: Net::new(
            word.degree.map(usize::from),
            word.net(index).iter().map(|p| p.map(f64::from)).collect(),
        ),
    };
    word.modules.iter().enumerate().map(seen).collect()
}

/// The checks whose systems this version derives.
pub const DERIVED: &[fn(&Backend)] = &[
    k2_any_degree,
    k3_children_are_the_products_of_equations_3_to_5,
    k3_children_reproduce_the_surface,
    k4_stacked_grid_and_its_limit,
    k5_a_condition_guards_the_block,
    k6_the_level_ends_the_recursion,
    k10_rational_surfaces,
    k10_a_sphere_and_a_torus_stay_what_they_are,
    k11_the_cylinder_is_round,
    k12_eps_terminates_or_leaves_a_hole,
    k13_regular_holes,
    k14_sierpinski,
    k14_the_teapot_agrees_with_exact_rationals,
    k15_the_double_triangle,
    k17_roots_are_independent,
    e2_a_split_has_49_points,
    e7_e8_one_alphabet_for_both_systems_fails,
    k7_only_what_is_near_is_refined,
    k8_bend_chooses_the_direction,
    k9_flat_areas_are_not_refined,
    e3_without_a_level_bound_refinement_goes_on,
];

// --- inputs ------------------------------------------------------------------------------------

/// A bicubic net of small integers, without symmetry.
fn sheet() -> Net {
    lattice([3, 3], 0)
}

fn lattice(degree: [usize; 2], salt: i64) -> Net {
    let points = (0..=degree[0] as i64).flat_map(|r| {
        (0..=degree[1] as i64).map(move |c| {
            let height = (5 * r * r + 3 * r * c + 7 * c * c + 11 * r + salt) % 13 - 6;
            [(4 * r + c % 2) as f64, (4 * c + r % 2) as f64, height as f64, 1.0]
        })
    });
    Net::new(degree, points.collect())
}

/// A bicubic plane with evenly spread points: x = row, y = column, z given by (x, y).
fn graph(height: impl Fn(f64, f64) -> f64) -> Net {
    let at = |k: usize| (k / 4, k % 4);
    let point = |k| {
        let (r, c) = (at(k).0 as f64, at(k).1 as f64);
        [r, c, height(r, c), 1.0]
    };
    Net::new([3, 3], (0..16).map(point).collect())
}

const SPLIT: &str =
    "system s : patch bezier 3\nmodule P\naxiom: P = file \"sheet.bpt\"\nrules:\n  P -> [ P P ; P P ]\n";

const SIERPINSKI: &str = r#"
system sierpinski2 : patch bezier 3
module P, Q, A, B, C, D, A2, B2, C2, D2
axiom: P = file "sheet.bpt"  Q = file "sheet.bpt"
rules:
  P -> [ A B ; C D ]
  A -> [ A eps ; A A ]
  B -> eps
  C -> [ C eps ; C C ]
  D -> [ D eps ; D D ]
  Q  -> [ A2 B2 ; C2 D2 ]
  A2 -> [ A2 A2 ; eps A2 ]
  B2 -> [ B2 B2 ; eps B2 ]
  C2 -> eps
  D2 -> [ D2 D2 ; eps D2 ]
run:
  derive 6
"#;

fn of_root(word: &[Seen], root: usize) -> Vec<&Seen> {
    word.iter().filter(|m| m.root == root).collect()
}

fn rows_and_columns(modules: &[&Seen]) -> Vec<(u64, u64)> {
    modules.iter().map(|m| (m.cell.i, m.cell.j)).collect()
}

/// A point of the root's surface, (u, v) being local to a module.
fn on_root(root: &Net, module: &Seen, u: f64, v: f64) -> [f64; 4] {
    let global = |index: u64, local: f64, halvings: u32| (index as f64 + local) / 2f64.powi(halvings as i32);
    root.evaluate(global(module.cell.i, u, module.cell.du), global(module.cell.j, v, module.cell.dv))
}

fn assert_on_surface(backend: &Backend, root: &Net, module: &Seen) {
    for u in [0.0, 0.3, 0.5, 1.0] {
        for v in [0.0, 0.25, 0.7, 1.0] {
            backend.assert_near(module.net.evaluate(u, v), on_root(root, module, u, v));
        }
    }
}

fn distance(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn centroid(net: &Net) -> [f64; 4] {
    let sum = |axis: usize| net.points.iter().map(|p| p[axis]).sum::<f64>();
    [0, 1, 2, 3].map(|axis| sum(axis) / net.points.len() as f64)
}

// --- section 2.2 -------------------------------------------------------------------------------

/// The matrices as the paper prints them.
const L: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [0.25, 0.5, 0.25, 0.0], [0.125, 0.375, 0.375, 0.125]];
const R: [[f64; 4]; 4] =
    [[0.125, 0.375, 0.375, 0.125], [0.0, 0.25, 0.5, 0.25], [0.0, 0.0, 0.5, 0.5], [0.0, 0.0, 0.0, 1.0]];

fn k2_any_degree(backend: &Backend) {
    for degree in [[1, 1], [1, 3], [2, 2], [4, 1], [3, 5], [8, 8]] {
        let net = lattice(degree, 3);
        let [m, n] = degree;
        let text = SPLIT.replace("bezier 3", &format!("bezier {m} {n}")) + "run:\n  derive 2\n";
        let words = backend.words(&text, std::slice::from_ref(&net));
        assert_eq!(words[2].len(), 16);
        for module in &words[2] {
            assert_eq!(module.net.points.len(), (m + 1) * (n + 1));
            assert_on_surface(backend, &net, module);
        }
    }
}

fn k3_children_are_the_products_of_equations_3_to_5(backend: &Backend) {
    let net = sheet();
    let words = backend.words(SPLIT, std::slice::from_ref(&net));
    // Upper left, upper right / lower left, lower right.
    let factors = [(L, L), (L, R), (R, L), (R, R)];
    for (module, (rows, columns)) in words[1].iter().zip(factors) {
        for (r, weights) in rows.iter().enumerate() {
            for (c, other) in columns.iter().enumerate() {
                let mut sum = [0.0; 4];
                for k in 0..16 {
                    let weight = weights[k / 4] * other[k % 4];
                    for (total, x) in sum.iter_mut().zip(net.point(k / 4, k % 4)) {
                        *total += weight * x;
                    }
                }
                // Dyadic weights and small integers: no rounding anywhere.
                assert_eq!(module.net.point(r, c), sum);
            }
        }
    }
    let cells: Vec<_> = words[1].iter().map(|m| (m.cell.i, m.cell.j)).collect();
    assert_eq!(cells, [(0, 0), (0, 1), (1, 0), (1, 1)]);
}

/// B(t)·L = B(t/2) and B(t)·R = B((1 + t)/2), in both directions.
fn k3_children_reproduce_the_surface(backend: &Backend) {
    let words = backend.words(&(SPLIT.to_string() + "run:\n  derive 3\n"), &[sheet()]);
    for module in words.iter().flatten() {
        assert_on_surface(backend, &sheet(), module);
    }
}

/// The control points of a full word stacked as one matrix, as the paper's P(k).
fn stacked(word: &[Seen], level: u32) -> Vec<Vec<[f64; 4]>> {
    let side = 4 << level;
    let cells: HashMap<_, _> = word.iter().map(|m| ((m.cell.i, m.cell.j), &m.net)).collect();
    let point = |r: u64, c: u64| cells[&(r / 4, c / 4)].point(r as usize % 4, c as usize % 4);
    (0..side).map(|r| (0..side).map(|c| point(r, c)).collect()).collect()
}

fn k4_stacked_grid_and_its_limit(backend: &Backend) {
    let net = graph(|x, y| x * (3.0 - x) * y);
    let words = backend.words(&(SPLIT.to_string() + "run:\n  derive 4\n"), std::slice::from_ref(&net));
    let mut last = f64::INFINITY;
    for (k, word) in words.iter().enumerate() {
        assert_eq!(word.len(), 1 << (2 * k));
        let grid = stacked(word, k as u32);
        assert_eq!((grid.len(), grid[0].len()), (1 << (k + 2), 1 << (k + 2)));
        // The seams are doubled, bit by bit.
        for seam in (4..grid.len()).step_by(4) {
            assert_eq!(grid[seam - 1], grid[seam]);
            assert!(grid.iter().all(|row| row[seam - 1] == row[seam]));
        }
        // Points come nearer to the surface at their own place: by a factor of 4 a level.
        let off = word.iter().flat_map(|m| {
            let net = net.clone();
            let place = move |q: usize| on_root(&net, m, (q / 4) as f64 / 3.0, (q % 4) as f64 / 3.0);
            (0..16).map(move |q| distance(m.net.points[q], place(q)))
        });
        let off = off.fold(0.0, f64::max);
        assert!(off < last / 3.0, "level {k}: {off} after {last}");
        last = off;
    }
}

/// Reading E1: with LPL for the upper left child the surface is lost.
#[test]
fn e1_the_last_factor_is_transposed() {
    let net = sheet();
    let transposed = |m: &Vec<Vec<f64>>| (0..4).map(|r| (0..4).map(|c| m[c][r]).collect()).collect();
    let left = oracle::left(3);
    let (right_way, wrong_way) = (net.product(&left, &left), net.product(&left, &transposed(&left)));
    assert_eq!(right_way.evaluate(1.0, 1.0), net.evaluate(0.5, 0.5));
    assert_ne!(wrong_way.evaluate(1.0, 1.0), net.evaluate(0.5, 0.5));
}

/// Reading E2: a word of 4 × 4 nets; the four share 7 × 7 points, each computed once.
fn e2_a_split_has_49_points(backend: &Backend) {
    let words = backend.words(SPLIT, &[sheet()]);
    let mut points: Vec<_> =
        words[1].iter().flat_map(|m| m.net.points.iter().map(|p| p.map(f64::to_bits))).collect();
    assert_eq!(points.len(), 64);
    points.sort_unstable();
    points.dedup();
    assert_eq!(points.len(), 49);
}

#[test]
fn k3_the_matrices() {
    let rows = |m: [[f64; 4]; 4]| m.iter().map(|r| r.to_vec()).collect::<Vec<_>>();
    assert_eq!((oracle::left(3), oracle::right(3)), (rows(L), rows(R)));
    for degree in 1..=8 {
        let (left, right) = (oracle::left(degree), oracle::right(degree));
        assert!(left.iter().chain(&right).all(|row| row.iter().sum::<f64>() == 1.0));
        assert_eq!(left[degree], right[0]);
        // Triangular: the determinant is the product of the diagonal, 2^-(1 + 2 + … + degree).
        let triangular =
            (0..=degree).all(|r| (r + 1..=degree).all(|c| left[r][c] == 0.0 && right[c][r] == 0.0));
        assert!(triangular);
        let diagonal = |m: &Vec<Vec<f64>>| (0..=degree).map(|k| m[k][k]).product::<f64>();
        let determinant = 0.5f64.powi((degree * (degree + 1) / 2) as i32);
        assert_eq!((diagonal(&left), diagonal(&right)), (determinant, determinant));
    }
    assert_eq!((0..4).map(|k| L[k][k]).product::<f64>(), 1.0 / 64.0);
}

// --- sections 2.2 to 2.5 -----------------------------------------------------------------------

fn k5_a_condition_guards_the_block(backend: &Backend) {
    let text = "system s : patch bezier 3\nmodule P(n: int)\naxiom: P(0) = file \"x\" P(1) = file \"x\"\n\
                rules:\n  P(n) : n == 1 -> [ P(n) P(n) ; P(n) P(0) ]\nrun:\n  derive 2\n";
    let words = backend.words(text, &[sheet()]);
    assert_eq!(of_root(&words[2], 0), of_root(&words[0], 0));
    assert_eq!([0, 1, 2].map(|k| of_root(&words[k], 1).len()), [1, 4, 13]);
}

fn k6_the_level_ends_the_recursion(backend: &Backend) {
    for max in 0..=4 {
        let text = format!(
            "system s : patch bezier 3\nconst max_level: int = {max}\nmodule P(level: int)\naxiom: P(0) = file \"x\"\n\
             rules:\n  p1: P(level) : level < max_level -> [ P(level+1) P(level+1) ; P(level+1) P(level+1) ]\n\
             run:\n  derive until terminal max 99\n"
        );
        let words = backend.words(&text, &[sheet()]);
        assert_eq!(words.len() - 1, max, "exactly max steps fire");
        let last = words.last().unwrap();
        assert_eq!(last.len(), 1 << (2 * max));
        assert!(last.iter().all(|m| m.params == [Param::Int(max as i32)] && m.cell.du == max as u32));
    }
}

/// Equation 7 with reading E3.
const NEAR: &str = "system adaptive : patch bezier 3\nparam eps_dist: float = 5/2\nparam eye: vec3 = (0, 0, 1)\nconst depth: int = 4\n\
                    module P(level: int)\nquery E(d: float) = distance(eye, centroid)\naxiom: P(0) = file \"x\"\nrules:\n  \
                    ?E(d) P(level) : d <= eps_dist - 1/4*level && level < depth -> [ P(level+1) P(level+1) ; P(level+1) P(level+1) ]\n\
                    run:\n  derive until terminal max 9\n";

fn k7_only_what_is_near_is_refined(backend: &Backend) {
    let words = backend.words(NEAR, &[graph(|x, y| 0.1 * x * y)]);
    assert_eq!(words.len(), 5);
    let limit = |level: i32| 2.5 - f64::from(level) / 4.0;
    let mut levels = [0; 5];
    for module in words.last().unwrap() {
        let [Param::Int(level)] = module.params[..] else { panic!("one int") };
        levels[level as usize] += 1;
        assert_eq!(level as u32, module.cell.du);
        let d = distance(centroid(&module.net), [0.0, 0.0, 1.0, 1.0]);
        assert!(level == 4 || d > limit(level) - backend.tolerance, "{level} {d}");
    }
    assert!(levels[4] > 0 && levels[1] + levels[2] > 0, "{levels:?}");
}

/// Reading E3: what is near stays near, so only `derive`'s own bound ends it.
fn e3_without_a_level_bound_refinement_goes_on(backend: &Backend) {
    let text = NEAR
        .replace(" - 1/4*level && level < depth", "")
        .replace("const depth: int = 4\n", "")
        .replace("max 9", "max 6");
    let words = backend.words(&text, &[graph(|_, _| 0.0)]);
    assert_eq!(words.len(), 7);
    assert!(words.windows(2).all(|w| w[0].len() < w[1].len()));
}

/// A 2×1 block halves u: what bends along u only is split in u only. The second difference falls to a quarter.
fn k8_bend_chooses_the_direction(backend: &Backend) {
    let text = "system aniso : patch bezier 3\nparam tol: float = 1/10\nmodule P(level: int)\nquery Ku(k: float) = bend_u\nquery Kv(k: float) = bend_v\n\
                axiom: P(0) = file \"x\"\nrules:\n  ?Ku(a) ?Kv(b) P(l) : l < 8 && a > tol && a >= b -> [ P(l+1) ; P(l+1) ]\n  \
                ?Kv(b) P(l) : l < 8 && b > tol -> [ P(l+1) | P(l+1) ]\nrun:\n  derive until terminal max 8\n";
    // Second differences of 2 along one direction: 2 → 1/2 → 1/8 → 1/32 ≤ 1/10.
    let along_u = backend.words(text, &[graph(|x, _| x * x)]);
    let last = along_u.last().unwrap();
    assert_eq!((along_u.len() - 1, last.len()), (3, 8));
    assert!(last.iter().all(|m| (m.cell.du, m.cell.dv) == (3, 0)));
    let along_v = backend.words(text, &[graph(|_, y| y * y)]);
    assert!(along_v.last().unwrap().iter().all(|m| (m.cell.du, m.cell.dv) == (0, 3)));
    // Bent alike both ways, u goes first.
    let both = backend.words(text, &[graph(|x, y| x * x + y * y)]);
    assert!(both[1].iter().all(|m| (m.cell.du, m.cell.dv) == (1, 0)));
    assert!(both.last().unwrap().iter().all(|m| (m.cell.du, m.cell.dv) == (3, 3)));
}

fn k9_flat_areas_are_not_refined(backend: &Backend) {
    let text = "system s : patch bezier 3\nmodule P(level: int)\nquery Flat(f: float) = flatness\naxiom: P(0) = file \"x\"\nrules flat:\n  \
                ?Flat(f) P(level) : f > 0.001 && level < 3 -> [ P(level+1) | P(level+1) ; P(level+1) | P(level+1) ]\n\
                run:\n  derive 4 with flat\n";
    let (plane, bump) = (graph(|x, y| x + 2.0 * y), graph(|x, _| if x < 2.0 { 0.0 } else { 1.0 }));
    let words = backend.words(text, &[plane, bump]);
    let last = words.last().unwrap();
    assert_eq!(of_root(last, 0).len(), 1);
    assert_eq!(of_root(last, 1).len(), 64);
}

fn k10_rational_surfaces(backend: &Backend) {
    let mut net = sheet();
    for (index, point) in net.points.iter_mut().enumerate() {
        let w = 1.0 + (index % 3) as f64 / 2.0;
        *point = [point[0] * w, point[1] * w, point[2] * w, w];
    }
    let text = SPLIT.replace("bezier 3", "bezier 3 rational") + "run:\n  derive 2\n";
    let words = backend.words(&text, std::slice::from_ref(&net));
    for module in &words[2] {
        assert_on_surface(backend, &net, module);
        assert!(module.net.points.iter().all(|p| p[3] >= 1.0 && p[3] <= 2.0), "weights stay in their hull");
    }
}

/// Reading E6: each quarter is an exact arc, by weights 1, (1 + √2)/3, (1 + √2)/3, 1.
fn k11_the_cylinder_is_round(backend: &Backend) {
    let w = (1.0 + 2f64.sqrt()) / 3.0;
    let k = 2.0 - 2f64.sqrt();
    let arc = [(1.0, 0.0, 1.0), (1.0, k, w), (k, 1.0, w), (0.0, 1.0, 1.0)];
    let quarter = |turns: usize| {
        let point = |index: usize| {
            let (x, y, w) = arc[index / 4];
            let (x, y) = (0..turns).fold((x, y), |(x, y), _| (-y, x));
            [x * w, y * w, (index % 4) as f64 * w, w]
        };
        Net::new([3, 3], (0..16).map(point).collect())
    };
    let text = "system cylinder : patch bezier 3 rational\nmodule A(l: int)\naxiom: A(0) = file \"quarters.bpt\"\nrules:\n  \
                A(l) -> [ A(l+1) A(l+1) ; A(l+1) A(l+1) ]\nrun:\n  derive 3\n";
    let words = backend.words(text, &[0, 1, 2, 3].map(quarter));
    assert_eq!(words.iter().map(Vec::len).collect::<Vec<_>>(), [4, 16, 64, 256]);
    for module in words.iter().flatten() {
        for corner in [0, 3, 12, 15] {
            let [x, y, _, w] = module.net.points[corner];
            let off = (x / w).hypot(y / w) - 1.0;
            assert!(off.abs() <= backend.tolerance, "{off}");
        }
    }
}

/// A quarter of a circle as a conic: weights 1, √½, 1.
const CONIC: [[f64; 3]; 3] = [[1.0, 0.0, 1.0], [1.0, 1.0, std::f64::consts::FRAC_1_SQRT_2], [0.0, 1.0, 1.0]];

/// Biquadratic nets: a quarter of a profile about (`centre`, 0), turned by quarters in its plane, and swept around
/// the z axis by quarters.
fn revolved(centre: f64, profile_turns: usize, turns: usize) -> Net {
    let turned = |[x, y, w]: [f64; 3], turns: usize| {
        let (x, y) = (0..turns).fold((x, y), |(x, y), _| (-y, x));
        [x, y, w]
    };
    let point = |index: usize| {
        let [radius, z, w] = turned(CONIC[index / 3], profile_turns);
        let [x, y, v] = turned(CONIC[index % 3], turns);
        let (radius, weight) = (centre + radius, w * v);
        [radius * x * weight, radius * y * weight, z * weight, weight]
    };
    Net::new([2, 2], (0..9).map(point).collect())
}

fn k10_a_sphere_and_a_torus_stay_what_they_are(backend: &Backend) {
    let text = "system s : patch bezier 2 rational\nmodule P(l: int)\naxiom: P(0) = file \"x\"\nrules:\n  \
                P(l) : l % 2 == 0 -> [ P(l+1) P(l+1) ; P(l+1) P(l+1) ]\n  P(l) -> [ P(l+1) | P(l+1) ]\nrun:\n  derive 4\n";
    let quarters = || (0..4).flat_map(|a| (0..4).map(move |b| (a, b)));
    let sphere: Vec<Net> =
        quarters().filter(|(a, _)| [0, 3].contains(a)).map(|(a, b)| revolved(0.0, a, b)).collect();
    let torus: Vec<Net> = quarters().map(|(a, b)| revolved(2.0, a, b)).collect();
    for (nets, centre) in [(sphere, 0.0), (torus, 2.0)] {
        let words = backend.words(text, &nets);
        assert_eq!(words[4].len(), 64 * nets.len());
        for module in &words[4] {
            for (u, v) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.5), (0.3, 0.8)] {
                let [x, y, z, w] = module.net.evaluate(u, v);
                let off = (x.hypot(y) / w - centre).hypot(z / w) - 1.0;
                assert!(off.abs() <= backend.tolerance * (1.0 + centre), "{off} about {centre}");
            }
        }
    }
}

// --- section 2.6 -------------------------------------------------------------------------------

fn k12_eps_terminates_or_leaves_a_hole(backend: &Backend) {
    let text = "system s : patch bezier 3\nmodule P(n: int), Q\naxiom: P(0) = file \"x\"\nrules:\n  P(n) : n == 2 -> eps\n  \
                P(n) -> [ P(n+1) Q ; Q P(n+1) ]\nrun:\n  derive until terminal max 9\n";
    let words = backend.words(text, &[sheet()]);
    assert_eq!(words.iter().map(Vec::len).collect::<Vec<_>>(), [1, 4, 10, 6]);
    // The diagonal is gone: it is where the holes are.
    let last = words.last().unwrap();
    assert!(last.iter().all(|m| m.symbol == "Q" && m.cell.i != m.cell.j));
    let all = backend.words(
        "system s : patch bezier 3\nmodule P\naxiom: P = file \"x\"\nrules:\n  P -> eps\nrun:\n  derive 3\n",
        &[sheet()],
    );
    assert_eq!(all.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0, 0, 0]);
}

fn k13_regular_holes(backend: &Backend) {
    for depth in 0..=4u32 {
        let text = format!(
            "system holes : patch bezier 3\nconst depth: int = {depth}\nmodule P(level: int)\naxiom: P(0) = file \"sheet.bpt\"\nrules:\n  \
             p1: P(level) : level < depth  -> [ P(level+1) P(level+1) ; P(level+1) P(level+1) ]\n  \
             p2: P(level) : level == depth -> [ P(level+1) eps ; eps P(level+1) ]\nrun:\n  derive until terminal max 8\n"
        );
        let words = backend.words(&text, &[sheet()]);
        assert_eq!(words.len() - 1, depth as usize + 1, "then stable");
        let last = words.last().unwrap();
        assert_eq!(last.len(), 2 << (2 * depth), "2·4^max");
        // A chessboard: no two neighbours share an edge, each touches others at corners only.
        assert!(last.iter().all(|m| (m.cell.i + m.cell.j) % 2 == 0 && m.cell.du == depth + 1));
        let idle = backend.words(&text.replace("until terminal max 8", "7"), &[sheet()]);
        assert_eq!(idle.last(), words.last());
    }
}

fn k14_sierpinski(backend: &Backend) {
    let words = backend.words(SIERPINSKI, &[sheet()]);
    let counts: Vec<_> = words.iter().map(|w| of_root(w, 0).len()).collect();
    assert_eq!(counts, [1, 4, 9, 27, 81, 243, 729]);
    for (steps, word) in words.iter().enumerate().skip(2) {
        let word = of_root(word, 0);
        // The pattern of Figure 4: no binary place of (row, column) is (0, 1), as in Pascal's triangle modulo 2.
        let side = 1u64 << steps;
        let mut expected: Vec<_> =
            (0..side).flat_map(|i| (0..side).map(move |j| (i, j))).filter(|(i, j)| j & !i == 0).collect();
        let mut cells = rows_and_columns(&word);
        cells.sort_unstable();
        expected.sort_unstable();
        assert_eq!(cells, expected);
        // B has died out; A fills the first quarter, C and D the lower ones.
        let symbol = |i: u64, j: u64| match (i < side / 2, j < side / 2) {
            (true, _) => "A",
            (false, true) => "C",
            (false, false) => "D",
        };
        assert!(word.iter().all(|m| m.symbol == symbol(m.cell.i, m.cell.j)));
    }
}

/// A Sierpinski triangle on a net of the teapot against tests/golden, made with exact rationals.
fn k14_the_teapot_agrees_with_exact_rationals(backend: &Backend) {
    let golden = include_str!("golden/sierpinski3_teapot5.txt");
    let lines: Vec<&str> = golden.lines().filter(|line| !line.starts_with('#')).collect();
    let blocks: Vec<(&str, Net)> = lines.chunks(5).map(|block| (block[0], golden_net(&block[1..]))).collect();
    let text = SIERPINSKI.replace("  Q = file \"sheet.bpt\"", "").replace("derive 6", "derive 3");
    let words = backend.words(&text, std::slice::from_ref(&blocks[0].1));
    assert_eq!(words[3].len(), blocks.len() - 1);
    for (module, (head, net)) in words[3].iter().zip(&blocks[1..]) {
        let oracle::Cell { du, dv, i, j } = module.cell;
        assert_eq!(format!("{} {du} {dv} {i} {j}", module.symbol), *head);
        for (point, exact) in module.net.points.iter().zip(&net.points) {
            backend.assert_near(*point, *exact);
        }
    }
}

/// Four rows of four points x y z.
fn golden_net(rows: &[&str]) -> Net {
    let numbers = rows.iter().flat_map(|row| row.split_whitespace()).map(|x| x.parse().expect("a number"));
    let numbers: Vec<f64> = numbers.collect();
    Net::new([3, 3], numbers.chunks(3).map(|p| [p[0], p[1], p[2], 1.0]).collect())
}

// --- section 3 ---------------------------------------------------------------------------------

fn k15_the_double_triangle(backend: &Backend) {
    let words = backend.words(SIERPINSKI, &[sheet()]);
    for n in 2..=6u32 {
        let word = &words[n as usize];
        let (first, second) = (of_root(word, 0), of_root(word, 1));
        assert_eq!((first.len(), second.len()), (3usize.pow(n), 3usize.pow(n)));
        // The second is the transpose of the first.
        let mut mirrored: Vec<_> = rows_and_columns(&second).into_iter().map(|(i, j)| (j, i)).collect();
        let mut cells = rows_and_columns(&first);
        mirrored.sort_unstable();
        cells.sort_unstable();
        assert_eq!(cells, mirrored);
        // The diagonal is doubled, with the same nets.
        let nets: HashMap<_, _> = first.iter().map(|m| ((m.cell.i, m.cell.j), &m.net)).collect();
        let doubled: Vec<_> = second.iter().filter(|m| nets.contains_key(&(m.cell.i, m.cell.j))).collect();
        assert_eq!(doubled.len(), 1 << n);
        assert!(doubled.iter().all(|m| m.cell.i == m.cell.j && *nets[&(m.cell.i, m.cell.j)] == m.net));
        assert_eq!(word.len() - doubled.len(), 2 * 3usize.pow(n) - (1 << n));
        if n == 6 {
            assert_eq!((doubled.len(), word.len() - doubled.len()), (64, 1394));
        }
    }
    // On the transposed root the second system makes the transposed nets of the first.
    let turned = backend.words(SIERPINSKI, &[sheet().transposed()]);
    let first: HashMap<_, _> =
        of_root(&words[3], 0).iter().map(|m| ((m.cell.j, m.cell.i), m.net.clone())).collect();
    for module in of_root(&turned[3], 1) {
        assert_eq!(module.net, first[&(module.cell.i, module.cell.j)].transposed());
    }
}

/// Both systems in one alphabet, as printed: the first rule of A always wins, nothing is transposed.
fn e7_e8_one_alphabet_for_both_systems_fails(backend: &Backend) {
    let text = ["A", "B", "C", "D"]
        .iter()
        .fold(SIERPINSKI.to_string(), |text, symbol| text.replace(&format!("{symbol}2"), symbol));
    let text = text.replace("module P, Q, A, B, C, D, A, B, C, D", "module P, Q, A, B, C, D");
    let words = backend.words(&text, &[sheet()]);
    let (first, second) = (of_root(&words[6], 0), of_root(&words[6], 1));
    assert_eq!(rows_and_columns(&first), rows_and_columns(&second));
}

fn k17_roots_are_independent(backend: &Backend) {
    let nets = [sheet(), lattice([3, 3], 5), sheet().transposed()];
    let text = SIERPINSKI.replace("  Q = file \"sheet.bpt\"", "");
    let together = backend.words(&text, &nets);
    for (root, net) in nets.iter().enumerate() {
        let alone = backend.words(&text, std::slice::from_ref(net));
        for (step, word) in alone.iter().enumerate() {
            let renamed = word.iter().map(|m| Seen { root, ..m.clone() });
            let here = of_root(&together[step], root);
            assert!(renamed.eq(here.into_iter().cloned()), "step {step}");
        }
    }
    // The word is the roots' words, one after the other.
    assert!(together.iter().all(|word| word.is_sorted_by_key(|m| m.root)));
}

// --- who answers -------------------------------------------------------------------------------

#[test]
fn the_oracle_gives_the_papers_numbers() {
    let derive = |text: &str, nets: &[Net]| oracle::derive(text, nets).iter().map(seen_by_oracle).collect();
    let backend = Backend { derive: &derive, tolerance: 1e-13 };
    DERIVED.iter().for_each(|check| check(&backend));
}

/// The same numbers survive the engine's containers, so the checks ask nothing that f32 cannot give.
#[test]
fn the_papers_numbers_fit_into_f32() {
    let derive = |text: &str, nets: &[Net]| {
        let words = oracle::derive(text, nets);
        words.iter().enumerate().map(|(step, w)| seen_by_engine(&oracle::engine_word(w, step))).collect()
    };
    let backend = Backend { derive: &derive, tolerance: 1e-6 };
    DERIVED.iter().for_each(|check| check(&backend));
}
