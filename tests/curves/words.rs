//! Several words at once: each is what it would be alone.

#[cfg(feature = "gpu")]
use crate::device;
use crate::small::Small;
use burgeon::cpu::{self, Cpu};
use burgeon::curve::{Axiom, Start, Word, Words};
use burgeon::language::{System, Value};
use burgeon::plan::derive::{Backend, collect, derive};
use burgeon::plan::{Error, Options, Plan};

/// A ring whose rule has a param, an open word that draws and looks at its ends, a tree with ignored symbols, words
/// that are traced; and such of which chance leaves nothing, or nothing that moves, and which go on from where the turtle
/// starts.
const SYSTEMS: [&str; 7] = [
    "system ring : curve ring\nparam w: float = 1/4\nmodule P(v: vec2)\naxiom: file \"points.csv\"\nrules:\n  \
     P(a) < P(v) > P(b) -> P(w*a + (1 - w)*v) P((1 - w)*v + w*b)\nrun:\n  derive 4\n",
    "system open : curve open\nparam w: float = 1/4\nmodule P(v: vec2), Q\naxiom: file \"points.csv\"\nrules:\n  \
     # < P(v) > P(b) -> P(v) Q P(1/2*v + 1/2*b)\n  Q < P(v) : rand() < w -> eps\n  Q -> eps\n  \
     P(a) < P(v) > # : rand() < 2*w -> P(1/2*a + 1/2*v) P(v)\n  P(v) : rand() < 0.4 -> P(v + (rand(), w)) P(v)\n  \
     P(a) P(b) : a.x > b.x -> P(b)\nrun:\n  derive 6\n",
    "system tree : curve tree\nparam w: float = 1/4\nmodule P(v: vec2), A(k: int), E\nignore + E\n\
     axiom: A(0) [ + A(1) E ] A(2) [ A(3) ]\nrules:\n  A(k) > [ A(j) ] : rand() < w + 0.5 -> A(k + j) E [ + A(k) ] E A(j)\n  \
     E -> eps\n  A(k) < A(j) : rand() < w -> A(k) [ A(j) ]\nrun:\n  derive 5\n",
    "system branches : curve tree\nparam w: float = 90\nmodule P(v: vec2)\naxiom: [ + F ] F [ -(w) F f F ]\nrules:\n  \
     F -> F [ +(w) F ] F\nrun:\n  derive 2\n  trace into P\n",
    "system traced : curve open\nparam w: float = 90\nmodule P(v: vec2)\naxiom: F + F f F\nrules:\n  \
     F -> F +(w) F - F\nrun:\n  derive 3\n  trace into P\n",
    "system vanishing : curve tree\nparam w: float = 90\nmodule P(v: vec2)\naxiom: F [ + F f ] F\nrules:\n  \
     F : rand() < w/300 -> eps\n  F ->(0.3) F [ +(w) F ] f F ->(0.7) F\n  f : rand() < 0.5 -> eps\n\
     rules points:\n  P(v) : rand() < 0.4 -> P(v) P(v + (1, 0))\nrun:\n  derive 6\n  trace into P\n  derive 3 with points\n",
    "system still : curve ring\nparam w: float = 90\nmodule P(v: vec2)\naxiom: F + F + F + F\nrules:\n  \
     F : rand() < w/300 -> +\n  F : rand() < 0.3 -> F F\nrules points:\n  P(v) : rand() < 0.4 -> P(v) P(v + (1, 0))\n  P(a) < P(v) > P(b) -> P(1/2*a + 1/2*v) P(b)\nrun:\n  \
     derive 4\n  trace into P\n  derive 3 with points\n",
];

fn start(system: &System, n: usize) -> Start {
    // Of different lengths, one point and two among them.
    let points = (0..1 + n * 7 % 23).map(|i| [(i * i % 11) as f32, (i * n % 5) as f32, 0.0, 1.0]);
    let points: Vec<[f32; 4]> = points.collect();
    let axiom = Axiom::load::<String>(system, &mut |_| Ok(vec![points.clone().into()])).expect("an axiom");
    // Right angles are traced without rounding.
    let w = if ["traced", "branches", "vanishing", "still"].contains(&system.name.as_str()) {
        90.0 * (n % 5) as f32
    } else {
        n as f32 / 64.0
    };
    Start { axiom: axiom.into(), set: vec![("w".to_string(), Value::Float(w))], seed: Some(1000 + n as u32) }
}

fn words<B: Backend>(words: &Words, backend: &mut B) -> Result<Vec<Word>, B::Error> {
    in_chunks(words, None, backend)
}

/// As many words a chunk as do not pass so many modules.
fn in_chunks<B: Backend>(
    words: &Words,
    chunk_modules: Option<usize>,
    backend: &mut B,
) -> Result<Vec<Word>, B::Error> {
    let options = Options { chunk_modules, ..Options::default() };
    let derivation = derive(words, &options, backend)?;
    collect(backend, &derivation)
}

/// Where a device derives other words than the CPU.
#[cfg(feature = "gpu")]
pub fn difference(engine: &burgeon::gpu::Engine) -> Option<String> {
    for text in &SYSTEMS[1..6] {
        let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
        let plan = Plan::of_words(&system).expect("a plan");
        let starts = Words { words: (0..9).map(|n| start(&system, n)).collect() };
        let expected = words(&starts, &mut Cpu::new(&plan, 1).expect("threads")).expect("words");
        let mut gpu = burgeon::gpu::Gpu::new(engine, &plan).expect("kernels");
        match words(&starts, &mut gpu) {
            Ok(found) if found == expected => {}
            Ok(_) => return Some(format!("{} differs", system.name)),
            Err(e) => return Some(e.to_string()),
        }
    }
    None
}

#[test]
fn each_of_several_words_is_what_it_is_alone() {
    for text in SYSTEMS {
        let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
        let (alone, together) =
            (Plan::new(&system).expect("a plan"), Plan::of_words(&system).expect("a plan"));
        let starts = Words { words: (0..40).map(|n| start(&system, n)).collect() };
        let one = |start: &Start| {
            let options = Options { set: start.set.clone(), seed: start.seed, ..Options::default() };
            cpu::derive(&alone, &*start.axiom, &options, 1).expect("a word").0
        };
        let expected: Vec<Word> = starts.words.iter().map(one).collect();
        assert!(expected.iter().any(|word| word.modules.len() > 30), "{}", system.name);
        let of_points = |word: &&Word| word.modules.len() <= 8 && !word.points().is_empty();
        let empty = system.name == "vanishing" || system.name == "still";
        assert!(!empty || expected.iter().filter(of_points).count() > 2, "{}", system.name);
        let found = words(&starts, &mut Cpu::new(&together, 2).expect("threads")).expect("words");
        assert!(found == expected, "{}", system.name);
        // However the words are cut apart, and where they outgrow what one chunk holds.
        for chunk in [1, 7, 64] {
            let mut cpu = Cpu::new(&together, 2).expect("threads");
            let found = in_chunks(&starts, Some(chunk), &mut cpu).expect("words");
            assert!(found == expected, "{}, chunks of {chunk}", system.name);
        }
        let longest = expected.iter().map(|word| word.modules.len()).max().unwrap_or(0);
        let inner = Cpu::new(&together, 2).expect("threads");
        let mut small = Small { inner, most: longest.max(400) };
        let found = words(&starts, &mut small).expect("words");
        assert!(found == expected, "{}, in small chunks", system.name);
        #[cfg(feature = "gpu")]
        for (name, engine) in device::engines() {
            let mut gpu = burgeon::gpu::Gpu::new(&engine, &together).expect("kernels");
            let found = words(&starts, &mut gpu).expect("words");
            assert!(found == expected, "{}, {name}", system.name);
            let found = in_chunks(&starts, Some(64), &mut gpu).expect("words");
            assert!(found == expected, "{}, {name}, chunks of 64", system.name);
        }
    }
}

#[test]
fn what_is_wrong_with_several_words_is_said() {
    let text = SYSTEMS[0].replace("derive 4", "derive int(w * 8)");
    let system = System::parse(&text).unwrap_or_else(|e| panic!("{e}"));
    let together = Plan::of_words(&system).expect("a plan");
    let mut cpu = Cpu::new(&together, 1).expect("threads");
    let starts = Words { words: vec![start(&system, 16), start(&system, 32)] };
    let wrong = |e: Error| e.to_string();
    let said = words(&starts, &mut cpu).map_err(wrong).expect_err("two schedules");
    assert_eq!(
        said,
        "word 1 has another schedule than word 0: the params in the counts of `run:` must be the same"
    );
    let alone = derive(&*start(&system, 1).axiom, &Options::default(), &mut cpu);
    assert_eq!(
        alone.err().map(wrong).as_deref(),
        Some("a plan of words takes several of them: curve::Words")
    );
    let plain = Plan::new(&system).expect("a plan");
    let starts = Words { words: vec![start(&system, 16)] };
    let said = words(&starts, &mut Cpu::new(&plain, 1).expect("threads")).map_err(wrong);
    assert_eq!(said.expect_err("a plan of one"), "several words need a plan of words: Plan::of_words");
    let chance = SYSTEMS[1].replace("derive 6", "derive until terminal max 6");
    let system = System::parse(&chance).unwrap_or_else(|e| panic!("{e}"));
    let said = Plan::of_words(&system).expect_err("words that end apart").to_string();
    assert_eq!(
        said,
        "this version does not derive `until terminal` beside random numbers or `step`, in several words at once"
    );
}
