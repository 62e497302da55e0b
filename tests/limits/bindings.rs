//! What is more than a device binds is refused before anything is made, or derived in pieces.

use super::{job, one_group};
use crate::device;
use burgeon::affine::Stencils;
use burgeon::cpu;
use burgeon::curve::{self, Words};
use burgeon::gpu::run::{self, Run};
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::gpu::{self, Engine, Error, Gpu, Measure, Scans, Stencil};
use burgeon::language::{System, Value};
use burgeon::plan::derive::{Backend, StageId};
use burgeon::plan::{self, Given, Options, Plan};
use burgeon::tessellate::{self, Level};

/// A rule that reads a list of so many numbers.
fn listing(length: usize) -> String {
    let list: Vec<String> = (0..length).map(|n| (n * 7 % 1000).to_string()).collect();
    let rules = "P(n) : n < 40 -> [ P(list[n * 300 + 1]) P(n + 30) ; P(list[n]) eps ]";
    let text = one_group("P(n: int)", "P(1) = file \"x\"", rules, "derive 2");
    text.replace("module P", &format!("const list = [{}]\nmodule P", list.join(", ")))
}

/// Bytes of what the rule reads.
fn environment(plan: &Plan) -> u64 {
    let stage = StageId { rule_set: 0, stage: 0 }.of(plan);
    4 * plan.environment(stage, &[], &Given::default()).len() as u64
}

#[test]
fn consts_beyond_a_uniform_are_refused_before_anything_is_made() {
    for (name, engine) in device::engines() {
        let most = engine.device().limits().max_uniform_buffer_binding_size;
        let beside = environment(&job(&listing(4), 1).plan) - 16;
        let longest = ((most - beside) / 4) as usize;
        let job31 = job(&listing(longest), 1);
        assert_eq!(environment(&job31.plan), most, "{name}");
        let expected = job31.word(&mut job31.cpu(1), None, None);
        assert!(job31.word(&mut job31.gpu(&engine), None, None) == expected, "{name}");

        let longer = job(&listing(longest + 1), 1);
        assert!(longer.word(&mut longer.cpu(1), None, None).modules.len() > 3, "the CPU binds nothing");
        let refused = |error: Option<Error>| match error {
            Some(Error::Uniforms { needed, most: said }) => {
                assert_eq!((needed, said), (most + 16, most), "{name}")
            }
            other => panic!("{name}: {other:?}"),
        };
        refused(Gpu::new(&engine, &longer.plan).err());
        refused(gpu::derive(&engine, &longer.plan, &longer.axiom, &Options::default()).err());
        refused(Run::new(&engine, &longer.plan, &longer.axiom, &run::Options::default(), 100).err());
        let (fine, room, level) =
            (tessellate::Options::default(), Capacity::for_vertices(100), Level::world(0.1));
        let (system, axiom) = (&longer.plan.system, &longer.axiom);
        refused(
            Tessellator::of_rules(&engine, system, axiom, &run::Options::default(), &level, &fine, &room)
                .err(),
        );

        // A list that a placement reads.
        let place = listing(longest + 99).replace(
            "run:\n  derive 2\n",
            "place bumps = p + normal * list[id]\nrun:\n  derive 0\n  place bumps\n",
        );
        let system = System::parse(&place).unwrap_or_else(|e| panic!("{e}"));
        let plan = Plan::new(&system).expect("a plan");
        let nets: Vec<_> = longer.axiom.roots.iter().map(|root| root.net.clone()).collect();
        let mut surface = Tessellator::new(&engine, &nets, &level, &fine, &room).expect("a surface");
        match surface.displace(&plan, &plan::Options::default()) {
            Err(Error::Uniforms { needed, most: said }) => assert!(needed > said && said == most, "{name}"),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// A device that binds 64 KiB.
fn narrow() -> Option<Engine> {
    const BYTES: u64 = 1 << 16;
    device::headless()?;
    let adapters = gpu::adapters();
    let adapter = match std::env::var("BURGEON_ADAPTER") {
        Ok(name) => adapters.iter().find(|a| a.get_info().name.to_lowercase().contains(&name.to_lowercase())),
        Err(_) => adapters.first(),
    };
    let required_limits = wgpu::Limits {
        max_storage_buffer_binding_size: BYTES,
        max_buffer_size: BYTES,
        ..wgpu::Limits::defaults()
    };
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter?.request_device(&descriptor)).expect("a device");
    assert_eq!(device.limits().max_storage_buffer_binding_size, BYTES);
    Some(Engine::new(&device, &queue))
}

const TREE: &str = "system tree : curve tree\nmodule P(v: vec2), Q\naxiom: file \"p.csv\"\nrules:\n  \
    P(v) -> P(v) [ Q ] P(v + (1, 0))\nrun:\n  derive 2\n";

#[test]
fn words_beyond_a_binding_are_derived_in_pieces_or_refused() {
    let Some(engine) = narrow() else { return };
    // 1000 nets of 288 bytes become 9,000.
    let text = one_group("P", "P = file \"x\"", "P -> [ P P ; P eps ]", "derive 2");
    let nets = job(&text, 1000);
    let expected = cpu::derive(&nets.plan, &nets.axiom, &Options::default(), 1).expect("a word").0;
    let (word, derivation) =
        gpu::derive(&engine, &nets.plan, &nets.axiom, &Options::default()).expect("a word");
    assert!(word == expected && derivation.chunks.len() > 30, "{} chunks", derivation.chunks.len());

    // A curve in one piece: its axiom does not fit, then what comes of it.
    let system = System::parse(TREE).unwrap_or_else(|e| panic!("{e}"));
    let axiom = |points: usize| {
        let points: Vec<[f32; 4]> = (0..points).map(|n| [n as f32, 0.0, 0.0, 1.0]).collect();
        curve::Axiom::load::<String>(&system, &mut |_| Ok(vec![points.clone().into()])).expect("an axiom")
    };
    let (alone, together) = (Plan::new(&system).expect("a plan"), Plan::of_words(&system).expect("a plan"));
    for (points, after) in [(5000, 0), (2000, 1), (1000, 2), (500, 3)] {
        let refused = |e| match e {
            Error::Plan(plan::Error::TooLong { modules, most, step }) => {
                assert!(
                    modules > most && step == after && after < 3,
                    "{points}: {modules} of {most} after {step}"
                );
            }
            other => panic!("{points}: {other:?}"),
        };
        match gpu::derive(&engine, &alone, &axiom(points), &Options::default()) {
            Ok((word, _)) => assert!(after == 3 && word.modules.len() == 7 * points, "{points}"),
            Err(e) => refused(e),
        }
    }
    // Several words are cut apart between two of them.
    let starts = Words::seeds(&axiom(100), 0..50);
    let expected = cpu::derive(&together, &starts, &Options::default(), 1).expect("words").0;
    assert!(gpu::derive(&engine, &together, &starts, &Options::default()).expect("words").0 == expected);
}

#[test]
fn buffers_beyond_a_binding_are_refused_by_name() {
    let Some(engine) = narrow() else { return };
    let refused = |what: &str, error: Option<Error>| match error {
        Some(Error::Binding { buffer, needed, most }) => {
            assert!(needed > most && most == 1 << 16, "{buffer}")
        }
        other => panic!("{what}: {other:?}"),
    };
    let text = one_group("P(n: int)", "P(0) = file \"x\"", "P(n) -> P(n + 1)", "derive 1");
    let (few, many) = (job(&text, 2), job(&text, 1000));
    let params = run::Options::default();
    refused("an axiom", Run::new(&engine, &many.plan, &many.axiom, &params, 10).err());
    refused("room", Run::new(&engine, &few.plan, &few.axiom, &params, 1000).err());
    let mut run = Run::new(&engine, &few.plan, &few.axiom, &params, 100).expect("a run");
    refused("more room", run.set_capacity(1000).err());
    assert_eq!(run.capacity(), 100);
    let nets: Vec<_> = many.axiom.roots.iter().map(|root| root.net.clone()).collect();
    let (fine, level) = (tessellate::Options::default(), Level::world(0.1));
    let surface = |nets: &[_], vertices| {
        Tessellator::new(&engine, nets, &level, &fine, &Capacity::for_vertices(vertices)).err()
    };
    refused("nets", surface(&nets, 100));
    refused("vertices", surface(&nets[..2], 10_000));
    refused(
        "an upload",
        Gpu::new(&engine, &few.plan)
            .and_then(|mut gpu| {
                let content = many.plan.axiom(&many.axiom, &[])?;
                gpu.upload(content).map(|_| ())
            })
            .err(),
    );
    let scans = Scans::new(&engine).expect("kernels");
    refused("a scan", scans.prepare(Measure::Scan, &vec![1; 20_000]).err());
    let rules = "P(a) < P(v) > P(b) -> P(1/4*a + 3/4*v) P(3/4*v + 1/4*b)";
    let text = format!(
        "system s : curve ring\nmodule P(v: vec2)\naxiom: P((0, 0)) P((1, 0))\nrules:\n  {rules}\nrun:\n  derive 3\n"
    );
    let plan = Plan::new(&System::parse(&text).unwrap_or_else(|e| panic!("{e}"))).expect("a plan");
    let table = Stencils::of_length(&plan, 1000, &Options::default()).expect("a table");
    refused("a table", Stencil::new(&engine, &table).err());
    // The params of each of several words lie in one buffer.
    let text = "system w : curve open\nparam a: vec4 = (0, 0, 0, 0)\nmodule P(v: vec2)\naxiom: P((0, 0))\nrules:\n  \
                P(v) -> P(v + (a.x, 1))\nrun:\n  derive 1\n";
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let axiom = curve::Axiom::load::<String>(&system, &mut |_| Ok(vec![])).expect("an axiom");
    let starts = Words::sweep(&axiom, "a", (0..4000).map(|n| Value::Vec4([n as f32; 4])));
    let plan = Plan::of_words(&system).expect("a plan");
    refused("params", gpu::derive(&engine, &plan, &starts, &Options::default()).err());
    let few = Words { words: starts.words[..1000].to_vec() };
    let expected = cpu::derive(&plan, &few, &Options::default(), 1).expect("words").0;
    assert!(gpu::derive(&engine, &plan, &few, &Options::default()).expect("words").0 == expected);
}

#[test]
fn what_was_warmed_up_derives_and_draws_the_same() {
    let text = one_group(
        "P(n: int), Q",
        "P(0) = file \"x\"",
        "P(n) : n < 2 -> [ P(n + 1) Q ; Q P(n + 1) ]",
        "derive 2",
    );
    let job = job(&text, 3);
    let expected = job.word(&mut job.cpu(1), None, None);
    let nets: Vec<_> = job.axiom.roots.iter().map(|root| root.net.clone()).collect();
    let (fine, room) = (tessellate::Options::default(), Capacity::for_vertices(5000));
    let level = Level::world(0.02);
    for (name, engine) in device::engines() {
        let mut run = Run::new(&engine, &job.plan, &job.axiom, &run::Options::default(), 100).expect("a run");
        run.warm_up().unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut encoder = engine.device().create_command_encoder(&Default::default());
        run.encode(&mut encoder);
        engine.queue().submit([encoder.finish()]);
        let (progress, word) = run.read().expect("a word");
        assert!(progress.complete() && word == expected, "{name}");

        let surface = || Tessellator::new(&engine, &nets, &level, &fine, &room).expect("a surface");
        let (mut cold, mut warm) = (surface(), surface());
        warm.warm_up().unwrap_or_else(|e| panic!("{name}: {e}"));
        let (cold, warm) = (cold.complete().expect("a mesh"), warm.complete().expect("a mesh"));
        assert!(cold.mesh == warm.mesh && cold.mesh.triangles().len() > 100, "{name}");
        let rules = || {
            let params = run::Options::default();
            Tessellator::of_rules(&engine, &job.plan.system, &job.axiom, &params, &level, &fine, &room)
        };
        let (mut cold, mut warm) = (rules().expect("a surface"), rules().expect("a surface"));
        warm.warm_up().unwrap_or_else(|e| panic!("{name}: {e}"));
        warm.reload(&job.plan.system, &job.axiom, &run::Options::default()).expect("the same rules");
        warm.warm_up().unwrap_or_else(|e| panic!("{name}, again: {e}"));
        assert!(cold.complete().expect("a mesh").mesh == warm.complete().expect("a mesh").mesh, "{name}");

        let (mut surface, mut run) = (surface(), run);
        engine.device().destroy();
        assert!(matches!(surface.warm_up(), Err(Error::Lost { .. })), "{name}");
        assert!(matches!(run.warm_up(), Err(Error::Lost { .. })), "{name}");
    }
}
