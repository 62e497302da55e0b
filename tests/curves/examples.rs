//! The curves of `examples/` on the CPU, against closed forms in f64.

use burgeon::cpu;
use burgeon::curve::{Axiom, Word};
use burgeon::io::curves;
use burgeon::language::{Value, Vocabulary, compile};
use burgeon::plan::{Options, Plan};
use std::path::Path;

/// An example; if there are points, with this axiom over them in place of its own.
struct Example<'a> {
    file: &'a str,
    axiom: &'a str,
    system: Option<&'a str>,
    points: Vec<[f64; 2]>,
    set: &'a [(&'a str, Value)],
    steps: Option<u32>,
}

fn example(file: &str) -> Example<'_> {
    Example {
        file,
        axiom: "axiom: file \"given.csv\"",
        system: None,
        points: Vec::new(),
        set: &[],
        steps: None,
    }
}

impl Example<'_> {
    #[track_caller]
    fn word(&self) -> Word {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        let text = std::fs::read_to_string(folder.join(format!("{}.burgeon", self.file))).expect(self.file);
        let given = |line| if str::starts_with(line, "axiom") { self.axiom } else { line };
        let replaced: Vec<&str> = text.lines().map(given).collect();
        let text = if self.points.is_empty() { text } else { replaced.join("\n") };
        let checked = compile(&text, &Vocabulary::default());
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let system = checked.systems.iter().rfind(|s| self.system.is_none_or(|name| s.name == name));
        let system = system.expect("a system of that name");
        let plan = Plan::new(system).unwrap_or_else(|e| panic!("{e}"));
        let axiom = Axiom::load(system, &mut |name| match self.points.as_slice() {
            [] => curves::read(folder.join(name), 4).map(|read| read.value),
            points => Ok(vec![
                points.iter().map(|&[x, y]| [x as f32, y as f32, 0.0, 1.0]).collect::<Vec<_>>().into(),
            ]),
        });
        let set = self.set.iter().map(|(name, value)| (name.to_string(), value.clone())).collect();
        let options = Options { set, steps: self.steps, ..Options::default() };
        cpu::derive(&plan, &axiom.expect("an axiom"), &options, 2).expect("a word").0
    }
    #[track_caller]
    fn points(&self) -> Vec<[f64; 2]> {
        self.word().points().iter().map(|&[x, y, _]| [x.into(), y.into()]).collect()
    }
}

/// Without symmetry.
fn polygon(n: usize) -> Vec<[f64; 2]> {
    let x = |i: usize| ((7 * i * i + 3 * i) % 31) as f64 / 4.0;
    (0..n).map(|i| [x(i), ((11 * i * i * i + 5 * i) % 29) as f64 / 4.0]).collect()
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[track_caller]
fn assert_near(a: &[[f64; 2]], b: &[[f64; 2]]) {
    assert_eq!(a.len(), b.len());
    let off = a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
    assert!(off < 1e-5, "{off}: {a:?}\nand\n{b:?}");
}

fn turned(points: &[[f64; 2]], by: i64) -> Vec<[f64; 2]> {
    let mut points = points.to_vec();
    let by = by.rem_euclid(points.len() as i64) as usize;
    points.rotate_left(by);
    points
}

/// A clamped uniform B-spline with whole knots, by de Boor's algorithm.
fn clamped(points: &[[f64; 2]], degree: usize, t: f64) -> [f64; 2] {
    let spans = points.len() - degree;
    let span = (t.floor() as usize).min(spans - 1);
    let knot = |i: usize| (i as f64 - degree as f64).clamp(0.0, spans as f64);
    let mut d = points[span..=span + degree].to_vec();
    for round in 1..=degree {
        for j in (round..=degree).rev() {
            let (left, right) = (knot(span + j), knot(span + j + degree + 1 - round));
            let a = (t - left) / (right - left);
            d[j] = [0, 1].map(|k| (1.0 - a) * d[j - 1][k] + a * d[j][k]);
        }
    }
    d[degree]
}

const INT: fn(i32) -> Value = Value::Int;

/// S6, S16, S20 to S22: every file is derived, and how many modules come.
#[test]
fn s6_s16_examples_are_derived() {
    let counts = [
        ("chaikin", Some("polygon"), 80),
        ("chaikin", None, 32),
        ("chaikin_open", None, (7 - 2) * 32 + 2),
        ("unchaikin", None, 121),
        ("cubic", None, 320),
        ("dlg", None, 320),
        ("lane_riesenfeld", Some("averages"), 320),
        ("lane_riesenfeld", None, 320),
        ("cubic_open", None, (7 - 3) * 32 + 3),
        ("four_point_open", None, 6 * 32 + 1),
        ("ternary", None, 810),
        ("circle", None, 320),
        ("crease", None, 320),
        ("elevate", None, 12),
        ("koch", None, 768),
        ("kolam", None, 8192),
        ("dragon", None, 4097),
        ("snowflake", None, 3072),
        ("hilbert3", None, 512),
        ("twig", None, 27),
        ("hogeweg", None, 2502),
        ("plant", None, 2257),
    ];
    for (file, system, modules) in counts {
        assert_eq!(Example { system, ..example(file) }.word().modules.len(), modules, "{file} {system:?}");
    }
}

/// S7, S8, S10, S11: the other productions turn the ring, by d, then 2d + d, and so on.
#[test]
fn s7_s8_s10_s11_shifts_turn_the_ring() {
    let shifted = |file: &'static str, shift: i32, levels: i32| {
        let set = [("shift", INT(shift)), ("levels", INT(levels))];
        Example { set: &set, ..example(file) }.points()
    };
    for shift in [-1, 1, 3] {
        let expected = turned(&shifted("chaikin", 0, 3), i64::from(7 * shift));
        assert_near(&shifted("chaikin", shift, 3), &expected);
    }
    for file in ["cubic", "dlg"] {
        assert_near(&shifted(file, -1, 3), &turned(&shifted(file, 0, 3), -7));
    }
}

/// S12, figures 6 and 7: Chaikin and the cubic stay in the hull, DLG goes through every point of every level.
#[test]
fn s12_one_polygon_under_three_schemes() {
    let support = |points: &[[f64; 2]], k: u32| {
        let (sin, cos) = (f64::from(k) * 0.07).sin_cos();
        points.iter().map(|p| p[0] * cos + p[1] * sin).fold(f64::MIN, f64::max)
    };
    let steps = |file, system, k| Example { system, steps: Some(k), ..example(file) }.points();
    let polygon = steps("dlg", None, 0);
    assert_eq!(polygon.len(), 10);
    let inside = |points: Vec<[f64; 2]>| (0..90).all(|k| support(&points, k) <= support(&polygon, k) + 1e-5);
    assert!(inside(steps("chaikin", Some("polygon"), 3)));
    assert!(inside(steps("cubic", None, 5)));
    assert!(!inside(steps("dlg", None, 5)));
    for k in 0..5 {
        let kept: Vec<[f64; 2]> = steps("dlg", None, k + 1).into_iter().step_by(2).collect();
        assert_eq!(kept, steps("dlg", None, k));
    }
}

/// S13 to S15 and the open cubic: inserting the midpoints of all knots leaves the curve as it is.
#[test]
fn s15_open_splines_are_clamped_splines() {
    for (file, degree, least) in [("chaikin_open", 2, 3), ("cubic_open", 3, 4)] {
        for n in least..11 {
            let control = polygon(n);
            for levels in 1..4 {
                let fine = Example { points: control.clone(), steps: Some(levels), ..example(file) }.points();
                let spans = (n - degree) as f64;
                let finer = f64::from(1 << levels);
                assert_eq!(fine.len(), (n - degree) * (1 << levels) + degree, "{file} {n}");
                let places = (0..=64).map(|k| spans * f64::from(k) / 64.0);
                let pair = |t: f64| (clamped(&control, degree, t), clamped(&fine, degree, t * finer));
                let (a, b): (Vec<_>, Vec<_>) = places.map(pair).unzip();
                assert_near(&a, &b);
            }
        }
    }
}

/// S11 on open curves: what one cubic passes through, it passes through again, ends and all.
#[test]
fn s11_open_four_points_reproduce_cubics() {
    let powers: [fn(f64) -> f64; 3] = [|x| 2.0 - x, |x| x * (x - 2.0), |x| x * (x - 1.5) * (x - 3.0) / 4.0];
    for (n, f) in [(2, powers[0]), (3, powers[1]), (4, powers[2]), (5, powers[2]), (8, powers[2])] {
        let graph: Vec<[f64; 2]> = (0..n).map(|i| f64::from(i) / 2.0).map(|x| [x, f(x)]).collect();
        let fine = Example { points: graph, steps: Some(3), ..example("four_point_open") }.points();
        assert_eq!(fine.len(), 8 * (n as usize - 1) + 1);
        let expected: Vec<[f64; 2]> = (0..fine.len()).map(|i| i as f64 / 16.0).map(|x| [x, f(x)]).collect();
        assert_near(&fine, &expected);
    }
}

/// Parabolas are reproduced where the ring's end is far, and all points stay.
#[test]
fn the_ternary_scheme_reproduces_parabolas() {
    let graph: Vec<[f64; 2]> = (0..9).map(f64::from).map(|x| [x, x * x / 8.0]).collect();
    let fine = Example { points: graph.clone(), steps: Some(1), ..example("ternary") }.points();
    assert_eq!(fine.iter().copied().step_by(3).collect::<Vec<_>>(), graph);
    let expected: Vec<[f64; 2]> = (3..=21).map(|i| f64::from(i) / 3.0).map(|x| [x, x * x / 8.0]).collect();
    assert_near(&fine[3..=21], &expected);
}

/// The limit of the regular pentagon is its circle: the points of every level are those of a regular polygon.
#[test]
fn regular_polygons_become_circles() {
    for levels in 1..7 {
        let points = Example { steps: Some(levels), ..example("circle") }.points();
        let n = 5 << levels;
        let expected: Vec<[f64; 2]> = (0..n)
            .map(|i| (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos())
            .map(|(sin, cos)| [cos, sin])
            .collect();
        assert_near(&points, &expected);
    }
    // The plain four-point scheme leaves the circle.
    let pentagon = Example { steps: Some(0), ..example("circle") }.points();
    let plain = Example { points: pentagon, steps: Some(4), ..example("dlg") }.points();
    assert!(plain.iter().any(|p| (p[0].hypot(p[1]) - 1.0).abs() > 1e-3));
}

/// A sharp point stays as it is for the levels that its sharpness tells, and its sharpness falls by one a level.
#[test]
fn sharpness_runs_out() {
    let words: Vec<Word> = (0..=3).map(|k| Example { steps: Some(k), ..example("crease") }.word()).collect();
    let corner = |level: usize, root: usize| match words[level].params(root << level).to_vec()[..] {
        [Value::Vec2(v), Value::Float(s)] => (v, s),
        ref other => panic!("{other:?}"),
    };
    let ([a, sharp], axiom) = ([1, 2].map(|root| corner(0, root).0), corner(0, 3).0);
    assert_eq!(corner(1, 1), (a, 0.0));
    assert_ne!(corner(2, 1).0, a);
    assert_eq!((corner(1, 2), corner(2, 2)), ((sharp, 1.5), (sharp, 0.5)));
    // The last half: the mean of the corner and of where the cubic would take it.
    let near = |k: usize, axis: usize| words[2].points()[k][axis];
    let smooth = [0, 1].map(|axis| near(7, axis) / 8.0 + 0.75 * near(8, axis) + near(9, axis) / 8.0);
    let (point, left) = corner(3, 2);
    assert_eq!(left, 0.0);
    assert!((0..2).all(|k| (point[k] - 0.5 * (smooth[k] + sharp[k])).abs() < 1e-6), "{point:?} {smooth:?}");
    assert_eq!(corner(3, 3), (axiom, 7.0));
    // Where there is none it is the cubic.
    let blunt = Example { axiom: "axiom: P(_, 0) = file \"given.csv\"", ..example("crease") };
    let blunt = Example { points: polygon(6), steps: Some(3), ..blunt };
    assert_near(
        &blunt.points(),
        &Example { points: polygon(6), steps: Some(3), ..example("cubic") }.points(),
    );
}

/// The raised curve is the curve.
#[test]
fn elevation_keeps_the_curve() {
    fn bezier(mut points: Vec<[f64; 2]>, t: f64) -> [f64; 2] {
        while points.len() > 1 {
            let between = |w: &[[f64; 2]]| [0, 1].map(|k| (1.0 - t) * w[0][k] + t * w[1][k]);
            points = points.windows(2).map(between).collect();
        }
        points[0]
    }
    let (first, raised) = (Example { steps: Some(0), ..example("elevate") }, example("elevate"));
    let places = (0..=20).map(|k| f64::from(k) / 20.0);
    let pair = |t: f64| (bezier(first.points(), t), bezier(raised.points(), t));
    let (a, b): (Vec<_>, Vec<_>) = places.map(pair).unzip();
    assert_near(&a, &b);
}

/// S22: A₀ (8/5 − 3/5 (4/9)ⁿ), and edges of a third.
#[test]
fn s22_the_snowflake_has_its_area() {
    for n in 0..5 {
        let points = Example { steps: Some(n), ..example("koch") }.points();
        let edges: Vec<_> = points.iter().zip(points.iter().cycle().skip(1)).collect();
        let area = edges.iter().map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>() / 2.0;
        let expected = 3f64.sqrt() / 4.0 * (1.6 - 0.6 * (4.0f64 / 9.0).powi(n as i32));
        assert!((area - expected).abs() < 1e-5, "{area} {expected}");
        let length = 3f64.powi(-(n as i32));
        assert!(edges.iter().all(|(p, q)| (distance(p, q) - length).abs() < 1e-5));
    }
}

fn averaged(points: &[[f64; 2]], system: Option<&str>, set: &[(&str, Value)]) -> Vec<[f64; 2]> {
    Example { system, points: points.to_vec(), set, ..example("lane_riesenfeld") }.points()
}

/// S10, S17: masks of degree k are the binomials of k + 1 over 2ᵏ, and averages give the same ring, turned.
#[test]
fn s17_lane_and_riesenfeld() {
    for degree in 2..=7 {
        let mut unit = vec![[0.0, 0.0]; 12];
        unit[5][0] = 1.0;
        let set = [("degree", INT(degree)), ("levels", INT(1))];
        let spread: Vec<f64> =
            averaged(&unit, None, &set).iter().map(|p| p[0] * f64::from(1 << degree)).collect();
        let first = spread.iter().position(|&x| x != 0.0).expect("a mask");
        let binomials = (0..=degree + 1).scan(1.0, |b, k| {
            let this = *b;
            *b *= f64::from(degree + 1 - k) / f64::from(k + 1);
            Some(this)
        });
        let binomials: Vec<f64> = binomials.collect();
        assert_eq!(spread[first..first + binomials.len()], binomials, "degree {degree}");
        assert_eq!(spread.iter().sum::<f64>(), f64::from(2 << degree));
        let set = [("degree", INT(degree)), ("levels", INT(3))];
        let (masks, averages) =
            (averaged(&polygon(9), None, &set), averaged(&polygon(9), Some("averages"), &set));
        let off = |by: i64| {
            turned(&masks, by).iter().zip(&averages).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
        };
        assert!((0..masks.len() as i64).any(|by| off(by) < 1e-5), "degree {degree}");
    }
}

/// S18, S19, E11, E12, figure 9: the leaf's 1925 points in two phases; both describe the leaf.
#[test]
fn s18_s19_e12_the_leaf_in_two_phases() {
    let phase = |phase: i32, steps: u32| {
        let set = [("phase", INT(phase))];
        Example { set: &set, steps: Some(steps), ..example("unchaikin") }.points()
    };
    let leaf = phase(0, 0);
    let counts: Vec<usize> = (0..=4).map(|steps| phase(0, steps).len()).collect();
    assert_eq!(counts, [1925, 963, 482, 241, 121]);
    let (a, b) = (phase(0, 4), phase(1, 4));
    assert_eq!((a.len(), b.len()), (121, 121));
    assert!((0..121).all(|by| turned(&a, by) != b));
    let levels = [("levels", INT(4))];
    for coarse in [a, b] {
        let fine = Example { system: Some("polygon"), points: coarse, ..example("chaikin") };
        let fine = Example { set: &levels, ..fine };
        let nearest = |p: &[f64; 2]| leaf.iter().map(|q| distance(p, q)).fold(f64::MAX, f64::min);
        let off = fine.points().iter().map(nearest).fold(0.0, f64::max);
        assert!(off < 0.15, "{off} of a leaf 20 units high");
    }
}

/// S22, S23: rules see no index, no parity, no length of the word.
#[test]
fn s22_s23_no_index_is_to_be_had() {
    for name in ["index", "i", "odd", "even", "position", "length", "count"] {
        let text = format!(
            "system s : curve ring\nmodule P(v: vec2)\naxiom: P((0,0)) P((1,0))\nrules:\n  P(v) : {name} > 0 -> P(v) P(v)\n"
        );
        assert!(compile(&text, &Vocabulary::default()).has_errors(), "{name}");
    }
}
