//! Rules derived with each frame: the mesh of the word that the CPU derives, while params, view and points change.

use super::device::{ROOM, difference, submit};
use super::file;
use crate::{device, mutants};
use burgeon::conformance::tessellation::LACE;
use burgeon::cpu::{self, tessellate::Tessellator as Cpu};
use burgeon::gpu::run::Options as Params;
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::gpu::{Engine, Error};
use burgeon::language::{System, Value};
use burgeon::patch::{Axiom, Net};
use burgeon::plan::{self, Plan, View};
use burgeon::tessellate::{Level, Options};

struct Rules {
    system: System,
    plan: Plan,
    axiom: Axiom,
    nets: Vec<Net>,
}

fn rules(text: &str) -> Rules {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::keeping_holes(&system).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |name| Ok(file(name, false))).expect("an axiom");
    let nets = axiom.roots.iter().map(|root| root.net.clone()).collect();
    Rules { system, plan, axiom, nets }
}

fn view(from: f32) -> View {
    View::looking([from, 2.0, from], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 40.0, [800.0, 600.0])
}

fn set(depth: i32, limit: f32) -> Vec<(String, Value)> {
    vec![("depth".to_string(), Value::Int(depth)), ("limit".to_string(), Value::Float(limit))]
}

/// The word as the CPU derives it, of these points.
fn word(rules: &Rules, params: &Params, points: &[[f32; 4]]) -> burgeon::patch::Word {
    let mut axiom = rules.axiom.clone();
    let mut points = points.iter();
    for point in axiom.roots.iter_mut().flat_map(|root| &mut root.net.points) {
        *point = *points.next().expect("a point");
    }
    let options = plan::Options {
        set: params.set.clone(),
        view: params.view,
        seed: params.seed,
        ..plan::Options::default()
    };
    cpu::derive(&rules.plan, &axiom, &options, 1).expect("a word").0
}

fn points(nets: &[Net]) -> Vec<[f32; 4]> {
    nets.iter().flat_map(|net| net.points.clone()).collect()
}

/// Frame after frame on both; what is not the same.
fn frames(engine: &Engine, rules: &Rules, options: &Options) -> Option<String> {
    let level = Level { hysteresis: 0.5, ..Level::world(0.2) };
    let mut params = Params { set: set(2, 0.6), view: Some(view(6.0)), ..Params::default() };
    let Rules { system, axiom, nets, plan } = rules;
    let mut gpu =
        Tessellator::of_rules(engine, system, axiom, &params, &level, options, &ROOM).expect("a tessellator");
    let mut cpu = Cpu::new(nets, options).expect("patches");
    let mut points = points(nets);
    for (depth, limit, from, tolerance, budget) in [
        (2, 0.6, 6.0, 0.05, None),
        (2, 0.6, 6.0, 0.08, None),
        (3, 0.2, 6.0, 0.08, None),
        (3, 0.4, 3.0, 0.12, None),
        (0, 0.4, 3.0, 0.1, None),
        (1, 0.1, 9.0, 0.14, None),
        (4, 0.05, 9.0, 0.1, Some(9_000)),
        (4, 0.06, 9.0, 0.12, Some(9_000)),
        (4, 0.06, 9.0, 0.12, None),
    ] {
        params.set = set(depth, limit);
        params.view = Some(view(from));
        points.iter_mut().for_each(|p| p[1] *= 1.0625);
        let level = Level { tolerance, budget, ..level.clone() };
        gpu.set_params(&params.set).expect("params");
        gpu.set_view(view(from)).expect("a view");
        gpu.set_points(&points).expect("points");
        gpu.set_level(&level).expect("a level");
        cpu.set_points(&points).expect("points");
        cpu.set_word(&word(rules, &params, &points), plan.hole).expect("a word");
        cpu.run(&level.target().expect("a level"));
        let frame = submit(engine, &mut gpu);
        if !frame.status.complete() || frame.status.module_capacity != ROOM.modules {
            return Some(format!("{:?}", frame.status));
        }
        let found = difference(&cpu, &frame);
        if found.is_some() {
            return found.map(|e| format!("depth {depth}, limit {limit}, from {from}: {e}"));
        }
    }
    None
}

#[test]
fn frames_of_rules_are_those_of_the_words_that_the_cpu_derives() {
    for (name, engine) in device::engines() {
        for seams in [false, true] {
            let options = Options { seams, ..Options::default() };
            assert_eq!(frames(&engine, &rules(LACE), &options), None, "{name}");
        }
    }
}

/// Patches of all eight orientations, some of them but a point, and a param that changes an argument of the axiom.
#[test]
fn words_lie_on_patches_whatever_their_orientation() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let mut rules = rules(&LACE.replace("P(0) =", "P(depth - 2) ="));
    let (mut nets, _) = super::sets::scrambled(&file("teapot.bpt", false), 3);
    let first = nets[7].points[0];
    nets[7].points.iter_mut().for_each(|p| *p = first);
    rules.axiom.roots.iter_mut().zip(&nets).for_each(|(root, net)| root.net = net.clone());
    rules.nets = nets;
    assert_eq!(frames(&engine, &rules, &Options::default()), None);
}

/// A param moves the cells and what displaces them at once; other rules bring another placement, or none.
#[test]
fn what_displaces_follows_the_rules() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let bumps = "place bumps = p + normal * (0.02 * float(depth) * sin(20 * p.y))\nrun:\n";
    let placed = rules(&format!("{}  place bumps\n", LACE.replace("run:\n", bumps)));
    let (level, options) = (Level::world(0.1), Options::default());
    let params = |depth| Params { set: set(depth, 0.4), view: Some(view(6.0)), ..Params::default() };
    let points = points(&placed.nets);
    let mut frames = 0;
    let mut expected = |rules: &Rules, params: &Params| {
        let mut cpu = Cpu::new(&rules.nets, &options).expect("patches");
        cpu.set_word(&word(rules, params, &points), rules.plan.hole).expect("a word");
        let values = plan::Options { set: params.set.clone(), view: params.view, ..plan::Options::default() };
        cpu.displace(&rules.plan, &values).expect("a placement");
        // As many frames as the device has made: they count.
        frames += 1;
        (0..frames).for_each(|_| cpu.run(&level.target().expect("a level")));
        cpu
    };
    let Rules { system, axiom, .. } = &placed;
    let mut gpu = Tessellator::of_rules(&engine, system, axiom, &params(2), &level, &options, &ROOM)
        .expect("a tessellator");
    for depth in [2, 3, 1] {
        gpu.set_params(&params(depth).set).expect("params");
        let frame = submit(&engine, &mut gpu);
        assert_eq!(difference(&expected(&placed, &params(depth)), &frame), None, "depth {depth}");
    }
    let smooth = rules(LACE);
    gpu.reload(&smooth.system, &smooth.axiom, &params(3)).expect("other rules");
    assert_eq!(difference(&expected(&smooth, &params(3)), &submit(&engine, &mut gpu)), None);
    gpu.reload(system, axiom, &params(4)).expect("the rules of before");
    assert_eq!(difference(&expected(&placed, &params(4)), &submit(&engine, &mut gpu)), None);
}

/// A word without room leaves the one before; it says what it wanted, and then there is room.
#[test]
fn a_word_without_room_leaves_the_one_before() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let rules = rules(LACE);
    let (level, options) = (Level::world(0.1), Options::default());
    let mut params = Params { set: set(1, 0.5), view: Some(view(6.0)), ..Params::default() };
    let make = |params: &Params, room: &Capacity| {
        let Rules { system, axiom, .. } = &rules;
        Tessellator::of_rules(&engine, system, axiom, params, &level, &options, room).expect("a tessellator")
    };
    let mut cpu = Cpu::new(&rules.nets, &options).expect("patches");
    let points = points(&rules.nets);
    let first = word(&rules, &params, &points);
    let modules = first.modules.len() as u32 + 10;
    let mut gpu = make(&params, &Capacity { modules, ..ROOM });
    cpu.set_word(&first, rules.plan.hole).expect("a word");
    cpu.run(&level.target().expect("a level"));
    assert_eq!(difference(&cpu, &submit(&engine, &mut gpu)), None);
    gpu.set_params(&set(4, 0.05)).expect("params");
    cpu.run(&level.target().expect("a level"));
    let frame = submit(&engine, &mut gpu);
    assert!(frame.status.modules > modules && !frame.status.complete(), "{:?}", frame.status);
    // The word before is still there, and still follows the camera and the level.
    assert_eq!(difference(&cpu, &frame), None);
    let finer = Level::world(0.03);
    gpu.set_level(&finer).expect("a level");
    cpu.run(&finer.target().expect("a level"));
    assert_eq!(difference(&cpu, &submit(&engine, &mut gpu)), None);
    // Somewhat more, which is still too little: what was drawn is drawn.
    let drawn = submit(&engine, &mut gpu);
    let room = Capacity { modules: modules + 10, ..gpu.capacity() };
    gpu.set_capacity(&room).expect("room");
    let frame = submit(&engine, &mut gpu);
    assert!(!frame.status.complete() && frame.status.skipped != 0, "{:?}", frame.status);
    assert_eq!((frame.draw, &frame.indices), (drawn.draw, &drawn.indices));
    // Room, as often as it takes.
    params.set = set(4, 0.05);
    let mut all = Cpu::new(&rules.nets, &options).expect("patches");
    all.set_word(&word(&rules, &params, &points), rules.plan.hole).expect("a word");
    all.run(&finer.target().expect("a level"));
    let found = gpu.complete().expect("a mesh");
    assert_eq!(found.mesh.indices, all.out().indices);
    assert_eq!(found.sources, all.complete().sources);
    // From room for nothing.
    params.set = set(3, 0.2);
    let found = make(&params, &Capacity::default()).complete().expect("a mesh");
    let mut all = Cpu::new(&rules.nets, &options).expect("patches");
    all.set_word(&word(&rules, &params, &points), rules.plan.hole).expect("a word");
    all.run(&level.target().expect("a level"));
    assert_eq!(found.mesh.indices, all.out().indices);
}

#[test]
fn a_word_that_is_cut_too_fine_is_an_error() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    for (steps, fits) in [(23, true), (24, false), (32, false)] {
        let text = format!(
            "system deep : patch bezier 3\nmodule P, Q\naxiom: P = file \"sheet.bpt\"\nrules:\n  P -> [ P | Q ]\n\
             run:\n  derive {steps}\n"
        );
        let Rules { system, axiom, .. } = rules(&text);
        let (level, options) = (Level::world(1e3), Options::default());
        let mut gpu =
            Tessellator::of_rules(&engine, &system, &axiom, &Params::default(), &level, &options, &ROOM)
                .expect("a tessellator");
        match gpu.complete() {
            Ok(found) => assert!(fits && found.deepest == 23, "{steps} steps: {}", found.deepest),
            Err(e) => assert!(!fits && e.to_string().contains("more than 23 times"), "{e}"),
        }
    }
}

/// Other rules come with the next frame; wrong ones leave those that are there.
#[test]
fn rules_are_reloaded_or_nothing_changes() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let old = rules(LACE);
    let (level, options) = (Level::world(0.1), Options::default());
    let params = Params { set: set(2, 0.5), view: Some(view(6.0)), ..Params::default() };
    let Rules { system, axiom, .. } = &old;
    let mut gpu = Tessellator::of_rules(&engine, system, axiom, &params, &level, &options, &ROOM)
        .expect("a tessellator");
    let expected = |rules: &Rules, params: &Params, points: &[[f32; 4]]| {
        let mut cpu = Cpu::new(&rules.nets, &options).expect("patches");
        cpu.set_points(points).expect("points");
        cpu.set_word(&word(rules, params, points), rules.plan.hole).expect("a word");
        cpu.run(&level.target().expect("a level"));
        cpu.out().indices.clone()
    };
    let mut points = points(&old.nets);
    points.iter_mut().for_each(|p| p[0] *= 1.5);
    gpu.set_points(&points).expect("points");
    assert_eq!(submit(&engine, &mut gpu).indices, expected(&old, &params, &points));
    // A param that is none, and rules that want a view that is not given.
    for wrong in [
        Params { set: vec![("no".to_string(), Value::Int(1))], ..params.clone() },
        Params { view: None, ..params.clone() },
    ] {
        assert!(matches!(gpu.reload(system, axiom, &wrong), Err(Error::Plan(_))));
        assert_eq!(submit(&engine, &mut gpu).indices, expected(&old, &params, &points));
    }
    // More words a record, another symbol for holes, no params.
    let text = "system other : patch bezier 3\nmodule A(a: int, b: vec3, c: int), B, C, D\n\
                axiom: A(0, (1, 2, 3), 0) = file \"teapot.bpt\"\n\
                rules:\n  A(a, b, c) : a < 2 -> [ A(a + 1, b, c) eps ; B A(c, b, a + 2) ]\nrun:\n  derive 3\n";
    let new = rules(text);
    let none = Params::default();
    let vertices = gpu.vertices().clone();
    gpu.reload(&new.system, &new.axiom, &none).expect("other rules");
    assert_eq!(*gpu.vertices(), vertices, "what is drawn is where it was");
    assert_eq!(submit(&engine, &mut gpu).indices, expected(&new, &none, &points));
    assert!(gpu.set_params(&set(1, 0.5)).is_err());
    // Other patches: everything anew, where the file has them.
    let mut other = rules(text);
    other.axiom.roots.truncate(9);
    other.nets.truncate(9);
    gpu.reload(&other.system, &other.axiom, &none).expect("other patches");
    let points = super::rules::points(&other.nets);
    assert_eq!(submit(&engine, &mut gpu).indices, expected(&other, &none, &points));
    // A tessellation without rules has none to change.
    let mut plain = Tessellator::new(&engine, &old.nets, &level, &options, &ROOM).expect("a tessellator");
    assert!(matches!(plain.reload(system, axiom, &params), Err(Error::NoRules)));
    assert!(matches!(plain.set_params(&set(1, 0.5)), Err(Error::Plan(_))));
}

/// Nothing is made between frames, whatever changes from one to the next.
#[test]
fn frames_of_rules_make_nothing() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue);
    let Rules { system, axiom, nets, .. } = rules(LACE);
    let params = Params { set: set(4, 0.5), view: Some(view(6.0)), ..Params::default() };
    let (level, options) = (Level::world(0.1), Options::default());
    let mut gpu = Tessellator::of_rules(&engine, &system, &axiom, &params, &level, &options, &ROOM)
        .expect("a tessellator");
    let mut points = points(&nets);
    let mut first = None;
    for (frame, depth) in [4, 3, 0, 4, 2, 4, 1].into_iter().enumerate() {
        gpu.set_params(&set(depth, 0.2 + depth as f32)).expect("params");
        gpu.set_view(view(3.0 + depth as f32)).expect("a view");
        points.iter_mut().for_each(|p| p[2] *= 0.99);
        gpu.set_points(&points).expect("points");
        let mut encoder = engine.device().create_command_encoder(&Default::default());
        let before = super::device::made(&engine);
        gpu.encode(&mut encoder);
        let after = super::device::made(&engine);
        assert_eq!(before, after, "frame {frame}");
        engine.queue().submit([encoder.finish()]);
        engine.device().poll(wgpu::PollType::wait_indefinitely()).expect("a frame");
        assert_eq!(*first.get_or_insert(super::device::made(&engine)), super::device::made(&engine));
    }
    let status = gpu.status().expect("a status");
    assert!(status.complete() && status.frame == 7, "{status:?}");
}

/// The kernels that take the word in, broken on purpose.
const MUTANTS: &[mutants::Mutant] = &[
    ("recall", "k >= progress.modules", "k + 1u >= progress.modules"),
    ("recall", "records[k * source.quads + 1u]", "records[k * source.quads]"),
    ("recall", "head.x >> 24u);", "head.x >> 16u);"),
    ("recall", "(orientation & 1u) != 0u", "false"),
    ("recall", "(orientation & 2u) != 0u", "false"),
    ("recall", "select(depth, depth.yx, across)", "depth"),
    ("recall", "symbol == source.hole ||", ""),
    ("recall", "|| is_void(root)", ""),
    ("recall", "(symbol & 0x7fffu) << 16u", "0u"),
    ("recall", "= leaf_at(root, shape, c.zw)", "= NOWHERE"),
    ("source", "hole: u32,\n  // Slots of the table.\n  slots: u32", "slots: u32,\n  hole: u32"),
    ("adopt", "adopted = select(0u, 1u, whole)", "adopted = 0u"),
    ("adopt", "workgroups(ranges[0], WORKGROUP)", "workgroups(ranges[0] / 2u, WORKGROUP)"),
    ("adopt", "status[10] = progress.capacity", "status[10] = 0u"),
    ("enter", "k >= range.count", "k + 1u >= range.count"),
    ("enter", "atomicStore(&table[SLOTS + k], 0u)", "atomicLoad(&table[SLOTS + k])"),
    ("enter", "nodes[k] = leaves[k]", "nodes[k] = leaves[0]"),
    ("enter", "atomicAdd(&shapes[shape_of(n)], 1u)", "atomicAdd(&shapes[0], 1u)"),
    ("enter", "k + 1u);", "k);"),
    ("enter", "if found.old_value != 0u", "if found.old_value == 0u"),
    ("enter", "(s % LEVELS) << 8u", "(s % LEVELS) << 9u"),
    ("enter", "atomicStore(&table[0], all)", "atomicStore(&table[0], 1u)"),
    ("hash", "return h ^ (h >> 13u)", "return root * 2u"),
    ("table", "slot = (slot + 1u) & mask", "slot = slot & mask"),
    ("decide", "} else if DERIVED {", "} else if false {"),
];

#[test]
fn every_mutant_of_the_word_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let rules = {
        let mut rules = rules(LACE);
        let (mut nets, _) = super::sets::scrambled(&file("teapot.bpt", false), 3);
        let first = nets[7].points[0];
        nets[7].points.iter_mut().for_each(|p| *p = first);
        rules.axiom.roots.iter_mut().zip(&nets).for_each(|(root, net)| root.net = net.clone());
        rules.nets = nets;
        rules
    };
    let whole = Options { format: super::kernels::formats()[0], ..Options::default() };
    let differs = |engine: &Engine| frames(engine, &rules, &whole);
    assert_eq!(differs(&engine), None, "without a mutant");
    let sample = mutants::sample(MUTANTS);
    mutants::assert_seen(sample.iter().filter_map(|&mutant| mutants::unseen(&engine, mutant, differs)));
}

/// Whether a file has mutants here.
pub fn breaks(file: &str) -> bool {
    MUTANTS.iter().any(|m| m.0 == file)
}
