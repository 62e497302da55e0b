//! The numbers of "L-system Description of Subdivision Curves", by requirement, and those of other
//! sources whose systems are curves.
//!
//! Each check takes a [`Backend`], so that the oracle and an engine answer to the same numbers.

use super::{Job, Seen, see};
use crate::oracle::Param;
use std::collections::HashSet;

/// Something that derives words.
pub struct Backend<'a> {
    /// The word after every step, index 0 the axiom.
    pub derive: &'a dyn Fn(&Job) -> Vec<Seen>,
    /// How far a coordinate of size 1 may be off.
    pub tolerance: f64,
}

/// The oracle as a backend.
pub fn oracle() -> Backend<'static> {
    Backend { derive: &|job| job.derive().iter().map(see).collect(), tolerance: 1e-12 }
}

type Point = Vec<f64>;

impl Backend<'_> {
    fn words(&self, job: &Job) -> Vec<Seen> {
        (self.derive)(job)
    }

    /// The points of every word.
    fn points(&self, job: &Job) -> Vec<Vec<Point>> {
        self.words(job).iter().map(points).collect()
    }

    /// The points of the last word.
    fn last(&self, job: &Job) -> Vec<Point> {
        points(self.words(job).last().expect("an axiom"))
    }

    /// `size` is that of the numbers that went into them.
    fn near(&self, a: &[Point], b: &[Point], size: f64) -> bool {
        let close = |(p, q): (&Point, &Point)| {
            p.len() == q.len() && p.iter().zip(q).all(|(x, y)| (x - y).abs() <= self.tolerance * size)
        };
        a.len() == b.len() && a.iter().zip(b).all(close)
    }

    #[track_caller]
    fn assert_near(&self, a: &[Point], b: &[Point]) {
        let size = a.iter().chain(b).flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
        assert!(self.near(a, b, size), "{a:?}\nand\n{b:?}");
    }
}

/// The first vector of each module.
fn points(word: &Seen) -> Vec<Point> {
    let point = |params: &Vec<Param>| {
        let vector = params.iter().find(|p| p.floats().len() > 1).expect("a point");
        vector.floats().to_vec()
    };
    word.modules.iter().map(|m| point(&m.params)).collect()
}

fn symbols(word: &Seen) -> String {
    word.modules.iter().map(|m| m.symbol.as_str()).collect::<Vec<_>>().join(" ")
}

/// A list of checks with their names, and a test of the oracle for each.
macro_rules! checks {
    ($(#[$doc:meta])* $list:ident, $tests:ident: $($check:ident),* $(,)?) => {
        $(#[$doc])*
        pub const $list: &[(&str, fn(&Backend))] = &[$((stringify!($check), $check)),*];

        mod $tests {
            $(#[test]
            fn $check() {
                let named = |(name, _): &&(&str, _)| *name == stringify!($check);
                let (_, check) = super::$list.iter().find(named).expect("a check of that name");
                check(&super::oracle());
            })*
        }
    };
}

checks! {
    /// The checks whose systems are rings or open words.
    LINES, lines:
    s2_s5_closed_chaikin_is_the_matrix,
    s3_all_reads_see_the_old_word,
    s4_contexts_and_parameters,
    s6_the_square,
    s7_s8_shifts_turn_the_ring,
    s10_cubic,
    s11_four_points,
    s12_one_polygon,
    s13_s14_s15_open_chaikin,
    s15_clamped_quadratic_spline,
    s17_lines_and_quadratics,
    s17_s10_limits_are_splines,
    s18_reverse_is_the_inverse,
    s19_phases_differ,
    s22_koch_by_points,
    e10_three_points,
    e12_counts_of_the_leaf,
    e14_rings_shorter_than_contexts,
    files_of_schemes,
}

checks! {
    /// The checks that trace.
    TRACED, traced:
    s20_kolam,
    s22_koch_and_dragon,
    hilbert_fills_the_cube,
}

checks! {
    /// The checks whose words are trees.
    TREES, trees:
    s21_a_branching_structure,
    contexts_skip_branches,
    signals_run_up_and_down,
    hogeweg_and_hesper,
}

// --- inputs ------------------------------------------------------------------------------------

/// A polygon of small integers, without symmetry.
fn polygon(n: usize) -> Vec<Point> {
    let point = |i: usize| {
        vec![((7 * i * i + 3 * i) % 31) as f64 - 15.0, ((11 * i * i * i + 5 * i) % 29) as f64 - 14.0]
    };
    (0..n).map(point).collect()
}

fn ring(rules: &str, steps: usize, points: &[Point]) -> Job {
    scheme("ring", rules, steps, points)
}

fn open(rules: &str, steps: usize, points: &[Point]) -> Job {
    scheme("open", rules, steps, points)
}

fn scheme(topology: &str, rules: &str, steps: usize, points: &[Point]) -> Job {
    let n = points.first().map_or(2, Vec::len);
    Job::new(format!(
        "system s : curve {topology}\nmodule P(v: vec{n})\naxiom: file \"points.csv\"\nrules:\n\
            {rules}run:\n  derive {steps}\n"
    ))
    .points(points)
}

const CHAIKIN: &str = "  P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\n";
const CUBIC: &str = "  P(vl) < P(v) > P(vr) -> P(1/8*vl + 3/4*v + 1/8*vr) P(1/2*v + 1/2*vr)\n";
const DLG: &str = "  P(vl) < P(v) > P(vr) P(vrr) -> P(v) P(-1/16*vl + 9/16*v + 9/16*vr - 1/16*vrr)\n";

/// A row of a cyclic matrix: offsets and weights.
type Row<'a> = &'a [(i64, f64)];

/// The product with the cyclic matrix that has these rows for each column.
fn product(points: &[Point], rows: &[Row]) -> Vec<Point> {
    let n = points.len() as i64;
    let at = |i: i64, row: Row| {
        let term =
            |axis: usize| row.iter().map(|(o, w)| w * points[(i + o).rem_euclid(n) as usize][axis]).sum();
        (0..points[0].len()).map(term).collect()
    };
    (0..n).flat_map(|i| rows.iter().map(move |row| (i, *row))).map(|(i, row)| at(i, row)).collect()
}

const CHAIKIN_ROWS: [Row; 2] = [&[(-1, 0.25), (0, 0.75)], &[(0, 0.75), (1, 0.25)]];

fn rotated(points: &[Point], by: i64) -> Vec<Point> {
    let mut points = points.to_vec();
    let by = by.rem_euclid(points.len() as i64) as usize;
    points.rotate_left(by);
    points
}

fn distance(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

// --- closed curves -----------------------------------------------------------------------------

/// Rows 2i−1: ¼P(i−1) + ¾P(i); 2i: ¾P(i) + ¼P(i+1), around the ring.
fn s2_s5_closed_chaikin_is_the_matrix(backend: &Backend) {
    for n in 3..9 {
        let words = backend.points(&ring(CHAIKIN, 4, &polygon(n)));
        assert_eq!(words[0], polygon(n));
        for pair in words.windows(2) {
            assert_eq!(pair[1].len(), 2 * pair[0].len());
            backend.assert_near(&pair[1], &product(&pair[0], &CHAIKIN_ROWS));
        }
    }
}

/// Every module is rewritten once, contexts overlap, and none sees what a neighbour becomes.
fn s3_all_reads_see_the_old_word(backend: &Backend) {
    let job = Job::new(
        "system s : curve ring\nmodule A(n: int)\naxiom: A(1) A(2) A(4) A(8) A(16)\n\
         rules:\n  A(a) A(b) < A(n) > A(c) -> A(a + 10*b + 100*n + 1000*c)\n",
    );
    let words = backend.words(&job);
    let of = |a: i32, b: i32, n: i32, c: i32| Param::Int(a + 10 * b + 100 * n + 1000 * c);
    let all: Vec<Param> = words[1].modules.iter().map(|m| m.params[0]).collect();
    let expected = [of(8, 16, 1, 2), of(16, 1, 2, 4), of(1, 2, 4, 8), of(2, 4, 8, 16), of(4, 8, 16, 1)];
    assert_eq!(all, expected);
}

/// Equations 9 to 12.
fn s4_contexts_and_parameters(backend: &Backend) {
    let job = Job::new(
        "system s : curve open\nmodule A(x: float), B(x: float, y: float)\n\
            axiom: A(1.5) B(2, 3) A(4.5)\nrules:\n  \
         A(x) -> A(2*x + 1)\n  A(w) < B(x, y) > A(z) -> A(w + x) A(y + z)\n",
    );
    let words = backend.words(&job);
    let params: Vec<Vec<Param>> = words[1].modules.iter().map(|m| m.params.clone()).collect();
    assert_eq!(symbols(&words[1]), "A A A A");
    assert_eq!(params, [4.0, 3.5, 7.5, 10.0].map(|x| vec![Param::Float(x)]));
}

/// The program of section 4: 32 points.
fn s6_the_square(backend: &Backend) {
    let file = include_str!("../../data/language/chaikin.burgeon");
    let words = backend.points(&Job::new(file));
    assert_eq!(words.iter().map(Vec::len).collect::<Vec<_>>(), [4, 8, 16, 32]);
    let square = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|p| p.to_vec()).to_vec();
    let expected = (0..3).fold(square, |points, _| product(&points, &CHAIKIN_ROWS));
    backend.assert_near(&words[3], &expected);
    // Of the first corner: ¼(1, 0) + ¾(0, 0) and ¾(0, 0) + ¼(0, 1).
    assert_eq!(words[1][..2], [vec![0.25, 0.0], vec![0.0, 0.25]]);
}

/// Children of P(i) are the new points 2i−1+d and 2i+d: one ring, turned by d, then 2d + d, …
fn s7_s8_shifts_turn_the_ring(backend: &Backend) {
    let productions = [
        (-1, "  P(vl) < P(v) -> P(3/4*vl + 1/4*v) P(1/4*vl + 3/4*v)\n"),
        (1, "  P(v) > P(vr) -> P(3/4*v + 1/4*vr) P(1/4*v + 3/4*vr)\n"),
        (3, "  P(v) > P(vr) P(vrr) -> P(3/4*vr + 1/4*vrr) P(1/4*vr + 3/4*vrr)\n"),
    ];
    for n in [4, 5, 8] {
        let plain = backend.points(&ring(CHAIKIN, 3, &polygon(n)));
        for (d, rules) in productions {
            let shifted = backend.points(&ring(rules, 3, &polygon(n)));
            let mut turn = 0;
            for (a, b) in plain.iter().zip(&shifted) {
                backend.assert_near(b, &rotated(a, turn));
                turn = 2 * turn + d;
            }
        }
    }
    // The groups of the file are these productions.
    let file = include_str!("../../data/language/chaikin.burgeon");
    let plain = backend.last(&Job::new(file));
    for (group, turn) in [("left", -7), ("right", 7), ("far", 21)] {
        let text = file.replace("derive 3", &format!("derive 3 with {group}"));
        backend.assert_near(&backend.last(&Job::new(text)), &rotated(&plain, turn));
    }
}

fn s10_cubic(backend: &Backend) {
    let shifted = "  P(vl) < P(v) > P(vr) -> P(1/2*vl + 1/2*v) P(1/8*vl + 3/4*v + 1/8*vr)\n";
    let rows: [Row; 2] = [&[(-1, 0.125), (0, 0.75), (1, 0.125)], &[(0, 0.5), (1, 0.5)]];
    for n in [3, 4, 7] {
        let (a, b) =
            (backend.points(&ring(CUBIC, 3, &polygon(n))), backend.points(&ring(shifted, 3, &polygon(n))));
        let mut turn = 0;
        for step in 0..4 {
            backend.assert_near(&b[step], &rotated(&a[step], turn));
            turn = 2 * turn - 1;
            if step > 0 {
                backend.assert_near(&a[step], &product(&a[step - 1], &rows));
            }
        }
    }
    // One point of a ring of zeros: the mask (1, 4, 6, 4, 1)/8.
    let mut unit = vec![vec![0.0, 0.0]; 8];
    unit[3][0] = 1.0;
    let spread: Vec<f64> = backend.last(&ring(CUBIC, 1, &unit)).iter().map(|p| 8.0 * p[0]).collect();
    assert_eq!(spread[4..9], [1.0, 4.0, 6.0, 4.0, 1.0]);
    assert_eq!(spread.iter().sum::<f64>(), 16.0);
    let file = include_str!("../../data/language/cubic.burgeon");
    let job = Job::new(file).points(&polygon(5));
    backend.assert_near(&backend.last(&job), &backend.last(&ring(CUBIC, 4, &polygon(5))));
}

fn s11_four_points(backend: &Backend) {
    let shifted = "  P(vll) P(vl) < P(v) > P(vr) -> P(-1/16*vll + 9/16*vl + 9/16*v - 1/16*vr) P(v)\n";
    let (a, b) = (backend.points(&ring(DLG, 3, &polygon(7))), backend.points(&ring(shifted, 3, &polygon(7))));
    let mut turn = 0;
    for (a, b) in a.iter().zip(&b) {
        backend.assert_near(b, &rotated(a, turn));
        turn = 2 * turn - 1;
    }
    // Interpolation is exact for cubics: where the four points are on one, so is the new one.
    let graph = |f: fn(f64) -> f64| (0..12).map(|i| vec![f64::from(i), f(f64::from(i))]).collect::<Vec<_>>();
    let off = |f: fn(f64) -> f64| {
        let refined = backend.last(&ring(DLG, 1, &graph(f)));
        // Beyond, the ring closes.
        let inner = refined[2..=18].iter();
        inner.map(|p| (p[1] - f(p[0])).abs()).fold(0.0, f64::max)
    };
    let size = 12f64.powi(3);
    let cubics: [fn(f64) -> f64; 4] = [|_| 1.0, |x| x, |x| x * x, |x| x * (x - 3.0) * (x - 7.0)];
    for cubic in cubics {
        assert!(off(cubic) <= backend.tolerance * size, "{}", off(cubic));
    }
    // What is left is the leading coefficient times (x−½)(x−3/2)(x+½)(x+3/2), at 0 9/16.
    let quartic = off(|x| x * x * (x - 5.0) * (x - 5.0) / 16.0);
    assert!((quartic - 9.0 / 256.0).abs() < 1e-3, "{quartic}");
}

/// Figures 6 and 7: the new polygons of Chaikin and of the cubic stay in the hull, those of DLG go
/// through all old points.
fn s12_one_polygon(backend: &Backend) {
    let polygon = polygon(7);
    let support = |points: &[Point], angle: f64| {
        let (sin, cos) = angle.sin_cos();
        points.iter().map(|p| p[0] * cos + p[1] * sin).fold(f64::MIN, f64::max)
    };
    let stays = |rules: &str| {
        let words = backend.points(&ring(rules, 5, &polygon));
        (0..90).map(|k| f64::from(k) * 0.07).all(|a| {
            words.windows(2).all(|w| support(&w[1], a) <= support(&w[0], a) + 20.0 * backend.tolerance)
        })
    };
    assert!(stays(CHAIKIN) && stays(CUBIC) && !stays(DLG));
    let words = backend.points(&ring(DLG, 5, &polygon));
    assert_eq!(words[5].len(), 7 * 32);
    for pair in words.windows(2) {
        let kept: Vec<Point> = pair[1].iter().step_by(2).cloned().collect();
        assert_eq!(kept, pair[0]);
    }
    let file = include_str!("../../data/language/dlg.burgeon");
    let in_space: Vec<Point> = polygon.iter().map(|p| vec![p[0], p[1], 0.0]).collect();
    let words = backend.points(&Job::new(file).points(&in_space));
    backend.assert_near(&words[5], &backend.last(&ring(DLG, 5, &in_space)));
    // Without its parameter it cuts no corner and adds midpoints.
    let straight = backend.points(&Job::new(file).points(&in_space).set("w", Param::Float(0.0)));
    let rows: [Row; 2] = [&[(0, 1.0)], &[(0, 0.5), (1, 0.5)]];
    backend.assert_near(&straight[1], &product(&in_space, &rows));
}

// --- open curves -------------------------------------------------------------------------------

/// Equations 34 to 36.
const OPEN: &str = "  # P(vl) < P(v) > P(vr)   -> P(1/2*vl + 1/2*v) P(3/4*v + 1/4*vr)\n    \
                    P(vl) < P(v) > P(vr) # -> P(1/4*vl + 3/4*v) P(1/2*v + 1/2*vr)\n    \
                    P(vl) < P(v) > P(vr)   -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\n";
/// Equations 28 to 33.
const OPEN_IN_FULL: &str = "  # < P(v) -> P(v)\n\
    # P(vl) < P(v) > P(vr) -> P(1/2*vl + 1/2*v) P(3/4*v + 1/4*vr)\n  \
     P(vll) P(vl) < P(v) > P(vr) P(vrr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\n  \
     P(vl) < P(v) > P(vr) # -> P(1/4*vl + 3/4*v) P(1/2*v + 1/2*vr)\n  P(v) > # -> P(v)\n  # -> #\n";

/// The matrix of equation 27: [1], [½ ½], then pairs [¾ ¼], [¼ ¾] on inner edges, [½ ½], [1].
fn open_matrix(points: &[Point]) -> Vec<Point> {
    let n = points.len();
    let mix = |a: f64, i: usize, b: f64, j: usize| {
        points[i].iter().zip(&points[j]).map(|(x, y)| a * x + b * y).collect::<Point>()
    };
    let mut rows = vec![points[0].clone(), mix(0.5, 0, 0.5, 1)];
    for i in 1..n - 2 {
        rows.extend([mix(0.75, i, 0.25, i + 1), mix(0.25, i, 0.75, i + 1)]);
    }
    rows.extend([mix(0.5, n - 2, 0.5, n - 1), points[n - 1].clone()]);
    rows
}

fn s13_s14_s15_open_chaikin(backend: &Backend) {
    for n in 4..9 {
        let words = backend.points(&open(OPEN, 4, &polygon(n)));
        for pair in words.windows(2) {
            assert_eq!(pair[1].len(), 2 * pair[0].len() - 2);
            backend.assert_near(&pair[1], &open_matrix(&pair[0]));
            assert_eq!((&pair[1][0], pair[1].last()), (&pair[0][0], pair[0].last()));
        }
        let full = backend.points(&open(OPEN_IN_FULL, 4, &polygon(n)));
        words.iter().zip(&full).for_each(|(a, b)| backend.assert_near(a, b));
    }
    let words = backend.points(&Job::new(include_str!("../../data/language/chaikin_open.burgeon")));
    assert_eq!(words.iter().map(Vec::len).collect::<Vec<_>>(), [4, 6, 10, 18, 34, 66]);
    backend.assert_near(&words[5], &(0..5).fold(words[0].clone(), |points, _| open_matrix(&points)));
}

/// The clamped quadratic B-spline with these control points, all knots 1 apart but the triple ends;
/// t in 0 … n − 2.
fn clamped_quadratic(points: &[Point], t: f64) -> Point {
    let spans = points.len() - 2;
    let span = (t.floor() as usize).min(spans - 1);
    let knot = |i: i64| i.clamp(0, spans as i64) as f64;
    // De Boor: three points, two rounds.
    let mut d: Vec<Point> = points[span..span + 3].to_vec();
    for round in 1..=2i64 {
        for j in (round as usize..=2).rev() {
            let left = knot(span as i64 + j as i64 - 2);
            let right = knot(span as i64 + j as i64 + 1 - round);
            let a = (t - left) / (right - left);
            d[j] = d[j - 1].iter().zip(&d[j]).map(|(x, y)| (1.0 - a) * x + a * y).collect();
        }
    }
    d[2].clone()
}

/// The rules insert the midpoints of all knots, so the curve stays what it was.
fn s15_clamped_quadratic_spline(backend: &Backend) {
    for n in [3, 4, 5, 9] {
        // With three points it takes the rule that the paper leaves out.
        let rules = format!("  # P(vl) < P(v) > P(vr) # -> P(1/2*vl + 1/2*v) P(1/2*v + 1/2*vr)\n{OPEN}");
        let words = backend.points(&open(&rules, 3, &polygon(n)));
        for (step, word) in words.iter().enumerate() {
            let finer = 2f64.powi(step as i32);
            for k in 0..=40 {
                let t = (n - 2) as f64 * f64::from(k) / 40.0;
                let (a, b) = (clamped_quadratic(&words[0], t), clamped_quadratic(word, t * finer));
                backend.assert_near(&[a], &[b]);
            }
        }
    }
}

fn s17_lines_and_quadratics(backend: &Backend) {
    let graph = |f: fn(f64) -> f64| (0..9).map(|i| vec![f64::from(i), f(f64::from(i))]).collect::<Vec<_>>();
    let inner = |f: fn(f64) -> f64| {
        let refined = backend.last(&open(CHAIKIN, 1, &graph(f)));
        // The ends keep themselves.
        refined[1..refined.len() - 1].to_vec()
    };
    for (k, point) in inner(|x| 2.0 * x - 3.0).iter().enumerate() {
        assert_eq!(point[1], 2.0 * point[0] - 3.0);
        // The new spacing is one half.
        assert_eq!(point[0], 0.75 + 0.5 * k as f64);
    }
    // A parabola goes to a parabola, 3/16 above: generated, not reproduced.
    assert!(inner(|x| x * x).iter().all(|p| p[1] - p[0] * p[0] == 3.0 / 16.0));
    let mut unit = vec![vec![0.0, 0.0]; 6];
    unit[2][0] = 1.0;
    let mask: Vec<f64> = backend.last(&ring(CHAIKIN, 1, &unit)).iter().map(|p| 4.0 * p[0]).collect();
    assert_eq!(mask[3..7], [1.0, 3.0, 3.0, 1.0]);
}

/// Of the control points of a uniform periodic B-spline, the greatest distance from the curve at
/// their own parameters; `at` gives the parameter of a point.
fn off_spline(word: &[Point], first: &[Point], basis: fn(f64) -> f64, at: impl Fn(usize) -> f64) -> f64 {
    let n = first.len() as i64;
    let curve = |t: f64| {
        let near = t.round() as i64;
        let term = |axis: usize| {
            let weighted = |i: i64| basis(t - i as f64) * first[i.rem_euclid(n) as usize][axis];
            (near - 3..=near + 3).map(weighted).sum()
        };
        (0..2).map(term).collect::<Point>()
    };
    word.iter().enumerate().map(|(j, p)| distance(p, &curve(at(j)))).fold(0.0, f64::max)
}

fn quadratic(t: f64) -> f64 {
    match t.abs() {
        t if t <= 0.5 => 0.75 - t * t,
        t if t <= 1.5 => 0.5 * (1.5 - t) * (1.5 - t),
        _ => 0.0,
    }
}

fn cubic(t: f64) -> f64 {
    match t.abs() {
        t if t <= 1.0 => 2.0 / 3.0 - t * t + 0.5 * t * t * t,
        t if t <= 2.0 => (2.0 - t).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// Limits are the uniform quadratic and cubic B-splines; the greatest error falls to 1/16 in two steps.
fn s17_s10_limits_are_splines(backend: &Backend) {
    let first = polygon(7);
    let chaikin = backend.points(&ring(CHAIKIN, 6, &first));
    let splines = backend.points(&ring(CUBIC, 6, &first));
    let errors = |words: &[Vec<Point>], basis: fn(f64) -> f64, start: fn(f64) -> f64| -> Vec<f64> {
        let off = |(step, word): (usize, &Vec<Point>)| {
            let finer = 2f64.powi(step as i32);
            // Point 0 lies at the parameter `start`, the others follow at equal distances.
            off_spline(word, &first, basis, |j| start(finer) + j as f64 / finer)
        };
        words.iter().enumerate().map(off).collect()
    };
    // Chaikin's children lie ¼ of the spacing before and behind; the cubic's at it and ½ behind.
    let of_chaikin = errors(&chaikin, quadratic, |finer| 0.5 / finer - 0.5);
    let of_cubic = errors(&splines, cubic, |_| 0.0);
    for errors in [of_chaikin, of_cubic] {
        assert!(errors[0] > 1.0, "{errors:?}");
        for pair in errors.windows(3) {
            let slack = 1e3 * backend.tolerance + 1e-9 * pair[0];
            assert!((pair[0] - 16.0 * pair[2]).abs() <= slack, "{errors:?}");
        }
    }
}

// --- reverse subdivision -----------------------------------------------------------------------

const REVERSE: &str = "  P(vl) < P(va) P(vb) > P(vr) -> P(-1/4*vl + 3/4*va + 3/4*vb - 1/4*vr)\n";

fn s18_reverse_is_the_inverse(backend: &Backend) {
    for n in [3, 4, 8, 11] {
        let forward = backend.points(&ring(CHAIKIN, 4, &polygon(n)));
        let back = backend.points(&ring(REVERSE, 4, &forward[4]));
        for (a, b) in forward.iter().rev().zip(&back) {
            // Small integers and quarters: nothing is rounded.
            assert_eq!(a, b);
        }
    }
    let forward = backend.points(&ring(CHAIKIN, 4, &polygon(5)));
    let job = Job::new(include_str!("../../data/language/unchaikin.burgeon")).points(&forward[4]);
    assert_eq!(backend.last(&job), polygon(5));
    // Strict predecessors partition the word: what one takes no other takes.
    let job = Job::new(
        "system s : curve open\nmodule A(n: int), B(a: int, b: int)\naxiom: A(1) A(2) A(3) A(4) A(5)\n\
         rules:\n  A(a) A(b) -> B(a, b)\n",
    );
    let word = backend.words(&job).pop().expect("a word");
    assert_eq!(symbols(&word), "B B A");
    assert_eq!(word.modules[1].params, [Param::Int(3), Param::Int(4)]);
}

/// Circular permutations give other, valid, results; an even one the same, turned.
fn s19_phases_differ(backend: &Backend) {
    let points = polygon(16);
    let file = include_str!("../../data/language/unchaikin.burgeon").replace("derive 4", "derive 1");
    let phase = |k: i32| backend.last(&Job::new(&file).points(&points).set("phase", Param::Int(k)));
    let (zero, one) = (phase(0), phase(1));
    assert_eq!((zero.len(), one.len()), (8, 8));
    let turned = |a: &[Point], b: &[Point]| (0..8).any(|by| rotated(a, by) == b);
    assert!(!turned(&zero, &one));
    assert_eq!(phase(2), rotated(&zero, 1));
    assert_eq!(phase(5), rotated(&one, 2));
    let reverse = |points: Vec<Point>| backend.last(&ring(REVERSE, 1, &points));
    assert_eq!(one, reverse(rotated(&points, 1)));
}

fn counts(backend: &Backend, job: &Job) -> Vec<usize> {
    backend.words(job).iter().map(|w| w.modules.len()).collect()
}

/// Reading E12: pairs from left to right, a leftover kept.
fn e12_counts_of_the_leaf(backend: &Backend) {
    let leaf: Vec<Point> = (0..1925).map(|i| vec![f64::from(i % 44), f64::from(i / 44)]).collect();
    assert_eq!(counts(backend, &ring(REVERSE, 4, &leaf)), [1925, 963, 482, 241, 121]);
    assert_eq!(counts(backend, &open(REVERSE, 4, &leaf)), [1925, 964, 483, 243, 123]);
    // The leftover is the ring's last point, unchanged.
    let words = backend.points(&ring(REVERSE, 1, &leaf));
    assert_eq!(words[1].last(), leaf.last());
}

/// Reading E10: with a rule of its own the middle of three points is treated alike on both sides.
fn e10_three_points(backend: &Backend) {
    let three = polygon(3);
    let first = "  # P(vl) < P(v) > P(vr) # -> P(1/2*vl + 1/2*v) P(1/2*v + 1/2*vr)\n";
    let middle = |a: usize, b: usize| -> Point {
        three[a].iter().zip(&three[b]).map(|(x, y)| 0.5 * x + 0.5 * y).collect()
    };
    let word = backend.last(&open(&format!("{first}{OPEN}"), 1, &three));
    assert_eq!(word, [three[0].clone(), middle(0, 1), middle(1, 2), three[2].clone()]);
    // Without it the first rule wins, and the word is not symmetric.
    let word = backend.last(&open(OPEN, 1, &three));
    assert_eq!(word[1], middle(0, 1));
    assert_ne!(word[2], middle(1, 2));
}

/// Reading E14: contexts wrap modulo n; alone, a point is its own neighbour.
fn e14_rings_shorter_than_contexts(backend: &Backend) {
    let rows: [Row; 2] = [&[(0, 1.0)], &[(-1, -0.0625), (0, 0.5625), (1, 0.5625), (2, -0.0625)]];
    for n in 1..5 {
        let words = backend.points(&ring(DLG, 3, &polygon(n)));
        words.windows(2).for_each(|w| backend.assert_near(&w[1], &product(&w[0], &rows)));
        let words = backend.points(&ring(CHAIKIN, 3, &polygon(n)));
        words.windows(2).for_each(|w| backend.assert_near(&w[1], &product(&w[0], &CHAIKIN_ROWS)));
    }
    // Eight deep, seen around a ring of three.
    let names: Vec<String> = (0..8).map(|i| format!("A(a{i})")).collect();
    let (context, sum) = (names.join(" "), "a0 + 2*a1 + 4*a2 + 8*a3 + 16*a4 + 32*a5 + 64*a6 + 128*a7");
    for (rule, offset) in [(format!("{context} < A(n)"), -8i64), (format!("A(n) > {context}"), 1)] {
        let job = Job::new(format!(
            "system s : curve ring\nmodule A(n: int)\naxiom: A(1) A(10) A(100)\nrules:\n\
                {rule} -> A({sum} + 100000*n)\n"
        ));
        let word = backend.words(&job).pop().expect("a word");
        for (i, module) in word.modules.iter().enumerate() {
            let at = |k: i64| [1, 10, 100][(i as i64 + k).rem_euclid(3) as usize];
            let expected = (0..8).map(|k| at(offset + k) << k).sum::<i32>() + 100_000 * at(0);
            assert_eq!(module.params, [Param::Int(expected)]);
        }
    }
    // A pair and its contexts in a ring of two.
    let job = Job::new(
        "system s : curve ring\nmodule A(n: int)\naxiom: A(1) A(10)\nrules:\n\
            A(l) < A(a) A(b) > A(r) -> A(l + 2*a + 3*b + 4*r)\n",
    );
    assert_eq!(backend.words(&job)[1].modules[0].params, [Param::Int(10 + 2 + 30 + 4)]);
}

// --- more schemes ------------------------------------------------------------------------------

/// The Bézier curve with these control points.
fn bezier(points: &[Point], t: f64) -> Point {
    let mut points = points.to_vec();
    while points.len() > 1 {
        let between = |w: &[Point]| w[0].iter().zip(&w[1]).map(|(a, b)| (1.0 - t) * a + t * b).collect();
        points = points.windows(2).map(between).collect();
    }
    points.remove(0)
}

fn files_of_schemes(backend: &Backend) {
    // Degree elevation: the curve stays.
    let job = Job::new(include_str!("../../data/language/elevate.burgeon"));
    for (job, exact) in [(job.clone(), 5), (job.system("elevate"), 1)] {
        let words = backend.points(&job);
        assert_eq!(words.iter().map(Vec::len).collect::<Vec<_>>(), [4, 5, 6, 7, 8]);
        // The first system divides ints, which truncates: it only doubles the last point.
        for word in &words[..exact] {
            for t in [0.0, 0.1, 0.5, 0.9, 1.0] {
                backend.assert_near(&[bezier(word, t)], &[bezier(&words[0], t)]);
            }
        }
    }
    // Lane and Riesenfeld: degree 2 is Chaikin, degree 3 the cubic, up to rotation.
    let lr = include_str!("../../data/language/lane_riesenfeld.burgeon");
    for (k, rules) in [(2, CHAIKIN), (3, CUBIC)] {
        let job = Job::new(lr)
            .system("lr")
            .points(&polygon(6))
            .set("k", Param::Int(k))
            .set("levels", Param::Int(2));
        let word = backend.last(&job);
        let other = backend.last(&ring(rules, 2, &polygon(6)));
        assert!((0..24).any(|by| backend.near(&rotated(&other, by), &word, 16.0)), "degree {k}");
    }
    assert_eq!(counts(backend, &Job::new(lr).points(&polygon(9))), open_averages(9));
    // The four-point scheme on an open word keeps what it has and puts one between each two.
    let file = include_str!("../../data/language/four_point_open.burgeon");
    let in_space = |n| polygon(n).iter().map(|p: &Point| vec![p[0], p[1], 0.0]).collect::<Vec<_>>();
    for n in [2, 3, 4, 8] {
        let words = backend.points(&Job::new(file).points(&in_space(n)));
        for pair in words.windows(2) {
            assert_eq!(pair[1].iter().step_by(2).cloned().collect::<Vec<_>>(), pair[0]);
            assert_eq!(pair[1].len(), 2 * pair[0].len() - 1);
        }
    }
    // The ternary scheme reproduces parabolas.
    let file = include_str!("../../data/language/ternary.burgeon").replace("derive 4", "derive 1");
    let parabola: Vec<Point> = (0..9).map(|i| vec![f64::from(i), f64::from(i * i), 0.0]).collect();
    let word = backend.last(&Job::new(file).points(&parabola));
    assert_eq!(word.len(), 27);
    let on = word[3..=21].iter().map(|p| vec![p[0], p[0] * p[0], 0.0]).collect::<Vec<_>>();
    backend.assert_near(&word[3..=21], &on);
    assert!((word[4][0] - 4.0 / 3.0).abs() < 10.0 * backend.tolerance);
}

/// Each round doubles the points and takes one off three times.
fn open_averages(n: usize) -> Vec<usize> {
    let mut counts = vec![n];
    for _ in 0..4 {
        let doubled = 2 * counts.last().expect("a count");
        counts.extend((0..4).map(|k| doubled - k));
    }
    counts
}

// --- fractals and the turtle -------------------------------------------------------------------

/// Twice the signed area of a closed polygon.
fn double_area(points: &[Point]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum()
}

/// Edges of a ring.
fn lengths(points: &[Point]) -> Vec<f64> {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(p, q)| distance(p, q)).collect()
}

/// No index is needed: each edge is replaced as seen from its first point.
fn s22_koch_by_points(backend: &Backend) {
    let job = Job::new(include_str!("../../data/language/koch.burgeon")).system("koch_points");
    let words = backend.points(&job);
    for (n, word) in words.iter().enumerate() {
        assert_eq!(word.len(), 3 << (2 * n));
    }
    for pair in words.windows(2) {
        // Four edges of a third, and a triangle on each: here to the left, which is inside.
        let bumps: f64 = lengths(&pair[0]).iter().map(|l| 3f64.sqrt() / 36.0 * l * l).sum();
        let lost = 0.5 * (double_area(&pair[0]) - double_area(&pair[1]));
        assert!((lost - bumps).abs() <= 10.0 * backend.tolerance, "{lost} {bumps}");
        let quartered: Vec<f64> = lengths(&pair[0]).iter().flat_map(|l| [l / 3.0; 4]).collect();
        let all =
            lengths(&pair[1]).iter().zip(&quartered).all(|(a, b)| (a - b).abs() <= 10.0 * backend.tolerance);
        assert!(all);
    }
}

fn on_lattice(points: &[Point]) -> HashSet<Vec<i64>> {
    let cell = |p: &Point| p.iter().map(|x| x.round() as i64).collect::<Vec<_>>();
    for p in points {
        assert!(p.iter().all(|x| (x - x.round()).abs() < 1e-2), "{p:?}");
    }
    points.iter().map(cell).collect()
}

fn s22_koch_and_dragon(backend: &Backend) {
    let koch = include_str!("../../data/language/koch.burgeon");
    let words = backend.words(&Job::new(koch).system("koch_turtle"));
    // Four derivations and the trace.
    assert_eq!(words.len(), 6);
    let snowflake = points(&words[5]);
    assert_eq!(snowflake.len(), 3 << 8);
    assert!(lengths(&snowflake).iter().all(|l| (l - 1.0).abs() <= 100.0 * backend.tolerance));
    // A0 (8/5 − 3/5 (4/9)^n), A0 that of a triangle with sides of 3^n; clockwise, so negative.
    let area = 3f64.sqrt() / 4.0 * 9f64.powi(4) * (1.6 - 0.6 * (4.0f64 / 9.0).powi(4));
    assert!((double_area(&snowflake) / 2.0 + area).abs() <= 1e4 * area * backend.tolerance);
    let words = backend.words(&Job::new(koch));
    assert_eq!(words[4].modules.len(), 3 * 256 + 4 + 4 * (3 + 12 + 48 + 192));
    let thin = words[4]
        .modules
        .iter()
        .filter(|m| m.symbol == "F")
        .all(|m| (m.params[0].floats()[0] - 1.0 / 81.0).abs() <= backend.tolerance);
    assert!(thin);

    let dragon = include_str!("../../data/language/dragon.burgeon");
    let curve = backend.last(&Job::new(dragon).system("dragon"));
    assert_eq!(curve.len(), 1025);
    on_lattice(&curve);
    // No edge is walked twice.
    let edge =
        |w: &[Point]| -> Vec<i64> { w[0].iter().zip(&w[1]).map(|(a, b)| (a + b).round() as i64).collect() };
    assert_eq!(curve.windows(2).map(edge).collect::<HashSet<_>>().len(), 1024);
    // Ten foldings turn by 45° each and lengthen by √2.
    assert!((distance(&curve[0], &curve[1024]) - 32.0).abs() < 1e-2);
    let words = backend.words(&Job::new(dragon));
    assert_eq!(words[10].modules.iter().filter(|m| m.symbol == "L" || m.symbol == "R").count(), 1024);
}

/// Figure 10: 4·4ⁿ points, closed and simple; then Chaikin.
fn s20_kolam(backend: &Backend) {
    let file = include_str!("../../data/language/kolam.burgeon");
    for n in 0..5 {
        let words =
            backend.words(&Job::new(file.replace("derive 4 with fold", &format!("derive {n} with fold"))));
        let (traced, last) = (points(&words[n + 1]), words.last().expect("a word"));
        assert_eq!(traced.len(), 4 << (2 * n));
        assert_eq!((words.len(), last.modules.len()), (n + 5, 8 * traced.len()));
        assert!(lengths(&traced).iter().all(|l| (l - 1.0).abs() <= 100.0 * backend.tolerance));
        let places: HashSet<Vec<i64>> =
            traced.iter().map(|p| p.iter().map(|x| (x * 1000.0).round() as i64).collect()).collect();
        assert_eq!(places.len(), traced.len());
        let smooth = (0..3).fold(traced.clone(), |points, _| product(&points, &CHAIKIN_ROWS));
        backend.assert_near(&points(last), &smooth);
    }
}

/// Three steps of the curve visit each of 8³ cells once, in unit steps: all turns are what they say.
fn hilbert_fills_the_cube(backend: &Backend) {
    let curve = backend.last(&Job::new(include_str!("../../data/language/hilbert3d.burgeon")));
    assert_eq!(curve.len(), 512);
    let cells = on_lattice(&curve);
    assert_eq!(cells.len(), 512);
    for axis in 0..3 {
        let along = cells.iter().map(|c| c[axis]);
        assert_eq!(along.clone().max().zip(along.min()).map(|(a, b)| a - b), Some(7));
    }
    assert!(curve.windows(2).all(|w| (distance(&w[0], &w[1]) - 1.0).abs() < 1e-2));
}

// --- trees -------------------------------------------------------------------------------------

/// The word as a string, from its links: what hangs beside stands in brackets.
pub fn written(word: &Seen) -> String {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); word.modules.len()];
    let mut roots = Vec::new();
    let link = |i: usize| word.modules[i].link.expect("a link");
    for i in 0..word.modules.len() {
        match link(i).parent {
            Some(parent) => children[parent].push(i),
            None => roots.push(i),
        }
    }
    fn chain(word: &Seen, children: &[Vec<usize>], of: &[usize], text: &mut Vec<String>) {
        for &i in of {
            let lateral = word.modules[i].link.is_some_and(|l| l.lateral);
            let symbol = match word.modules[i].params.as_slice() {
                [Param::Int(n)] => format!("{}{n}", word.modules[i].symbol),
                _ => word.modules[i].symbol.clone(),
            };
            text.extend(lateral.then(|| "[".to_string()));
            text.push(symbol);
            chain(word, children, &children[i], text);
            text.extend(lateral.then(|| "]".to_string()));
        }
    }
    let mut text = Vec::new();
    chain(word, &children, &roots, &mut text);
    text.concat()
}

fn tree(text: &str) -> Job {
    Job::new(format!("system s : curve tree\n{text}"))
}

fn writings(backend: &Backend, text: &str) -> Vec<String> {
    backend.words(&tree(text)).iter().map(written).collect()
}

/// Figure 11, the paper's open problem: the first step by hand.
fn s21_a_branching_structure(backend: &Backend) {
    let words = backend.words(&Job::new(include_str!("../../data/language/twig.burgeon")));
    assert_eq!(written(&words[0]), "PP[PP]PP");
    assert_eq!(written(&words[1]), "PPP[PPP]PPP");
    let p = points(&words[0]);
    let mix = |a: f64, i: usize, b: f64, j: usize| -> Point {
        p[i].iter().zip(&p[j]).map(|(x, y)| a * x + b * y).collect()
    };
    let expected = [
        p[0].clone(),
        // The fork keeps its point and cuts the corner before it.
        mix(0.25, 0, 0.75, 1),
        p[1].clone(),
        // The first of a branch has its parent to the left.
        mix(0.25, 1, 0.75, 2),
        mix(0.75, 2, 0.25, 3),
        p[3].clone(),
        mix(0.25, 1, 0.75, 4),
        mix(0.75, 4, 0.25, 5),
        p[5].clone(),
    ];
    backend.assert_near(&points(&words[1]), &expected);
    assert_eq!(words.iter().map(|w| w.modules.len()).collect::<Vec<_>>()[..2], [6, 9]);
}

/// ABOP, section 1.8: `BC < S > G[H]M` in `ABC[DE][SG[HI[JK]L]MNO]`.
fn contexts_skip_branches(backend: &Backend) {
    let modules = "module A, B, C, D, E, G, H, I, J, K, L, M, N, O, S, T\n\
        axiom: A B C [ D E ] [ S G [ H I [ J K ] L ] M N O ]\nrules:\n  ";
    let result = |rule: &str| writings(backend, &format!("{modules}{rule} -> T\n")).pop().expect("a word");
    let (kept, fired) = ("ABC[DE][SG[HI[JK]L]MNO]", "ABC[DE][TG[HI[JK]L]MNO]");
    let fires = [
        "B C < S > G [ H ] M",
        "A B C < S > G M N O #",
        "# A B C < S",
        "S > G [ H I [ J K # ] L # ] M",
        "S > G [ H I L ]",
        "S > G [ H ] [ H ] M",
        "S > G [ H ] M [ N ]",
        "C < S > G [ I ]",
        "E < S",
        "S > G H",
        "S > G #",
        "# B C < S",
        "S > G [ H # ]",
    ];
    let all: Vec<bool> = fires.iter().map(|rule| result(rule) == fired).collect();
    assert_eq!(all, [vec![true; 5], vec![false; 8]].concat());
    assert_eq!(result("E < S"), kept);
}

/// ABOP, Figure 1.30: a signal enters all branches from the root, and leaves one branch for the root.
fn signals_run_up_and_down(backend: &Backend) {
    let head = "module A, B\nignore + -\n";
    let up = format!(
        "{head}axiom: B [ + A ] A [ - A ] A [ + A ] A\nrules:\n  B < A -> B\nrun:\n\
            derive until terminal max 9\n"
    );
    assert_eq!(
        writings(backend, &up),
        ["B[+A]A[-A]A[+A]A", "B[+B]B[-A]A[+A]A", "B[+B]B[-B]B[+A]A", "B[+B]B[-B]B[+B]B",]
    );
    let down = format!(
        "{head}axiom: A [ + A ] A [ - A ] A [ + A ] B\nrules:\n  A > B -> B\nrun:\n\
            derive until terminal max 9\n"
    );
    assert_eq!(
        writings(backend, &down),
        ["A[+A]A[-A]A[+A]B", "A[+A]A[-A]B[+A]B", "A[+A]B[-A]B[+A]B", "B[+A]B[-A]B[+A]B",]
    );
}

/// The plant of Hogeweg and Hesper, ABOP Figure 1.31 (a): its productions, with the states 0 and 1 as a
/// parameter. No counts were published; the first words are derived by hand.
pub const HOGEWEG: &str = "\
const angle = 22.5
module S(k: int)
module P(v: vec2)
ignore + - F
axiom: F S(1) F S(1) F S(1)
rules:
  S(0) < S(0) > S(0) -> S(0)
  S(0) < S(0) > S(1) -> S(1) [ + F S(1) F S(1) ]
  S(0) < S(1) > S(0) -> S(1)
  S(0) < S(1) > S(1) -> S(1)
  S(1) < S(0) > S(0) -> S(0)
  S(1) < S(0) > S(1) -> S(1) F S(1)
  S(1) < S(1) > S(0) -> S(0)
  S(1) < S(1) > S(1) -> S(0)
  + -> -
  - -> +
run:
";

fn hogeweg_and_hesper(backend: &Backend) {
    let words = backend.words(&tree(&format!("{HOGEWEG}  derive 30\n  trace into P\n")));
    let written: Vec<String> = words[..6].iter().map(|w| written(w).replace('S', "")).collect();
    let by_hand = ["F1F1F1", "F1F0F1", "F1F1F1F1", "F1F0F0F1", "F1F0F1[+F1F1]F1", "F1F1F1F1[-F0F1]F1"];
    assert_eq!(written, by_hand);
    let length = |n: usize| words[n].modules.len();
    let moves = |n: usize| words[n].modules.iter().filter(|m| m.symbol == "F").count();
    // Derived from the productions by a program of its own, over strings with brackets.
    assert_eq!([10, 20, 30].map(length), HOGEWEG_LENGTHS);
    assert_eq!(words[31].modules.len(), 1 + moves(30));
}

/// The modules after 10, 20 and 30 steps.
const HOGEWEG_LENGTHS: [usize; 3] = [41, 500, 5638];
