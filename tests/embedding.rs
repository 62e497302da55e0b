//! The library as a host writes it: words of every kind, params given once, seeds as the command has them, and what
//! does not belong together.

#[cfg(feature = "gpu")]
use crate::device;
use crate::small::Small;
use burgeon::cpu::{self, Cpu};
use burgeon::curve::{self, Words};
use burgeon::language::{System, Value};
use burgeon::patch::{self, Net};
use burgeon::plan::derive::{collect, derive};
use burgeon::plan::{Error, Options, Plan};

/// Chance and a param decide about nets; an argument of the axiom reads the param, too.
const NETS: &str = "\
system nets : patch bezier 1
param seed: int = 7
param depth: int = 3 in 0 .. 6
const twice = depth * 2
module P(n: int), Q(n: int)
axiom: P(depth) = file \"nets\"
rules:
  P(n) : rand() < 0.6 -> [ P(n - 1) Q(twice) ; Q(n) P(n - 1) ]
run:
  derive depth
";

const POINTS: &str = "\
system points : curve ring
param seed: int = 7
param w: float = 1/4
module P(v: vec2), Q(v: vec2), R(v: vec2, k: int)
axiom: P((0, 0)) P((4, 0)) P((4, 3 + w))
rules:
  P(v) : rand() < 0.5 -> P(w*v) Q(v) P(v + (w, 1))
run:
  derive 5
";

fn system(text: &str) -> System {
    System::parse(text).unwrap_or_else(|e| panic!("{e}"))
}

fn nets(count: usize) -> Vec<Net> {
    let net = |n: usize| {
        let x = n as f32 * 2.0;
        let points =
            vec![[x, 0.0, 0.0, 1.0], [x, 0.0, 1.0, 1.0], [x + 1.0, 0.0, 0.0, 1.0], [x + 1.0, 1.0, 1.0, 1.0]];
        Net { degree: [1, 1], points }
    };
    (0..count).map(net).collect()
}

fn patches(system: &System, count: usize) -> patch::Axiom {
    patch::Axiom::load::<String>(system, &mut |_| Ok(nets(count))).expect("an axiom")
}

fn points(system: &System) -> curve::Axiom {
    curve::Axiom::load::<String>(system, &mut |name| Err(format!("{name} is not there"))).expect("an axiom")
}

fn with(name: &str, value: Value) -> Options<'static> {
    Options { set: vec![(name.to_string(), value)], ..Options::default() }
}

#[track_caller]
fn says(error: Option<Error>, text: &str) {
    let error = error.map(|e| e.to_string());
    assert!(error.as_deref().is_some_and(|e| e.contains(text)), "{error:?} does not say `{text}`");
}

#[test]
fn without_a_seed_of_its_own_a_derivation_takes_the_param_seed() {
    let (nets, curves) = (system(NETS), system(POINTS));
    let (roots, axiom) = (patches(&nets, 3), points(&curves));
    let of_nets = |options: &Options| {
        cpu::derive(&Plan::new(&nets).expect("a plan"), &roots, options, 1).expect("a word").0
    };
    let of_points = |options: &Options| {
        cpu::derive(&Plan::new(&curves).expect("a plan"), &axiom, options, 1).expect("a word").0
    };
    let seeded = |seed| Options { seed: Some(seed), ..Options::default() };
    assert_eq!(of_nets(&Options::default()), of_nets(&seeded(7)));
    assert_eq!(of_points(&Options::default()), of_points(&seeded(7)));
    assert_eq!(of_points(&with("seed", Value::Int(9))), of_points(&seeded(9)));
    assert_ne!(of_points(&seeded(9)), of_points(&seeded(7)));
    assert_ne!(of_nets(&seeded(9)), of_nets(&seeded(7)));
    // A seed of its own is stronger than the param, whatever that is.
    assert_eq!(of_points(&Options { seed: Some(9), ..with("seed", Value::Int(3)) }), of_points(&seeded(9)));
    // Without such a param it is 0.
    let none = system(&POINTS.replace("param seed: int = 7\n", ""));
    let word = |options| {
        cpu::derive(&Plan::new(&none).expect("a plan"), &points(&none), &options, 1).expect("a word").0
    };
    assert_eq!(word(Options::default()), word(seeded(0)));
}

#[test]
fn several_words_take_params_and_seed_of_the_run_but_for_their_own() {
    let system = system(POINTS);
    let axiom = points(&system);
    let (together, alone) = (Plan::of_words(&system).expect("a plan"), Plan::new(&system).expect("a plan"));
    let derive_all =
        |starts: &Words, options: &Options| cpu::derive(&together, starts, options, 1).expect("words").0;
    let derive_one = |options: &Options| cpu::derive(&alone, &axiom, options, 1).expect("a word").0;
    let w = |w: f32| with("w", Value::Float(w));
    let swept = Words::sweep(&axiom, "w", [0.25, 0.5].map(Value::Float));
    assert_eq!(derive_all(&swept, &Options::default()), [w(0.25), w(0.5)].map(|o| derive_one(&o)));
    // The run's value of a param that the words set gives way, its seed holds for all.
    let run = Options { seed: Some(11), ..w(0.75) };
    let seeded = |options| Options { seed: Some(11), ..options };
    assert_eq!(derive_all(&swept, &run), [w(0.25), w(0.5)].map(|o| derive_one(&seeded(o))));
    // Words of their own seeds take the run's params.
    let seeds = Words::seeds(&axiom, [3, 4]);
    let own = |seed| Options { seed: Some(seed), ..w(0.75) };
    assert_eq!(derive_all(&seeds, &run), [3, 4].map(|seed| derive_one(&own(seed))));
    // A param `seed` of a word counts, where neither it nor the run has a seed.
    let params = Words::sweep(&axiom, "seed", [5, 6].map(Value::Int));
    let expected = [5, 6].map(|seed| derive_one(&Options { seed: Some(seed), ..Options::default() }));
    assert_eq!(derive_all(&params, &Options::default()), expected);
    says(cpu::derive(&together, &swept, &with("nothing", Value::Int(1)), 1).err(), "no param of points");
}

#[test]
fn one_backend_derives_with_other_params_each_time() {
    let system = system(NETS);
    let (plan, roots) = (Plan::new(&system).expect("a plan"), patches(&system, 2));
    let mut backend = Cpu::new(&plan, 1).expect("threads");
    #[cfg(feature = "gpu")]
    let mut devices: Vec<_> = device::engines()
        .into_iter()
        .map(|(_, engine)| burgeon::gpu::Gpu::new(&engine, &plan).expect("kernels"))
        .collect();
    for depth in [3, 1, 4, 0, 3] {
        let options = with("depth", Value::Int(depth));
        let expected = cpu::derive(&plan, &roots, &options, 1).expect("a word").0;
        assert_eq!(expected.steps, depth as u32);
        let derivation = derive(&roots, &options, &mut backend).expect("a derivation");
        assert_eq!(collect(&mut backend, &derivation).expect("a word"), expected, "depth {depth}");
        #[cfg(feature = "gpu")]
        for gpu in &mut devices {
            let derivation = derive(&roots, &options, gpu).expect("a derivation");
            assert_eq!(collect(gpu, &derivation).expect("a word"), expected, "depth {depth}");
        }
    }
}

#[test]
fn what_is_of_another_plan_is_refused() {
    let (nets, curves) = (system(NETS), system(POINTS));
    let (of_nets, of_points) = (Plan::new(&nets).expect("a plan"), Plan::new(&curves).expect("a plan"));
    let of_words = Plan::of_words(&curves).expect("a plan");
    let (roots, axiom) = (patches(&nets, 2), points(&curves));
    let none = Options::default();
    says(cpu::derive(&of_points, &roots, &none, 1).err(), "points is a curve system");
    says(cpu::derive(&of_words, &roots, &none, 1).err(), "points is a curve system");
    says(cpu::derive(&of_nets, &axiom, &none, 1).err(), "nets is a patch system");
    says(cpu::derive(&of_words, &axiom, &none, 1).err(), "curve::Words");
    says(cpu::derive(&of_nets, &Words::seeds(&axiom, [1]), &none, 1).err(), "Plan::of_words");
    says(cpu::derive(&of_points, &Words::seeds(&axiom, [1]), &none, 1).err(), "Plan::of_words");

    // A word that another plan derived, of the same kind and of another.
    let mut backend = Cpu::new(&of_nets, 1).expect("threads");
    let derivation = derive(&roots, &none, &mut backend).expect("a derivation");
    let mut same = Cpu::new(&of_nets, 2).expect("threads");
    assert!(collect(&mut same, &derivation).is_ok());
    for other in [&Plan::new(&nets).expect("a plan"), &of_points, &of_words] {
        let mut other = Cpu::new(other, 1).expect("threads");
        says(collect(&mut other, &derivation).err(), "a backend of the plan that derived it");
    }

    // Axioms of other systems: a symbol too many, one of other parameters.
    let more = system(
        &NETS.replace("Q(n: int)", "Q(n: int), R, S(x: float)").replace("axiom: P(depth)", "axiom: S(1.5)"),
    );
    says(cpu::derive(&of_nets, &patches(&more, 1), &none, 1).err(), "of another system");
    for (module, args) in
        [("P(n: float)", "P(1.5)"), ("P(n: int, m: vec4)", "P(1, (1, 2, 3, 4))"), ("P", "P")]
    {
        let text = format!("system other : patch bezier 1\nmodule {module}\naxiom: {args} = file \"nets\"\n");
        says(cpu::derive(&of_nets, &patches(&system(&text), 1), &none, 1).err(), "of another system");
    }
    let text = "system other : curve ring\nmodule A, B, C, P(v: vec2)\naxiom: P((0, 0)) P((1, 0))\n";
    says(cpu::derive(&of_points, &points(&system(text)), &none, 1).err(), "of another system");
}

#[cfg(feature = "gpu")]
#[test]
fn recorded_runs_refuse_other_kinds_and_follow_the_param_seed() {
    use burgeon::gpu::run::{Options as Params, Run};
    use burgeon::gpu::tessellate::{Capacity, Tessellator};
    use burgeon::tessellate::{Level, Options as Fine};
    let (nets, curves) = (system(NETS), system(POINTS));
    let roots = patches(&nets, 2);
    let (plan, of_points) = (Plan::new(&nets).expect("a plan"), Plan::new(&curves).expect("a plan"));
    for (name, engine) in device::engines() {
        let refused = Run::new(&engine, &of_points, &roots, &Params::default(), 100).err();
        let refused = refused.map(|e| e.to_string()).unwrap_or_default();
        assert!(refused.contains("points is a curve system"), "{name}: {refused}");
        let (level, room) = (Level::world(0.1), Capacity::for_vertices(100));
        let refused = Tessellator::of_rules(
            &engine,
            &curves,
            &roots,
            &Params::default(),
            &level,
            &Fine::default(),
            &room,
        );
        let refused = refused.err().map(|e| e.to_string()).unwrap_or_default();
        assert!(refused.contains("points is a curve system"), "{name}: {refused}");

        let mut run = Run::new(&engine, &plan, &roots, &Params::default(), 1000).expect("a run");
        for seed in [7, 8, 7] {
            run.set(&[("seed".to_string(), Value::Int(seed))]).expect("a param");
            let mut encoder = engine.device().create_command_encoder(&Default::default());
            run.encode(&mut encoder);
            engine.queue().submit([encoder.finish()]);
            let expected = cpu::derive(&plan, &roots, &with("seed", Value::Int(seed)), 1).expect("a word").0;
            assert_eq!(run.read().expect("a word").1, expected, "{name}, seed {seed}");
        }
    }
}

/// What a host begins with may be more than a backend holds in one piece.
#[test]
fn an_axiom_beyond_one_chunk_is_derived_in_pieces() {
    let (nets, curves) = (system(NETS), system(POINTS));
    let plan = Plan::new(&nets).expect("a plan");
    let roots = patches(&nets, 50);
    let expected = cpu::derive(&plan, &roots, &Options::default(), 1).expect("a word").0;
    let mut small = Small { inner: Cpu::new(&plan, 1).expect("threads"), most: 9 };
    let derivation = derive(&roots, &Options::default(), &mut small).expect("a derivation");
    assert_eq!(collect(&mut small, &derivation).expect("a word"), expected);

    let plan = Plan::new(&curves).expect("a plan");
    let mut axiom = points(&curves);
    axiom.parts = vec![axiom.parts[0].clone(); 40];
    let expected = cpu::derive(&plan, &axiom, &Options::default(), 1).expect("a word").0;
    let mut small = Small { inner: Cpu::new(&plan, 1).expect("threads"), most: 16 };
    let derivation = derive(&axiom, &Options::default(), &mut small).expect("a derivation");
    assert_eq!(collect(&mut small, &derivation).expect("a word"), expected);

    // Several words are cut apart between two of them; one alone, with links, is not.
    let plan = Plan::of_words(&curves).expect("a plan");
    let starts = Words::seeds(&points(&curves), 0..40);
    let expected = cpu::derive(&plan, &starts, &Options::default(), 1).expect("words").0;
    let mut small = Small { inner: Cpu::new(&plan, 1).expect("threads"), most: 100 };
    let derivation = derive(&starts, &Options::default(), &mut small).expect("a derivation");
    assert_eq!(collect(&mut small, &derivation).expect("words"), expected);
    let mut small = Small { inner: Cpu::new(&plan, 1).expect("threads"), most: 2 };
    says(derive(&starts, &Options::default(), &mut small).err(), "3 modules after step 0");
}
