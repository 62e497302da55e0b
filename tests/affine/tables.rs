//! Whole derivations as tables, on the CPU and on devices: they must be what is derived, wherever the points are.

use super::*;
use burgeon::affine::Stencils;
use burgeon::curve::Polyline;

/// Level-dependent weights, and ints in conditions, in patterns and carried along, behind a symbol that is no point.
const LEVELS: &str = "\
system levels : curve open
module P(v: vec3, n: int), Q
axiom: P(_, 2) = file \"p.csv\"
rules:
  # < P(v, n) > P(w, _) -> Q P(v, n) P(mix(v, w, 1 / float(step + 2)), 1)
  P(u, _) < P(v, 2) > P(w, _) let t = float(step + 1) / 16 -> P(t*u + (1 - 2*t)*v + t*w, 1) P((v + w) / 2, 2)
  P(v, n) > P(w, _) : n < 2 && step % 2 == 0 -> P(v, n + 1) P(1/3*v + 2/3*w, n)
  P(v, 3) -> eps
run:
  derive 4
";

/// Systems, and the points of their axioms where a file says them.
fn systems() -> Vec<(System, usize)> {
    let file = "axiom: file \"p.csv\"";
    let chaikin =
        CHAIKIN.replace("axiom: P((0,0)) P((0,1)) P((1,1)) P((1,0))", file).replace("derive 3", "derive 6");
    let open = CHAIKIN_OPEN.replace("axiom: P((0,0,0)) P((1,2,0)) P((3,2,0)) P((4,0,0))", file);
    vec![
        (system(&chaikin, ""), 9),
        (system(&chaikin, ""), 1),
        (system(&chaikin.replace("derive 6", "derive 5 with far"), ""), 5),
        (system(&open, ""), 7),
        (system(CUBIC, ""), 6),
        (system(DLG, ""), 8),
        (system(DLG_OPEN, ""), 5),
        (system(TERNARY, ""), 4),
        (system(UNCHAIKIN, ""), 77),
        (system(LANE_RIESENFELD, "lr"), 6),
        (system(LANE_RIESENFELD, "lr_open"), 12),
        (system(ELEVATE, "elevate2"), 0),
        (system(LEVELS, ""), 9),
    ]
}

/// A derived word and its table, for points that are moved.
struct Case {
    name: String,
    table: Stencils,
    control: Vec<[f32; 4]>,
    derived: Vec<[f32; 3]>,
}

fn cases(turn: u32) -> Vec<Case> {
    let case = |(system, points): (System, usize)| {
        let plan = Plan::new(&system).unwrap_or_else(|e| panic!("{e}"));
        let file = vec![Polyline::from(vec![[0.0, 0.0, 0.0, 1.0]; points])];
        let mut axiom = Axiom::load::<String>(&system, &mut |_| Ok(file.clone())).expect("an axiom");
        let options = Options::default();
        // The table knows nothing of where the points are.
        let table = Stencils::new(&plan, &axiom, &options).unwrap_or_else(|e| panic!("{}: {e}", system.name));
        let control = moved(&mut axiom, turn);
        assert_eq!(Stencils::control(&plan, &axiom, &options).expect("points"), control);
        let (word, _) = cpu::derive(&plan, &axiom, &options, 1).expect("a word");
        Case { name: system.name.clone(), table, control, derived: word.points() }
    };
    systems().into_iter().map(case).collect()
}

impl Case {
    /// Where the curve is another than the derived one.
    fn difference(&self, curve: &[[f32; 4]]) -> Option<String> {
        if curve.len() != self.derived.len() {
            return Some(format!("{}: {} points for {}", self.name, curve.len(), self.derived.len()));
        }
        let greatest = self.control.iter().flatten().fold(0f32, |m, x| m.max(x.abs()));
        let bound = self.table.bound() * f64::from(greatest);
        let far = |(a, b): (&[f32; 4], &[f32; 3])| {
            // A number that is none is near to no other.
            !(0..3).all(|k| (f64::from(a[k]) - f64::from(b[k])).abs() <= bound)
        };
        let n = curve.iter().zip(&self.derived).position(far)?;
        Some(format!("{}, point {n}: {:?} for {:?}, bound {bound:e}", self.name, curve[n], self.derived[n]))
    }
}

#[test]
fn tables_are_what_is_derived_wherever_the_points_are() {
    for turn in [1, 2, 5] {
        for case in cases(turn) {
            let mut curve = vec![[f32::NAN; 4]; case.table.len()];
            cpu::stencil::stencil(&case.table, &case.control, &mut curve);
            assert_eq!(case.difference(&curve), None);
            // Tight enough to tell one weight from another.
            assert!(case.table.bound() < 1e-4, "{}: {}", case.name, case.table.bound());
            let weights: Vec<(usize, f32)> = case.table.row(case.table.len() - 1).collect();
            let sum: f32 = weights.iter().map(|w| w.1).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{}: {weights:?}", case.name);
        }
    }
}

/// Counted as the head of `affine/stencils.rs` and of the kernel says.
#[test]
fn equal_rows_share_their_weights() {
    let text = CHAIKIN.replace("derive 3", "derive 6");
    let plan = Plan::new(&system(&text, "")).expect("a plan");
    let table = Stencils::of_length(&plan, 64, &Options::default()).expect("a table");
    assert_eq!((table.columns(), table.len(), table.weights().len()), (64, 4096, 64 * 3 - 2));
    assert_eq!(table.bytes(), 4096 * 8 + 190 * 4);
    let with_indices: usize = (0..table.len()).map(|n| 4 + 8 * table.row(n).count()).sum();
    // Of every 64 points the first and the last hang on two control points.
    assert_eq!(with_indices, 4096 * 28 - 64 * 2 * 8);
}

#[test]
fn what_has_no_table_is_refused() {
    let of = |text: &str, points: usize| {
        let plan = Plan::new(&system(text, "")).expect("a plan");
        Stencils::of_length(&plan, points, &Options::default()).expect_err("an error").to_string()
    };
    let until = CHAIKIN.replace("derive 3", "derive until terminal max 3");
    assert!(of(&until, 4).contains("until terminal"));
    let many = CHAIKIN.replace("derive 3", "derive 24");
    assert!(of(&many, 4).contains("more than 2097152 modules"));
    assert!(of(CHAIKIN, 0).contains("no points"));
    let mut linked = Plan::new(&system(CHAIKIN, "")).expect("a plan");
    std::sync::Arc::make_mut(&mut linked.tables).layout.link = Some(1);
    let error = Stencils::of_length(&linked, 4, &Options::default()).expect_err("an error").to_string();
    assert!(error.contains("words with branches"), "{error}");
    let sum = "system s : curve open\nmodule P(v: vec2)\naxiom: [(0,0), (1,0)]\nrules:\n  \
               P(a) > P(b) # -> P(a)\n  P(a) > # -> eps\n  # < P(a) > P(b) -> P(a)\n  P(a) > P(b) -> P(1/2*a + 1/2*b)\n\
               run:\n  derive 260\n";
    assert!(of(sum, 600).contains("control points in a row; 256 is the most"), "{}", of(sum, 600));
}

#[cfg(feature = "gpu")]
pub mod on_a_device {
    use super::*;
    use crate::{device, mutants, shaders};
    use burgeon::codegen::{self, Tuning};
    use burgeon::gpu::{Engine, Stencil};

    /// Where the device's curve is another than the derived one: with one table for all frames, the points moved between them.
    fn difference(engine: &Engine, frames: &[Vec<Case>]) -> Option<String> {
        (0..frames[0].len()).find_map(|n| {
            let stencil = Stencil::new(engine, &frames[0][n].table).unwrap_or_else(|e| panic!("{e}"));
            frames.iter().find_map(|cases| {
                stencil.set(&cases[n].control).expect("as many points");
                let label = wgpu::CommandEncoderDescriptor { label: Some("frame") };
                let mut encoder = engine.device().create_command_encoder(&label);
                stencil.encode(&mut encoder);
                engine.queue().submit([encoder.finish()]);
                cases[n].difference(&stencil.read().expect("a curve"))
            })
        })
    }

    #[test]
    fn a_device_follows_the_points() {
        let frames = [1, 3].map(cases);
        for (name, engine) in device::engines() {
            assert_eq!(difference(&engine, &frames), None, "{name}");
            let case = &frames[0][0];
            let stencil = Stencil::new(&engine, &case.table).expect("a table");
            assert!(stencil.set(&case.control[1..]).is_err());
            assert_eq!(stencil.len() as usize, case.derived.len());
        }
    }

    #[test]
    fn the_kernel_translates_to_every_language() {
        for tuning in [Tuning::CPU_DRIVER, Tuning::GPU] {
            let shader = codegen::stencil(&tuning).unwrap_or_else(|e| panic!("{e}"));
            shaders::assert_translates(&shader, "a table");
        }
    }

    pub const MUTANTS: &[mutants::Mutant] = &[
        ("stencil", "if i >= shape.count", "if i + 1u >= shape.count"),
        ("stencil", "row.y & 0xffffffu", "row.y & 0x1u"),
        ("stencil", ">> 24u) + 1u", ">> 24u)"),
        ("stencil", "var at = row.x", "var at = 0u"),
        ("stencil", "sum += weights[k]", "sum = weights[k]"),
        ("stencil", "weights[k] * control[at]", "weights[begin] * control[at]"),
        ("stencil", "at += 1u", "at += 2u"),
        ("stencil", "if at == shape.columns", "if at + 1u == shape.columns"),
        ("stencil", "at = 0u;", "at = 1u;"),
        ("stencil", "curve[i] = sum", "curve[i ^ 1u] = sum"),
    ];

    #[test]
    fn every_mutant_of_the_kernel_is_seen() {
        let Some(headless) = device::headless() else { return };
        let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
        let frames = [1, 3].map(cases);
        let unseen = |&mutant| mutants::unseen(&engine, mutant, |engine| difference(engine, &frames));
        mutants::assert_seen(mutants::sample(MUTANTS).iter().filter_map(unseen));
    }
}
