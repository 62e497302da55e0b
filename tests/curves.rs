//! Curves: the papers' systems on both backends, their words in closed form, and chunks that nobody sees.

pub mod engines;
mod examples;
mod words;

#[cfg(feature = "gpu")]
use crate::{device, mutants};
use burgeon::cpu::{self, Cpu};
use burgeon::curve::{Axiom, Word};
use burgeon::language::{System, Value};
use burgeon::plan::derive::{Backend, collect, derive};
use burgeon::plan::{Options, Plan};

struct Job {
    plan: Plan,
    axiom: Axiom,
    options: Options<'static>,
}

fn job(text: &str, points: &[[f32; 4]], set: &[(&str, Value)]) -> Job {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(vec![points.to_vec().into()])).expect("an axiom");
    let set = set.iter().map(|(name, value)| (name.to_string(), value.clone())).collect();
    Job { plan, axiom, options: Options { set, ..Options::default() } }
}

impl Job {
    fn on<B: Backend>(
        &self,
        mut backend: B,
        steps: Option<u32>,
        chunk: Option<usize>,
    ) -> Result<Word, B::Error> {
        let options = Options { steps, chunk_modules: chunk, ..self.options.clone() };
        let derivation = derive(&self.axiom, &options, &mut backend)?;
        collect(&mut backend, &derivation)
    }
    fn cpu(&self, steps: Option<u32>, chunk: Option<usize>) -> Word {
        self.on(Cpu::new(&self.plan, 2).expect("threads"), steps, chunk).expect("a word")
    }
}

const CHAIKIN: &str = include_str!("data/language/chaikin.burgeon");

fn square() -> Vec<[f32; 3]> {
    let job = job(CHAIKIN, &[], &[]);
    let (word, derivation) = cpu::derive(&job.plan, &job.axiom, &job.options, 1).expect("a word");
    assert_eq!(derivation.steps.len(), 3);
    word.points()
}

/// S6, S2: the square after one step and three.
#[test]
fn s6_the_square_has_32_points_after_three_steps() {
    let points = square();
    assert_eq!(points.len(), 32);
    let first = job(CHAIKIN, &[], &[]).cpu(Some(1), None).points();
    // P(0) is (0, 0), on its left (1, 0), on its right (0, 1).
    assert_eq!(first[..2], [[0.25, 0.0, 0.0], [0.0, 0.25, 0.0]]);
    assert_eq!(first.len(), 8);
}

/// The CPU adds weighted points of 16 bytes in registers, those of larger records column by column, and what is no such
/// sum in a third way: rounded alike, to the bit.
#[test]
fn sums_of_points_are_rounded_as_the_rule_says() {
    const CHILDREN: [&str; 14] = [
        "v",
        "0.1*a + 0.7*v",
        "v*0.7 + a*0.1 + 0.3*b",
        "0.1*a + (0.7*v + 0.3*b)",
        "(0.1*a + 0.7*v) - 0.3*b",
        "0.1*a - (0.7*v + 0.3*b)",
        "(0.1*a + 0.7*v) + (0.3*b + 0.2*v)",
        "-w*a + v - w*b",
        "-(w*a) - -(0.3*v)",
        "(1 - w)*a + w*w*v + clamp(w, 0, 1)*b",
        "0.3*(a + v)",
        "v/3 + a",
        "a + v + b + 0.1*a + 0.2*v + 0.3*b + 0.4*a + 0.6*v",
        "a + v + b + 0.1*a + 0.2*v + 0.3*b + 0.4*a + 0.6*v + 0.7*b",
    ];
    let point = |n: i32| [0.1 + n as f32 / 7.0, (n * n % 1013) as f32 / 3e4, 1e6 / (n as f32 + 0.3), 1.0];
    let points: Vec<[f32; 4]> = (0..1500).map(point).collect();
    for children in CHILDREN.windows(2) {
        let text = |fields: &str, more: &str| {
            let [first, second] = [children[0], children[1]].map(|child| format!("P({child}{more})"));
            let open = if more.is_empty() { "" } else { ", _, _, _" };
            format!(
                "system s : curve ring\nparam w: float = 0.37\nmodule P({fields})\n\
                 axiom: P(_) = file \"points\"\nrules:\n  P(a{open}) < P(v{open}) > P(b{open}) -> {first} {second}\n\
                 run:\n  derive 2\n"
            )
        };
        for dimensions in ["vec3", "vec2"] {
            let four = text(&format!("v: {dimensions}"), "");
            let more = text(&format!("v: {dimensions}, k: int, l: int, m: int"), ", 1, 2, 3")
                .replace("axiom: P(_) =", "axiom: P(_, 0, 0, 0) =");
            let [four, behind_a_symbol, columns] =
                [four.clone(), four.replace("module P", "module Q, P"), more]
                    .map(|text| job(&text, &points, &[]).cpu(None, None).points());
            assert_eq!(four.len(), 6000);
            assert!(four == columns, "{children:?} of {dimensions}");
            assert!(four == behind_a_symbol, "{children:?} of {dimensions} behind another symbol");
        }
    }
}

#[test]
fn chunks_of_any_size_are_invisible() {
    for chunk in [1, 2, 3, 7, 64] {
        assert_eq!(job(CHAIKIN, &[], &[]).cpu(None, Some(chunk)).points(), square(), "chunks of {chunk}");
    }
}

#[cfg(feature = "gpu")]
#[test]
fn cpu_and_gpu_derive_the_same_curve() {
    for (name, engine) in device::both() {
        let job = job(CHAIKIN, &[], &[]);
        for chunk in [None, Some(1), Some(7)] {
            let gpu = burgeon::gpu::Gpu::new(&engine, &job.plan).expect("kernels");
            assert_eq!(
                job.on(gpu, None, chunk).expect("a word"),
                job.cpu(None, None),
                "{name}, chunks of {chunk:?}"
            );
        }
    }
}

const UNCHAIKIN: &str = include_str!("data/language/unchaikin.burgeon");

fn flat(points: &[[f32; 3]]) -> Vec<[f32; 4]> {
    points.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect()
}

/// S18: reverse(forward(x)) = x, four steps each way, in chunks of any size; another phase gives another curve.
#[test]
fn s18_reverse_chaikin_takes_chaikin_back() {
    let polygon: Vec<[f32; 4]> =
        [[0.0, 0.0], [4.0, 1.0], [5.0, 3.0], [2.0, 6.0], [-1.0, 4.0]].map(|[x, y]| [x, y, 0.0, 1.0]).to_vec();
    let text = CHAIKIN.replace("axiom: P((0,0)) P((0,1)) P((1,1)) P((1,0))", "axiom: file \"polygon.csv\"");
    let forward = job(&text.replace("derive 3", "derive 4"), &polygon, &[]).cpu(None, None);
    assert_eq!(forward.modules.len(), 80);
    let back = |phase: i32| job(UNCHAIKIN, &flat(&forward.points()), &[("phase", Value::Int(phase))]);
    for chunk in [None, Some(1), Some(3), Some(7), Some(64)] {
        let found = back(0).cpu(None, chunk).points();
        let expected: Vec<[f32; 3]> = polygon.iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        assert_eq!(found, expected, "chunks of {chunk:?}");
    }
    assert_ne!(back(1).cpu(None, None).points(), back(0).cpu(None, None).points());
}

/// E12: pairs from left to right, and what is left over is kept: 1925 points of a ring and of an open curve.
#[test]
fn e12_a_leftover_is_kept() {
    let points: Vec<[f32; 4]> = (0..1925).map(|i| [i as f32, (i * i % 17) as f32, 0.0, 1.0]).collect();
    let ring = UNCHAIKIN.to_string();
    let open = UNCHAIKIN.replace("curve ring", "curve open").replace(" shift phase", "");
    for (text, expected) in [(ring, [963, 482, 241, 121]), (open, [964, 483, 243, 123])] {
        let job = job(&text, &points, &[]);
        for chunk in [None, Some(100)] {
            let found = [1, 2, 3, 4].map(|steps| job.cpu(Some(steps), chunk).modules.len());
            assert_eq!(found, expected, "{chunk:?}");
        }
    }
}

/// Pairs, triples and single modules by what they hold, so that claims run into each other.
#[cfg(feature = "gpu")]
const MIXED: &str = "\
system mixed : curve open
module P(v: vec2)
axiom: file \"p.csv\"
rules:
  P(a) P(b) : a.y > 8 -> P(a)
  P(a) : a.y > 5 -> P(a) P(a + (1, 1))
  # < P(a) > P(b) -> P(a) P(b) P(a) P(b)
  P(a) > # -> P(a) P(a + (5, 5)) P(a)
rules triple:
  P(a) P(b) P(c) : b.y > a.y -> P(b) P(a) P(c) P(c)
run:
  derive 2
  derive 1 with triple
";

/// A tree whose branches are erased, ignored and looked into.
#[cfg(feature = "gpu")]
const TREE: &str = "\
system tree : curve tree
module A(k: int), B(k: int), E
ignore + - E
axiom: [ - B(2) A(1) ] A(0) [ + B(1) E B(2) ] E [ - A(3) [ B(4) ] ] E A(5) E A(6)
rules:
  A(k) > [ B(j) ] [ A(i) ] : (k + i) % 2 == 1 -> A(k + 1) [ + B(i) E ] A(j)
  A(k) < B(j) > # : rand() < 0.75 -> E [ B(k) A(j) ] [ B(k + 1) ]
  A(k) > [ B(j) B(j) ] -> B(j) [ - E A(k) [ B(j) ] ] E A(k + 1)
  B(k) A(k) -> A(k)
  E -> eps
  B(k) : k % 3 == 0 -> A(k + 1) [ + B(k) ] E B(k + 1)
  A(k) < A(j) -> E E B(k) E B(k + 2)
  B(k) > B(j) A(_) -> [ B(k) ] [ A(j) ]
  B(k) -> B(k + 1)
run:
  derive 9
";

/// Two symbols that grow alike, in a ring of an odd number of modules.
#[cfg(feature = "gpu")]
const TWO: &str = "\
system two : curve ring
module P(v: vec2), Q(v: vec2)
axiom: P((0, 1)) Q((2, 3)) P((4, 5))
rules:
  P(v) -> P(v) Q(v + (1, 0)) P(v + (1, 1))
  Q(a) -> Q(a) P(a + (0, 1)) Q(2*a)
run:
  derive 5
";

/// One production, and a number of modules that no invocations share evenly.
#[cfg(feature = "gpu")]
const TRIANGLE: &str = "\
system triangle : curve ring
module P(v: vec2)
axiom: P((0, 0)) P((4, 0)) P((0, 4))
rules:
  P(a) < P(v) -> P(1/4*a + 3/4*v) P(v)
run:
  derive 1
";

#[cfg(feature = "gpu")]
fn many() -> Vec<[f32; 4]> {
    (0..1925).map(|i| [i as f32, (i * i % 17) as f32, 0.0, 1.0]).collect()
}

/// Where a device derives another word than the CPU.
#[cfg(feature = "gpu")]
fn difference(engine: &burgeon::gpu::Engine) -> Option<String> {
    use burgeon::codegen::Tuning;
    use burgeon::gpu::Gpu;
    // Tiles so small that claims go from one to the next.
    let small = engine.retuned(Tuning { scan_workgroup: 4, scan_items: 32, ..*engine.tuning() });
    // First those that most mutants are seen by.
    for text in [TREE, MIXED, TWO, TRIANGLE, UNCHAIKIN, CHAIKIN] {
        let job = job(text, &many(), &[]);
        let expected = job.cpu(None, None);
        for (engine, chunk) in [(engine, None), (&small, None), (&small, Some(500))] {
            let gpu = Gpu::new(engine, &job.plan).expect("kernels");
            let found = match job.on(gpu, None, chunk) {
                Ok(found) => found,
                Err(e) => return Some(e.to_string()),
            };
            if found != expected {
                let (found, expected) = (found.modules.len(), expected.modules.len());
                return Some(format!("{}, {chunk:?}: {found} for {expected}", job.plan.system.name));
            }
        }
    }
    words::difference(engine)
}

#[cfg(feature = "gpu")]
#[test]
fn what_is_claimed_is_claimed_alike() {
    for (name, engine) in device::engines() {
        assert_eq!(difference(&engine), None, "{name}");
    }
    assert!(job(TREE, &[], &[]).cpu(None, None).modules.len() > 500);
    let job = job(MIXED, &many(), &[]);
    assert_eq!(job.cpu(None, Some(500)), job.cpu(None, None));
}

#[cfg(feature = "gpu")]
const MUTANTS: &[mutants::Mutant] = &[
    ("emit_word", "if i >= extent.count", "if i + 1u >= extent.count"),
    ("emit_word", "var first = i * CLOSED", "var first = i"),
    ("emit_word", "if i * EACH >= extent.count", "if (i + 1u) * EACH >= extent.count"),
    ("emit_word", "write_children(i * EACH)", "write_children(i)"),
    ("emit_word", "min((i + 1u) * EACH, extent.count) * CLOSED", "(i + 1u) * EACH * CLOSED"),
    ("emit_word", "first = offsets[i]", "first = i"),
    ("emit_word", "offsets[i] - offsets[first_of(i)]", "extent.made + offsets[i]"),
    ("emit_word", "& 255u", "& 1u"),
    ("emit_word", "NONE | (link & LATERAL)", "NONE"),
    ("emit_word", "exit_of(rules[on])) | (link & LATERAL)", "exit_of(rules[on]))"),
    ("emit_word", "offsets[on] + exit_of(rules[on])", "offsets[on]"),
    ("link", "select(SETTLED, 0u, ignored(symbol_at(i)))", "SETTLED"),
    ("link", "up = seen(before)", "up = before | SETTLED"),
    ("link", "if (own & LATERAL) == 0u {", "if true {"),
    ("link", "select(0u, SETTLED, is_last)", "SETTLED"),
    ("link", "jump_in(UP, i)", ""),
    ("link", "jump_in(DOWN, i)", ""),
    ("link", "jump_in(LAST, i)", ""),
    ("link", "jump_in(HANGS, i)", ""),
    ("link", "further | (own & LATERAL)", "further"),
    ("link", "exit_of(rules[before]) != NO_EXIT", "true"),
    ("branches", "link_at(i + n) != i + n - 1u", "false"),
    ("branches", "return true;", "return false;"),
    ("branches", "i = end_of(after)", "i = after + 1u"),
    ("branches", "if ignored(symbol_at(i))", "if false"),
    ("links", "return word_at(i, LINK);", "return i;"),
    ("branches", "low = middle + 1u", "low = middle"),
    ("branches", "word_at(i - 1u, WORD) != word_at(i, WORD)", "false"),
    ("emit_word", "offsets[first_of(i)] | (link & LATERAL)", "NONE | (link & LATERAL)"),
    ("links", "if i >= extent.count {\n    return END;", "if false {\n    return END;"),
    ("rules", "rule_word(rule) >> 24u", "0u"),
    ("claim", "return state - 1u", "return state"),
    ("claim", ">> 16u) & 7u", ">> 17u) & 7u"),
    ("claim", "select(status.claimed, 0u, extent.before == 0u)", "0u"),
    ("compositions", "composed(before, partial[local])", "composed(partial[local], before)"),
    ("compositions", "return partial[local - 1u];", "return partial[local];"),
    ("compositions", "state = composed(state, here)", "state = identity()"),
    ("claim", "rules[i] = KEEP + 1u", "rules[i] = KEEP"),
    ("claim", "status.claimed = after(all, 0u)", "status.claimed = 0u"),
];

#[cfg(feature = "gpu")]
#[test]
fn every_mutant_of_the_kernels_of_curves_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = burgeon::gpu::Engine::new(&headless.device, &headless.queue).keeping_kernels();
    let sample = mutants::sample(MUTANTS);
    mutants::assert_seen(sample.iter().filter_map(|&mutant| mutants::unseen(&engine, mutant, difference)));
}

/// How many mutants of a file are here.
#[cfg(feature = "gpu")]
pub fn mutants_of(file: &str) -> usize {
    MUTANTS.iter().filter(|m| m.0 == file).count()
}

/// A linked word is one buffer; where it no longer fits, the step and the most are named.
#[test]
fn a_tree_that_outgrows_its_buffer_is_refused() {
    let text = "system s : curve tree\nmodule A(k: int)\naxiom: A(0)\nrules:\n  A(k) -> A(k) [ A(k) ] A(k)\nrun:\n  derive 15\n";
    let job = job(text, &[], &[]);
    let refused = cpu::derive(&job.plan, &job.axiom, &job.options, 2).map(|_| ());
    let said = refused.expect_err("14 million modules").to_string();
    assert!(said.starts_with("the word would hold 14348907 modules after step 15"), "{said}");
    assert!(said.contains("one buffer, which holds 8388608"), "{said}");
}
