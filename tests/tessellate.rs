//! Watertight tessellations: the invariants T1 to T8, on closed and open sets of patches in all
//! orientations, with holes, crowded curves and curves that share their ends.

#[cfg(feature = "gpu")]
mod device;
mod invariants;
mod sets;

use burgeon::cpu::tessellate::Tessellator;
use burgeon::io::bpt;
use burgeon::cpu;
use burgeon::language::{System, Value};
use burgeon::patch::{Axiom, Net, Word};
use burgeon::plan::{self, Plan};
use burgeon::tessellate::{Level, Measure, Options};
use invariants::{Checked, check};
use proptest::prelude::*;
use sets::{book, reoriented, scrambled, torus};

fn file(name: &str, rational: bool) -> Vec<Net> {
    bpt::read(format!("{}/examples/data/{name}", env!("CARGO_MANIFEST_DIR")), rational).expect(name)
}

fn tessellated(nets: &[Net], level: &Level, options: &Options) -> Tessellator {
    let mut tessellator = Tessellator::new(nets, options);
    tessellator.run(&level.target().expect("a level"));
    tessellator
}

fn checked(nets: &[Net], level: &Level) -> Checked {
    let tessellator = tessellated(nets, level, &Options::default());
    let world = matches!(level.measure, Measure::World).then_some(level.tolerance);
    check(&tessellator, nets, world)
}

#[test]
fn the_teapot_is_watertight_at_every_tolerance() {
    let nets = file("teapot.bpt", false);
    let mut characteristic = None;
    for tolerance in [0.5, 0.05, 0.01, 0.0025] {
        let found = checked(&nets, &Level::world(tolerance));
        assert_eq!(*characteristic.get_or_insert(found.characteristic), found.characteristic);
        eprintln!("{tolerance}: {found:?}");
    }
}

#[test]
fn closed_rational_surfaces_have_the_euler_characteristic_of_theirs() {
    for (name, expected) in [("torus.bpt", 0), ("sphere.bpt", 2)] {
        for tolerance in [1.0, 0.05, 0.002] {
            let found = checked(&file(name, true), &Level::world(tolerance));
            assert_eq!((found.characteristic, found.border_edges), (expected, 0), "{name} at {tolerance}");
        }
    }
}

#[test]
fn no_orientation_of_the_file_changes_the_mesh() {
    let nets = file("teapot.bpt", false);
    let level = Level::world(0.02);
    let first = tessellated(&nets, &level, &Options::default());
    for seed in 0..6 {
        let (turned, mirrored) = scrambled(&nets, seed);
        let again = tessellated(&turned, &level, &Options::default());
        check(&again, &turned, Some(level.tolerance));
        assert_eq!(first.trees(), again.trees());
        let positions = |t: &Tessellator| t.mesh().positions.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(positions(&first), positions(&again));
        let triangles = first.out().indices.chunks(3).zip(again.out().indices.chunks(3));
        for ((a, b), &cell) in triangles.zip(&first.out().cells) {
            let root = first.trees().nodes[cell as usize].root as usize;
            let turned = if mirrored[root] { [b[0], b[2], b[1]] } else { [b[0], b[1], b[2]] };
            assert_eq!(a, turned);
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let nets = file("teapot.bpt", false);
    let level = Level::world(0.01);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| tessellated(&nets, &level, &Options::default()).out().clone())
    };
    assert_eq!(run(1), run(1));
    assert_eq!(run(1), run(3));
}

#[test]
fn three_patches_on_one_curve_meet_on_it() {
    for pages in 1..=5 {
        for tolerance in [10.0, 0.1, 0.01] {
            let nets = book(pages, pages as u64);
            let found = checked(&nets, &Level::world(tolerance));
            assert!(found.most_on_an_edge == pages.max(2), "{pages} pages: {found:?}");
        }
    }
}

/// The word of an example with its holes kept, and the nets of its axiom.
fn derived(name: &str, set: &[(&str, i32)]) -> (Plan, Word, Vec<Net>) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let text = std::fs::read_to_string(format!("{folder}/{name}.burgeon")).expect(name);
    let system = System::parse(&text).expect(name);
    let plan = Plan::keeping_holes(&system).expect(name);
    let axiom = Axiom::load(&system, &mut |file| bpt::read(format!("{folder}/{file}"), plan.rational()));
    let axiom = axiom.expect(name);
    let set = set.iter().map(|&(name, value)| (name.to_string(), Value::Int(value))).collect();
    let options = plan::Options { set, ..plan::Options::default() };
    let (word, _) = cpu::derive(&plan, &axiom, &options, 0).expect(name);
    (plan, word, axiom.roots.into_iter().map(|root| root.net).collect())
}

#[test]
fn words_with_holes_are_watertight() {
    for (name, set) in [
        ("sierpinski", vec![("depth", 4)]),
        ("sierpinski2", vec![]),
        ("holes", vec![("depth", 3)]),
        ("teapot_lace", vec![]),
        ("fractal", vec![]),
        ("cylinder", vec![]),
        ("sphere", vec![]),
        ("torus", vec![]),
    ] {
        let (plan, word, nets) = derived(name, &set);
        for tolerance in [100.0, 0.02] {
            let mut t = Tessellator::of_word(&nets, &word, plan.hole, &Options::default()).expect(name);
            let level = Level::world(tolerance);
            t.run(&level.target().expect("a level"));
            let found = check(&t, &nets, Some(tolerance));
            eprintln!("{name} at {tolerance}: {found:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn random_closed_sets_are_watertight(
        a in 1u32..4, b in 1u32..4, seed in 0u64..1000, tolerance in prop::sample::select(vec![5.0f32, 0.3, 0.08]),
        least in 0u32..3, orientations in any::<u64>(),
    ) {
        let nets = reoriented(&torus(a, b, seed), orientations).0;
        let level = Level { depth: least..=7, ..Level::world(tolerance) };
        // At depth 7 a tolerance may not be kept.
        let tessellator = tessellated(&nets, &level, &Options::default());
        let found = check(&tessellator, &nets, None);
        prop_assert_eq!((found.characteristic, found.border_edges), (0, 0));
    }
}

#[test]
fn every_kernel_of_a_tessellation_is_valid() {
    use burgeon::codegen::{Tessellation, Tuning, tessellation};
    for degree in [[3, 3], [1, 1], [2, 5], [8, 8]] {
        for (rational, word, seams) in [(false, false, false), (true, true, true)] {
            let options = Options { seams, ..Options::default() };
            let what = Tessellation { degree, rational, word, options };
            for tuning in [Tuning::CPU_DRIVER, Tuning::GPU] {
                tessellation(&what, &tuning).unwrap_or_else(|e| panic!("{what:?}: {e}"));
            }
        }
    }
}
