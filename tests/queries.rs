//! Queries: attributes against the oracle and against closed forms, what the host binds, conditions
//! near their threshold.

use crate::device;
use crate::oracle::{self, Tolerance};
use crate::parity::{Job, system};
use burgeon::codegen::Edit;
use burgeon::gpu::Engine;
use burgeon::language::Value;
use burgeon::patch::{Grid, Values, Word};
use burgeon::plan::compare::Pair;
use burgeon::plan::derive::{collect, derive};
use burgeon::plan::{Error, Options, View};
use proptest::prelude::*;

/// A net of uneven integers.
fn lattice(degree: [usize; 2], salt: i64) -> oracle::Net {
    let points = (0..=degree[0] as i64).flat_map(|r| {
        (0..=degree[1] as i64).map(move |c| {
            let height = (5 * r * r + 3 * r * c + 7 * c * c + 11 * r + salt) % 13 - 6;
            [(4 * r + c % 2) as f64, (4 * c + r % 2) as f64, height as f64, 1.0]
        })
    });
    oracle::Net::new(degree, points.collect())
}

/// Carries every attribute that the oracle knows, three levels down.
const CARRIED: &str = "\
system carried : patch bezier 3
module P(n: int), Q(x: float, y: float, z: float, flat: float, u: float, v: float, a: float, s: float, t: float)
query Far(d: float) = distance((1, 2, 3), centroid)
axiom: P(0) = file \"net.bpt\"
rules:
  P(n) : n < 3 -> [ P(n + 1) | P(n + 1) ; P(n + 1) | P(n + 1) ]
  ?Far(d) P(n) : d > 5 -> Q(centroid.x, centroid.y, centroid.z, flatness, bend_u, bend_v, area, uv.x, uv.y)
run:
  derive 4
";

fn on_pair(name: &str, engine: &Engine, text: &str, roots: &[oracle::Net], options: &Options) -> (Word, u64) {
    let job = Job::new(text, roots, options.set.clone());
    let mut pair = Pair::new(job.cpu(2), job.gpu(engine), ["CPU", "GPU"]);
    let result = derive(&job.axiom, options, &mut pair);
    let word = result.and_then(|d| collect(&mut pair, &d));
    (word.unwrap_or_else(|e| panic!("{name}: {e}\n{text}")), pair.replayed)
}

#[test]
fn attributes_are_those_of_the_oracle() {
    let roots = [lattice([3, 3], 0), lattice([3, 3], 5)];
    let words = oracle::derive(CARRIED, &roots);
    let job = Job::new(CARRIED, &roots, Vec::new());
    for (step, expected) in words.iter().enumerate() {
        let word = job.word(&mut job.cpu(2), Some(step as u32), None);
        oracle::assert_same(step, expected, &word, Tolerance::Carried { c: 4.0 });
    }
    assert!(words.last().expect("words").modules.iter().any(|m| m.symbol == "Q"));
    for (name, engine) in device::engines() {
        for chunk in [None, Some(7)] {
            let options = job.options(None, chunk);
            on_pair(&name, &engine, CARRIED, &roots, &options);
        }
    }
}

#[test]
fn a_closed_growth_measures_too() {
    let text = "system s : patch bezier 3\nmodule P(f: float)\naxiom: P(0.0) = file \"net.bpt\"\nrules:\n  \
        P(_) -> [ P(flatness) P(area) ; P(bend_u) P(uv.x) ]\nrun:\n  derive 3\n";
    let roots = [lattice([3, 3], 3)];
    let expected = oracle::derive(text, &roots);
    let job = Job::new(text, &roots, Vec::new());
    let word = job.word(&mut job.cpu(2), None, None);
    oracle::assert_same(3, &expected[3], &word, Tolerance::Carried { c: 4.0 });
    for (name, engine) in device::engines() {
        on_pair(&name, &engine, text, &roots, &job.options(None, None));
    }
}

#[test]
fn a_nested_block_reads_what_was_measured_of_its_predecessor() {
    let text = "system s : patch bezier 3\nmodule P, Q(f: float, u: float)\naxiom: P = file \"net.bpt\"\nrules:\n  \
        P -> [ [ Q(flatness, uv.x) | Q(area, uv.y) ] ; Q(flatness, 0.0) ]\n";
    let roots = [lattice([3, 3], 1)];
    let expected = oracle::derive(text, &roots);
    let job = Job::new(text, &roots, Vec::new());
    let word = job.word(&mut job.cpu(2), None, None);
    oracle::assert_same(1, &expected[1], &word, Tolerance::Carried { c: 4.0 });
    for (name, engine) in device::engines() {
        on_pair(&name, &engine, text, &roots, &job.options(None, None));
    }
}

// --- the screen ----------------------------------------------------------------------------------

/// A flat square of side 2 about the origin, seen from the front.
fn square(z: f64) -> oracle::Net {
    let at = |k: usize| k as f64 * 2.0 / 3.0 - 1.0;
    let points = (0..16).map(|k| [at(k % 4), at(k / 4), z, 1.0]).collect();
    oracle::Net::new([3, 3], points)
}

const SCREEN: &str = "system s : patch bezier 3\nmodule P, Q(side: float, area: float)\n\
    axiom: P = file \"net.bpt\"\nrules:\n  P -> Q(bbox_px, area_px)\n";

#[test]
fn sizes_on_the_screen_are_those_of_a_pinhole_camera() {
    // 90 degrees, 10 away: a side of 2 covers 2 / (2·10) of the height.
    let view = View::looking([0.0, 0.0, 10.0], [0.0; 3], [0.0, 1.0, 0.0], 90.0, [1600.0, 900.0]);
    let roots = [square(0.0), square(5.0), square(20.0), square(10.0), tilted()];
    let job = Job::new(SCREEN, &roots, Vec::new());
    let options = Options { view: Some(view), ..job.options(None, None) };
    let check = |name: &str, word: &Word| {
        let of = |n: usize| match word.params(n).to_vec()[..] {
            [Value::Float(side), Value::Float(area)] => [side, area],
            ref other => panic!("{other:?}"),
        };
        let near = |a: f32, b: f32| assert!((a - b).abs() <= 1e-4 * b, "{name}: {a} and {b}");
        near(of(0)[0], 90.0);
        near(of(0)[1], 8100.0);
        near(of(1)[0], 180.0);
        near(of(1)[1], 32400.0);
        // Behind the viewer; through the viewer's plane.
        assert_eq!(of(2), [0.0, 0.0], "{name}");
        assert_eq!(of(4), [f32::MAX, f32::MAX], "{name}");
    };
    let mut cpu = job.cpu(2);
    let derivation = derive(&job.axiom, &options, &mut cpu).expect("a derivation");
    check("CPU", &collect(&mut cpu, &derivation).expect("a word"));
    for (name, engine) in device::engines() {
        check(&name, &on_pair(&name, &engine, SCREEN, &roots, &options).0);
    }
}

/// A square that reaches from before the viewer to behind.
fn tilted() -> oracle::Net {
    let points = square(0.0).points.iter().map(|p| [p[0], 0.0, 20.0 * p[1], 1.0]).collect();
    oracle::Net::new([3, 3], points)
}

#[test]
fn the_screen_wants_a_view() {
    let job = Job::new(SCREEN, &[square(0.0)], Vec::new());
    let result = derive(&job.axiom, &job.options(None, None), &mut job.cpu(1));
    match result.err() {
        Some(Error::View { attribute: "bbox_px" }) => {}
        other => panic!("{other:?}"),
    }
}

// --- what the host binds -------------------------------------------------------------------------

const BOUND: &str = "system s : patch bezier 3
module P(n: int), Q(heat: float, way: vec2, kind: int, open: bool)
query Heat(t: float)
query Way(w: vec2)
query Kind(k: int)
query Open(o: bool)
axiom: P(0) = file \"net.bpt\"
rules:
  P(n) : n < 2 -> [ P(n + 1) | P(n + 1) ]
  ?Heat(t) ?Way(w) ?Kind(k) ?Open(o) P(n) : t > 0.5 || o -> Q(t, w, k, o)
run:
  derive 3
";

fn bound(options: &mut Options, name: &str, values: Values) {
    options.bind.push((name.to_string(), values));
}

#[test]
fn every_descendant_inherits_what_is_bound_to_its_root() {
    let roots = [lattice([3, 3], 0), lattice([3, 3], 1), lattice([3, 3], 2)];
    let job = Job::new(BOUND, &roots, Vec::new());
    let mut options = job.options(None, Some(3));
    let heat = [0.25, 0.75, 0.125];
    let ways = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
    bound(&mut options, "Heat", Values::Roots(heat.map(Value::Float).to_vec()));
    bound(&mut options, "Way", Values::Roots(ways.map(Value::Vec2).to_vec()));
    bound(&mut options, "Kind", Values::Roots([7, -8, 9].map(Value::Int).to_vec()));
    bound(&mut options, "Open", Values::Roots([false, false, true].map(Value::Bool).to_vec()));
    let check = |name: &str, word: &Word| {
        assert_eq!(word.modules.len(), 12, "{name}");
        for (index, m) in word.modules.iter().enumerate() {
            let (n, params) = (m.root as usize, word.params(index).to_vec());
            let own =
                [Value::Float(heat[n]), Value::Vec2(ways[n]), Value::Int([7, -8, 9][n]), Value::Bool(n == 2)];
            match n {
                0 => assert_eq!(params, [Value::Int(2)], "{name}"),
                _ => assert_eq!(params, own, "{name}, root {n}"),
            }
        }
    };
    let mut cpu = job.cpu(2);
    let derivation = derive(&job.axiom, &options, &mut cpu).expect("a derivation");
    check("CPU", &collect(&mut cpu, &derivation).expect("a word"));
    for (name, engine) in device::engines() {
        check(&name, &on_pair(&name, &engine, BOUND, &roots, &options).0);
    }
}

const FIELD: &str = "system s : patch bezier 3
module P(n: int), Q(p: vec3, heat: float, wind: vec3, kind: int)
query Heat(t: float)
query Wind(w: vec3)
query Kind(k: int)
axiom: P(0) = file \"net.bpt\"
rules:
  P(n) : n < 2 -> [ P(n + 1) P(n + 1) ; P(n + 1) P(n + 1) ]
  P(_) -> Q(centroid, Heat(centroid), Wind(centroid + (0.5, 0, 0)), Kind(centroid))
run:
  derive 3
";

/// x fastest: what a grid of that size holds.
fn grid(size: [u32; 3], from: [f32; 3], to: [f32; 3], value: impl Fn([f32; 3]) -> Value) -> Grid {
    let mut values = Vec::new();
    let place = |i: u32, axis: usize| {
        let last = (size[axis] - 1).max(1) as f32;
        from[axis] + (to[axis] - from[axis]) * i as f32 / last
    };
    for k in 0..size[2] {
        for j in 0..size[1] {
            values.extend((0..size[0]).map(|i| value([place(i, 0), place(j, 1), place(k, 2)])));
        }
    }
    Grid { size, from, to, values }
}

#[test]
fn a_grid_is_linear_between_its_points_and_constant_beyond() {
    let roots = [lattice([3, 3], 0), lattice([3, 3], 7)];
    let job = Job::new(FIELD, &roots, Vec::new());
    let mut options = job.options(None, None);
    // A multilinear function is met exactly; the box ends inside the nets.
    let (from, to) = ([1.0, 2.0, -6.0], [9.0, 11.0, 6.0]);
    let field = |[x, y, z]: [f32; 3]| 2.0 * x - y + 0.5 * z + 0.25 * x * y * z;
    let kind = |[x, y, _]: [f32; 3]| if x > 4.0 { 10 } else { 0 } + if y > 7.0 { 1 } else { 0 };
    bound(&mut options, "Heat", Values::Grid(grid([5, 4, 7], from, to, |p| Value::Float(field(p)))));
    bound(&mut options, "Wind", Values::Grid(grid([2, 1, 2], from, [9.0, 2.0, 6.0], Value::Vec3)));
    bound(&mut options, "Kind", Values::Grid(grid([3, 2, 1], from, to, |p| Value::Int(kind(p)))));
    let check = |name: &str, word: &Word| {
        assert_eq!(word.modules.len(), 32);
        for index in 0..word.modules.len() {
            let params = word.params(index).to_vec();
            let [Value::Vec3(p), Value::Float(heat), Value::Vec3(wind), Value::Int(k)] = params[..] else {
                panic!("{params:?}")
            };
            let inside = |p: [f32; 3]| -> [f32; 3] { std::array::from_fn(|a| p[a].clamp(from[a], to[a])) };
            let expected = field(inside(p));
            assert!((heat - expected).abs() < 1e-3 * expected.abs().max(1.0), "{name}: {heat}, {expected}");
            let moved = inside([p[0] + 0.5, p[1], p[2]]);
            assert!((wind[0] - moved[0]).abs() < 1e-4 && wind[1] == 2.0 && (wind[2] - moved[2]).abs() < 1e-4);
            // Points at 1, 5, 9 and at 2, 11.
            let nearest = if p[0] > 3.0 { 10 } else { 0 } + if p[1] > 6.5 { 1 } else { 0 };
            assert_eq!(k, nearest, "{name}: at {p:?}");
        }
    };
    let mut cpu = job.cpu(2);
    let derivation = derive(&job.axiom, &options, &mut cpu).expect("a derivation");
    check("CPU", &collect(&mut cpu, &derivation).expect("a word"));
    for (name, engine) in device::engines() {
        check(&name, &on_pair(&name, &engine, FIELD, &roots, &options).0);
    }
}

#[test]
fn values_that_do_not_fit_are_refused_with_what_would() {
    let refused = |text: &str, roots: usize, bind: Vec<(&str, Values)>| {
        let job = Job::new(text, &vec![lattice([3, 3], 0); roots], Vec::new());
        let bind = bind.into_iter().map(|(name, values)| (name.to_string(), values)).collect();
        let options = Options { bind, ..job.options(None, None) };
        match derive(&job.axiom, &options, &mut job.cpu(1)).err() {
            Some(Error::Bind(text)) => text,
            other => panic!("{other:?}"),
        }
    };
    let one = "system s : patch bezier 3\nmodule P(t: float)\nquery Heat(t: float)\nquery Own(f: float) = flatness\n\
        axiom: P(0.0) = file \"n.bpt\"\nrules:\n  ?Heat(t) P(_) -> P(t)\n";
    let at = one.replace("?Heat(t) P(_) -> P(t)", "P(_) -> P(Heat(centroid))");
    let list = |n: usize| Values::Roots(vec![Value::Float(1.0); n]);
    let bools = Values::Roots(vec![Value::Bool(true); 2]);
    let good = grid([2, 2, 2], [0.0; 3], [1.0; 3], |p| Value::Float(p[0]));
    let short = Values::Grid(Grid { values: vec![Value::Float(1.0); 7], ..good.clone() });
    let empty = Values::Grid(Grid { size: [2, 0, 2], values: Vec::new(), ..good.clone() });
    let back = Values::Grid(Grid { to: [1.0, 0.0, 1.0], ..good.clone() });
    let vast = Values::Grid(Grid { size: [u32::MAX; 3], ..good.clone() });
    let cases = [
        (
            refused(one, 2, vec![]),
            "nothing is bound to the query Heat; it wants one value a patch of the axiom",
        ),
        (refused(&at, 2, vec![]), "nothing is bound to the query Heat; it wants a grid"),
        (
            refused(one, 3, vec![("Heat", list(2))]),
            "Heat wants a value for each patch of the axiom, 3, and is bound to 2",
        ),
        (
            refused(one, 2, vec![("Heat", bools)]),
            "value 0 of Heat is of type bool; the query is of type float",
        ),
        (refused(one, 2, vec![("Cold", list(2))]), "`Cold` is no query of s; it has Heat"),
        (refused(one, 2, vec![("Own", list(2))]), "Own has a value of its own"),
        (
            refused(one, 2, vec![("Heat", Values::Grid(good))]),
            "a grid is bound to Heat, but the rules ask for it as `?Heat(…)`",
        ),
        (refused(&at, 2, vec![("Heat", list(2))]), "the rules ask for it at a point: it wants a grid"),
        (refused(&at, 2, vec![("Heat", short)]), "the grid of Heat has 2×2×2 points, and values for 7"),
        (refused(&at, 2, vec![("Heat", empty)]), "the grid of Heat has 2×0×2 points"),
        (refused(&at, 2, vec![("Heat", back)]), "the grid of Heat goes from 0 to 0 along y"),
        (
            refused(&at, 2, vec![("Heat", vast)]),
            "the grid of Heat has 4294967295×4294967295×4294967295 points",
        ),
    ];
    for (found, expected) in cases {
        assert!(found.contains(expected), "{found}\n{expected}");
    }
}

// --- near a threshold ----------------------------------------------------------------------------

/// Splits where flatness exceeds what it is of the first root, to the bit.
const THRESHOLD: &str = "\
system s : patch bezier 3
param bound: float = 1.0
module P(n: int)
axiom: P(0) = file \"net.bpt\"
rules:
  P(n) : flatness > bound && n < 3 -> [ P(n + 1) | P(n + 1) ]
run:
  derive 3
";

/// The flatness of the first root as the CPU has it.
fn own_flatness(roots: &[oracle::Net]) -> f32 {
    let text = "system s : patch bezier 3\nmodule P(f: float)\naxiom: P(0.0) = file \"n.bpt\"\nrules:\n  P(_) -> P(flatness)\n";
    let job = Job::new(text, roots, Vec::new());
    match job.word(&mut job.cpu(1), None, None).params(0).to_vec()[..] {
        [Value::Float(f)] => f,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn conditions_nearer_to_their_threshold_than_rounding_are_replayed() {
    let Some(headless) = device::headless() else { return };
    let roots = [lattice([3, 3], 0), lattice([3, 3], 4)];
    let set = vec![("bound".to_string(), Value::Float(own_flatness(&roots)))];
    let job = Job::new(THRESHOLD, &roots, set);
    let run = |replace: &'static str| {
        let edit = Edit { file: "measure", find: "return sqrt(greatest);", replace };
        let engine = Engine::new(&headless.device, &headless.queue).with_edit(edit);
        let mut pair = Pair::new(job.cpu(1), job.gpu(&engine), ["CPU", "GPU"]);
        let result = derive(&job.axiom, &job.options(None, None), &mut pair);
        let result = result.and_then(|d| collect(&mut pair, &d));
        (result.map(|word| word.modules.len()).map_err(|e| e.to_string()), pair.replayed)
    };
    let (plain, _) = run("return sqrt(greatest);");
    // A driver whose root is some units greater splits what lies on the threshold: both are right.
    let (nudged, some) = run("return bitcast<f32>(bitcast<u32>(sqrt(greatest)) + 3u);");
    assert!(some > 0);
    let (plain, nudged) = (plain.expect("a word"), nudged.expect("a word"));
    assert!(nudged >= plain && nudged > 2, "{plain} and {nudged} modules");
    // One that is off by more is wrong.
    let (wrong, _) = run("return sqrt(greatest) * 1.001;");
    let wrong = wrong.expect_err("a difference");
    assert!(wrong.contains("measure, sweep 0: word 0 of the attributes of module 0"), "{wrong}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Moving a model moves its centroids and nothing else that is measured.
    #[test]
    fn measures_do_not_depend_on_where_a_model_lies(x in -64i32..64, y in -64i32..64, z in -64i32..64, salt in 0i64..13) {
        let text = "system s : patch bezier 3\nmodule P(f: float, u: float, v: float, a: float)\n\
            axiom: P(0.0, 0.0, 0.0, 0.0) = file \"n.bpt\"\nrules:\n  P(_, _, _, _) -> P(flatness, bend_u, bend_v, area)\n";
        let measured = |net: oracle::Net| {
            let job = Job::new(text, &[net], Vec::new());
            job.word(&mut job.cpu(1), None, None).params(0).to_vec()
        };
        let net = lattice([3, 3], salt);
        let moved = net.points.iter().map(|p| [p[0] + x as f64, p[1] + y as f64, p[2] + z as f64, 1.0]);
        let moved = oracle::Net::new([3, 3], moved.collect());
        for (a, b) in measured(net).into_iter().zip(measured(moved)) {
            let (Value::Float(a), Value::Float(b)) = (a, b) else { panic!("floats") };
            prop_assert!((a - b).abs() <= 1e-4 * a.max(1.0), "{a} {b}");
        }
    }
}

#[test]
fn a_system_without_queries_measures_nothing() {
    let system =
        system("system s : patch bezier 3\nmodule P\naxiom: P = file \"n.bpt\"\nrules:\n  P -> [ P | P ]\n");
    let plan = burgeon::plan::Plan::new(&system).expect("a plan");
    assert_eq!(plan.tables.most_measured(), 0);
}
