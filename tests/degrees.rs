//! Nets of every degree, with weights and without: CPU = GPU to the bit, both the dense product in
//! f64 within rounding, and the laws that halving must keep.

use crate::device;
use crate::oracle::{self, Random, Tolerance};
use crate::parity::Job;
use crate::tier;
use burgeon::codegen::{Mapping, Tuning};
use burgeon::gpu::Engine;
use burgeon::patch::validate::{MAX_COORDINATE, MIN_WEIGHT};
use burgeon::patch::{Axiom, Net, NetError, Word};
use burgeon::plan::compare::Pair;
use burgeon::plan::derive::{collect, derive};
use burgeon::plan::{self, Plan};
use proptest::prelude::*;

/// Whole splits, splits along one direction, and cells that are erased, in every place.
const EVERY_BLOCK: &str = "\
system every : patch bezier 3
module P, Q, R, S
axiom: P = file \"x\"  Q = file \"x\"  R = file \"x\"  S = file \"x\"
rules:
  P -> [ Q R ; S Q ]
  Q -> [ R | P ]
  R -> [ S ; Q ]
  S -> [ eps P ; R eps ]
run:
  derive 3
";

fn text(degree: [usize; 2], rational: bool) -> String {
    let [m, n] = degree;
    let rational = if rational { " rational" } else { "" };
    EVERY_BLOCK.replace("bezier 3", &format!("bezier {m} {n}{rational}"))
}

/// A net of floats without pattern, so that another order of the midpoints shows.
fn net(degree: [usize; 2], rational: bool, seed: u64) -> oracle::Net {
    let mut random = Random::new(seed);
    let mut number = || f64::from(random.range(-1_000_000, 1_000_000)) as f32 / 777_777.0;
    let point = |_| {
        let weight = if rational { number().abs() + 0.25 } else { 1.0 };
        [number() * weight, number() * weight, number() * weight, weight].map(f64::from)
    };
    oracle::Net::new(degree, (0..(degree[0] + 1) * (degree[1] + 1)).map(point).collect())
}

fn pairs() -> impl Iterator<Item = [usize; 2]> {
    (1..=8).flat_map(|m| (1..=8).map(move |n| [m, n]))
}

/// Every other pair has weights.
fn rational(degree: [usize; 2]) -> bool {
    (degree[0] + degree[1]) % 2 == 1
}

/// [`EVERY_BLOCK`] with nets of this degree.
pub fn job(degree: [usize; 2]) -> Job {
    let rational = rational(degree);
    let nets = [0, 1].map(|seed| net(degree, rational, seed + 10 * degree[0] as u64 + degree[1] as u64));
    Job::new(&text(degree, rational), &nets, Vec::new())
}

#[test]
fn every_degree_is_the_dense_product_within_rounding() {
    for degree in pairs() {
        let rational = rational(degree);
        let nets = [net(degree, rational, 3), net(degree, rational, 4)];
        let text = text(degree, rational);
        let words = oracle::derive(&text, &nets);
        let job = Job::new(&text, &nets, Vec::new());
        for (chunk, threads) in [(None, 2), (Some(7), 1)] {
            let word = job.word(&mut job.cpu(threads), None, chunk);
            let tolerance = Tolerance::Carried { c: degree[0].max(degree[1]) as f64 };
            oracle::assert_same(3, &words[3], &word, tolerance);
            assert_eq!(word.rational, rational);
            word.validate().expect("a word");
        }
    }
}

fn assert_pair(name: &str, engine: &Engine, degree: [usize; 2], chunk: Option<usize>) {
    let job = job(degree);
    let mut pair = Pair::new(job.cpu(1), job.gpu(engine), ["CPU", "GPU"]);
    let result = derive(&job.axiom, &job.options(None, chunk), &mut pair);
    if let Err(e) = result.and_then(|d| collect(&mut pair, &d)) {
        panic!("{name}, degree {degree:?}, chunks of {chunk:?}: {e}");
    }
}

#[test]
fn every_degree_is_equal_to_the_bit_on_cpu_and_gpu() {
    for (n, (name, engine)) in device::engines().into_iter().enumerate() {
        // The second engine compiles the same kernels by another way: one degree of each size. A sample has every number
        // of rows, of columns, and every size of chunks.
        let every = if n == 0 { tier::cases(5, 1) } else { 11 };
        for degree in pairs().filter(|[a, b]| (a + 3 * b) % every == 0) {
            let chunk = [None, Some(64), Some(7), Some(1)][(degree[0] + 3 * degree[1]) % 4];
            assert_pair(&name, &engine, degree, chunk);
        }
    }
}

/// The mapping for all degrees also takes bicubic nets, and workgroups of other sizes.
#[test]
fn every_mapping_and_workgroup_gives_the_same_bits() {
    let Some(headless) = device::headless() else { return };
    for (workgroup, degree) in
        [(16, [3, 3]), (64, [3, 3]), (256, [3, 3]), (16, [8, 8]), (256, [8, 1]), (128, [1, 1])]
    {
        let tuning = Tuning { workgroup, mapping: Mapping::LinePerInvocation, ..Tuning::CPU_DRIVER };
        let engine = Engine::with_tuning(&headless.device, &headless.queue, tuning);
        for chunk in [None, Some(7)] {
            assert_pair("line per invocation", &engine, degree, chunk);
        }
    }
}

// --- laws ----------------------------------------------------------------------------------------

fn any_net() -> impl Strategy<Value = oracle::Net> {
    (1usize..=8, 1usize..=8, any::<bool>(), any::<u64>())
        .prop_map(|(m, n, rational, seed)| net([m, n], rational, seed))
}

/// The leaves of a net after three steps.
fn leaves(net: &oracle::Net) -> Word {
    let job = Job::new(&text(net.degree, true), std::slice::from_ref(net), Vec::new());
    job.word(&mut job.cpu(1), None, None)
}

fn mapped(net: &oracle::Net, f: impl Fn([f64; 4]) -> [f64; 4]) -> oracle::Net {
    oracle::Net::new(net.degree, net.points.iter().map(|p| f(*p)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Partition of unity, exactly: a net that is one point stays that point.
    #[test]
    fn a_point_stays_a_point(net in any_net()) {
        let point = net.points[0];
        let word = leaves(&mapped(&net, |_| point));
        prop_assert!(word.nets.iter().all(|p| *p == point.map(|x| x as f32)));
    }

    /// Halving commutes with affine maps; with powers of two to the bit.
    #[test]
    fn halving_is_affine(net in any_net(), shift in -3.0..3.0f64, turn in -3.0..3.0f64) {
        let map = |[x, y, z, w]: [f64; 4]| {
            let (s, c) = turn.sin_cos();
            [c * x - s * y + shift * w, s * x + c * y, 2.0 * z - shift * w + x, w]
        };
        let (before, after) = (leaves(&net), leaves(&mapped(&net, map)));
        for (p, q) in before.nets.iter().zip(&after.nets) {
            let expected = map(p.map(f64::from));
            for axis in 0..4 {
                prop_assert!((expected[axis] - f64::from(q[axis])).abs() < 1e-4, "{expected:?} {q:?}");
            }
        }
        let doubled = leaves(&mapped(&net, |[x, y, z, w]| [8.0 * x, 0.25 * y, -z, w]));
        for (p, q) in before.nets.iter().zip(&doubled.nets) {
            prop_assert_eq!([8.0 * p[0], 0.25 * p[1], -p[2], p[3]], *q);
        }
    }

    /// No weight leaves the range of the weights that it comes from.
    #[test]
    fn weights_stay_between_the_least_and_the_greatest(net in any_net()) {
        let weights = || net.points.iter().map(|p| p[3] as f32);
        let (least, greatest) = (weights().fold(f32::MAX, f32::min), weights().fold(0.0, f32::max));
        prop_assert!(leaves(&net).nets.iter().all(|p| (least..=greatest).contains(&p[3])));
    }
}

// --- weights -------------------------------------------------------------------------------------

const RATIONAL: &str = "system s : patch bezier 1 rational\nmodule P\naxiom: P = file \"x\"\nrules:\n  \
                        P -> [ P P ; P P ]\nrun:\n  derive 4\n";

/// A plan and an axiom that no reader has seen.
fn made(points: [[f32; 4]; 4]) -> (Plan, Axiom) {
    let job = Job::new(RATIONAL, &[oracle::Net::new([1, 1], vec![[0.0, 0.0, 0.0, 1.0]; 4])], Vec::new());
    let mut axiom = job.axiom;
    axiom.roots[0].net = Net { degree: [1, 1], points: points.to_vec() };
    (job.plan, axiom)
}

fn refused(points: [[f32; 4]; 4]) -> String {
    let (plan, axiom) = made(points);
    match burgeon::cpu::derive(&plan, &axiom, &plan::Options::default(), 1) {
        Err(plan::Error::Axiom(text)) => text,
        other => panic!("{:?}", other.map(|(word, _)| word)),
    }
}

#[test]
fn weights_out_of_range_are_refused_with_net_and_point() {
    let one = [1.0, 1.0, 1.0, 1.0];
    for weight in [0.0, -0.0, -1.0, 1e-45, 1e-39, MIN_WEIGHT / 2.0, f32::NAN, f32::INFINITY, 3e38] {
        let text = refused([one, one, [0.0, 0.0, 0.0, weight], one]);
        let said = format!("patch 0 of the axiom: point 2 has the weight {weight}; weights must be positive");
        assert!(text.starts_with(&said), "{text}");
    }
    for x in [1e34, -3e38, f32::NAN, f32::NEG_INFINITY] {
        let text = refused([one, [x, 0.0, 0.0, 1.0], one, one]);
        assert!(text.starts_with("patch 0 of the axiom: point 1 is ["), "{text}");
    }
    let short = Net { degree: [1, 1], points: vec![one; 3] };
    assert_eq!(short.validate(true), Err(NetError::Points { found: 3, expected: 4 }));
    let weighted = Net { degree: [1, 1], points: vec![[1.0, 1.0, 1.0, 2.0]; 4] };
    assert_eq!(weighted.validate(true), Ok(()));
    assert_eq!(weighted.validate(false), Err(NetError::Weight { point: 0, weight: 2.0, rational: false }));
}

/// At both ends of the range nothing under- or overflows, on either backend.
#[test]
fn weights_at_both_ends_of_the_range_are_derived() {
    let [least, most] = [MIN_WEIGHT, MAX_COORDINATE];
    let (plan, axiom) =
        made([[least, 0.0, -least, least], [most, -most, most, most], [0.0, least, 0.0, least], [most; 4]]);
    let options = plan::Options::default();
    let (word, _) = burgeon::cpu::derive(&plan, &axiom, &options, 1).expect("a word");
    word.validate().expect("finite points and positive weights");
    assert!(word.nets.iter().all(|p| (least..=most).contains(&p[3])));
    for (name, engine) in device::engines() {
        let (other, _) = burgeon::gpu::derive(&engine, &plan, &axiom, &options).expect("a word");
        assert!(other == word, "{name}");
    }
}

/// A point written out is what a file holds: x, y, z and a weight.
#[test]
fn a_net_written_out_is_read_like_a_file() {
    let inline = RATIONAL.replace("file \"x\"", "[[(1,2,3,2), (1,0,0,1)], [(0,1,0,0.5), (0.1,0.2,0.3,0.7)]]");
    let system = crate::parity::system(&inline);
    let axiom = Axiom::load::<String>(&system, &mut |_| panic!("it names no file")).expect("an axiom");
    let file = b"1\n1 1\n1 2 3 2\n1 0 0\n0 1 0 0.5\n0.1 0.2 0.3 0.7\n";
    let read = burgeon::io::bpt::parse(file, true).expect("nets");
    for (a, b) in axiom.roots[0].net.points.iter().zip(&read[0].points) {
        // A decimal in a rule is an f32 first, so the product may round once more.
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= f32::EPSILON * b.abs()), "{a:?} {b:?}");
    }
    assert_eq!(axiom.roots[0].net.points[..3], read[0].points[..3]);

    let large = inline.replace("(1,2,3,2)", "(1,1e38,3,10)");
    let system = crate::parity::system(&large);
    let error =
        Axiom::load::<String>(&system, &mut |_| panic!("no file")).expect_err("too large").to_string();
    assert!(error.contains("y of point 0 of this net, 1e38, times its weight, 1e1"), "{error}");
}
