//! Rules as matrices: what the papers say of schemes, matrices as rules again, and whole derivations as tables.

#[cfg(feature = "gpu")]
use crate::{device, shaders};
use burgeon::affine::infer::{self, InferError};
use burgeon::affine::{Error, Matrix, Number, Rules, Stencils};
use burgeon::cpu;
use burgeon::curve::Axiom;
use burgeon::language::rational::Rational;
use burgeon::language::{Expr, System, Type, Value, Vocabulary, compile};
use burgeon::plan::{Options, Plan};
use proptest::prelude::*;

const CHAIKIN: &str = include_str!("data/language/chaikin.burgeon");
const CHAIKIN_OPEN: &str = include_str!("data/language/chaikin_open.burgeon");
const CUBIC: &str = include_str!("data/language/cubic.burgeon");
const DLG: &str = include_str!("data/language/dlg.burgeon");
const DLG_OPEN: &str = include_str!("data/language/four_point_open.burgeon");
const ELEVATE: &str = include_str!("data/language/elevate.burgeon");
const LANE_RIESENFELD: &str = include_str!("data/language/lane_riesenfeld.burgeon");
const TERNARY: &str = include_str!("data/language/ternary.burgeon");
const UNCHAIKIN: &str = include_str!("data/language/unchaikin.burgeon");

/// The system of this name, or the last.
fn system(text: &str, name: &str) -> System {
    let checked = compile(text, &Vocabulary::default());
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let named = checked.systems.iter().find(|s| s.name == name);
    named.or(checked.systems.last()).expect("a system").clone()
}

fn rules(text: &str, with: &str) -> Rules {
    let with: Vec<&str> = with.split_whitespace().collect();
    Rules::new(&system(text, ""), &with, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A row a line, its fractions with spaces between.
fn text(matrix: &Matrix) -> String {
    let row =
        |r: usize| (0..matrix.columns).map(|c| matrix.get(r, c).to_string()).collect::<Vec<_>>().join(" ");
    (0..matrix.rows.len()).map(row).collect::<Vec<_>>().join("\n")
}

// --- matrices --------------------------------------------------------------------------------------

/// S2: equations 9–12 of the paper.
#[test]
fn s2_chaikin_as_a_matrix() {
    let expected = "3/4 0 0 1/4\n3/4 1/4 0 0\n1/4 3/4 0 0\n0 3/4 1/4 0\n0 1/4 3/4 0\n0 0 3/4 1/4\n0 0 1/4 3/4\n1/4 0 0 3/4";
    assert_eq!(text(&rules(CHAIKIN, "").matrix(4, 0).expect("a matrix")), expected);
}

/// S13: equation 27, 2n − 2 rows.
#[test]
fn s13_open_chaikin_as_a_matrix() {
    let expected = "1 0 0 0\n1/2 1/2 0 0\n0 3/4 1/4 0\n0 1/4 3/4 0\n0 0 1/2 1/2\n0 0 0 1";
    assert_eq!(text(&rules(CHAIKIN_OPEN, "").matrix(4, 0).expect("a matrix")), expected);
}

/// The mask, the degrees generated and reproduced, the place of the first new point, and the eigenvalues.
fn portrait(text: &str, with: &str) -> String {
    let scheme = rules(text, with).scheme(0).unwrap_or_else(|e| panic!("{e}"));
    let mask: Vec<String> = scheme.mask().expect("a mask").1.iter().map(Number::to_string).collect();
    let degree = |d: Option<u32>| d.map_or("-".to_string(), |d| d.to_string());
    let eigenvalues = scheme.eigenvalues().unwrap_or_default();
    let eigenvalues: Vec<String> = eigenvalues.iter().map(|x| x.to_string()).collect();
    let (generates, reproduces) = (degree(scheme.generates()), degree(scheme.reproduces()));
    format!("{} | {generates} {reproduces} {} | {}", mask.join(" "), scheme.shift(), eigenvalues.join(" "))
}

/// S10, S11, S17: all forms of a rule are one scheme, moved.
#[test]
fn schemes_are_what_the_paper_says() {
    for (with, shift) in [("", "-1/4"), ("left", "-3/4"), ("right", "1/4"), ("far", "5/4")] {
        let expected = format!("1/4 3/4 3/4 1/4 | 2 1 {shift} | 1 1/2 1/4 1/4");
        assert_eq!(portrait(CHAIKIN, with), expected, "chaikin {with}");
    }
    for (with, shift) in [("", "0"), ("shifted", "-1/2")] {
        let expected = format!("1/8 1/2 3/4 1/2 1/8 | 3 1 {shift} | 1 1/2 1/4 1/8 1/8");
        assert_eq!(portrait(CUBIC, with), expected, "cubic {with}");
        let expected = format!("-1/16 0 9/16 1 9/16 0 -1/16 | 3 3 {shift} | 1 1/2 1/4 1/4 1/8 -1/16 -1/16");
        assert_eq!(portrait(DLG, with), expected, "dlg {with}");
    }
    let ternary = "-4/99 -7/99 0 34/99 76/99 1 76/99 34/99 0 -7/99 -4/99 | 2 2 0 | 1 1/3 1/9 1/11 1/99";
    assert_eq!(portrait(TERNARY, ""), ternary);
    assert_eq!(portrait(UNCHAIKIN, ""), "-1/4 3/4 3/4 -1/4 | - 1 1/2 | ");
}

/// Away from 1/16 the four-point scheme loses its quadratics.
#[test]
fn a_param_decides_what_is_reproduced() {
    let of = |w: f32| {
        let set = [("w".to_string(), Value::Float(w))];
        let scheme = Rules::new(&system(DLG, ""), &[], &set).and_then(|rules| rules.scheme(0));
        let scheme = scheme.unwrap_or_else(|e| panic!("{e}"));
        (scheme.generates(), scheme.reproduces())
    };
    assert_eq!(of(0.0625), (Some(3), Some(3)));
    assert_eq!(of(0.05), (Some(1), Some(1)));
}

#[test]
fn a_step_and_other_fields_are_read() {
    let text = "system s : curve ring\nmodule P(v: vec2, n: int)\naxiom: P((0,0), 3) P((1,0), 3)\nrules:\n  \
                P(v, n) > P(w, _) : n > 2 -> P(v, n) P(mix(v, w, float(step + 1) / float(n + 4)), n)\n  P(v, n) -> eps\n";
    assert_eq!(self::text(&rules(text, "").matrix(2, 0).expect("a matrix")), "1 0\n6/7 1/7\n0 1\n1/7 6/7");
    assert_eq!(self::text(&rules(text, "").matrix(2, 2).expect("a matrix")), "1 0\n4/7 3/7\n0 1\n3/7 4/7");
}

/// What is no affine subdivision rule is named with its place.
#[test]
fn what_is_not_affine_is_named() {
    let cases = [
        ("P(v) > P(w) -> P(v + rotate(w - v, 60)/3)", "rotate(w - v, 60)", "`rotate` of a point"),
        ("P(v) : v.x > 0 -> P(v) P(v)", "v.x", "a single coordinate"),
        ("P(v) -> P(v + (1, 1))", "v + (1, 1)", "stands still is added"),
        ("P(v) > P(w) let t = length(w - v) -> P(t*v)", "length(w - v)", "`length` of a point"),
        ("P(v) > P(w) -> P(v*w)", "v*w", "multiplied with each other"),
        ("P(v) -> P(rand()*v)", "rand()", "random"),
        ("P(v) > P(w) -> (1) P(v) -> (2) P(w)", "P(v) > P(w) -> (1) P(v) -> (2) P(w)", "drawn at random"),
        ("P(v) -> P((1, 2))", "(1, 2)", "stands still"),
        ("P(v) > P(w) -> P(max(v, w))", "max(v, w)", "`max` of a point"),
    ];
    for (rule, place, reason) in cases {
        let text =
            format!("system s : curve ring\nmodule P(v: vec2)\naxiom: [(0,0), (1,0)]\nrules:\n  {rule}\n");
        match Rules::new(&system(&text, ""), &[], &[]).and_then(|rules| rules.matrix(6, 0)) {
            Err(Error::NotAffine { what, span }) => {
                assert!(what.contains(reason), "{rule}: {what}");
                assert_eq!(&text[span.start as usize..span.end as usize], place, "{rule}");
            }
            other => panic!("{rule}: {other:?}"),
        }
    }
}

// --- matrices as rules -----------------------------------------------------------------------------

/// The production of an inferred file.
fn production(text: &str) -> &str {
    text.lines().find(|line| line.contains("->")).expect("a rule").trim()
}

/// S9: the matrix of a rule gives the rule; with another shift the rule that the paper writes for it.
#[test]
fn s9_the_matrix_of_a_rule_gives_the_rule() {
    let rotated = [
        (CHAIKIN, 0, "P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)"),
        (CHAIKIN, -1, "P(vl) < P(v) -> P(3/4*vl + 1/4*v) P(1/4*vl + 3/4*v)"),
        (CHAIKIN, 1, "P(v) > P(vr) -> P(3/4*v + 1/4*vr) P(1/4*v + 3/4*vr)"),
        (CHAIKIN, 3, "P(_) > P(vr) P(vrr) -> P(3/4*vr + 1/4*vrr) P(1/4*vr + 3/4*vrr)"),
        (CUBIC, 0, "P(vl) < P(v) > P(vr) -> P(1/8*vl + 3/4*v + 1/8*vr) P(1/2*v + 1/2*vr)"),
        (CUBIC, -1, "P(vl) < P(v) > P(vr) -> P(1/2*vl + 1/2*v) P(1/8*vl + 3/4*v + 1/8*vr)"),
        (DLG, 0, "P(vl) < P(v) > P(vr) P(vrr) -> P(v) P(-1/16*vl + 9/16*v + 9/16*vr - 1/16*vrr)"),
        (DLG, -1, "P(vll) P(vl) < P(v) > P(vr) -> P(-1/16*vll + 9/16*vl + 9/16*v - 1/16*vr) P(v)"),
        (
            TERNARY,
            0,
            "P(vl) < P(v) > P(vr) P(vrr) -> P(v) P(-7/99*vl + 76/99*v + 34/99*vr - 4/99*vrr) \
             P(-4/99*vl + 34/99*v + 76/99*vr - 7/99*vrr)",
        ),
        (UNCHAIKIN, 0, "P(vl) < P(va) P(vb) > P(vr) -> P(-1/4*vl + 3/4*va + 3/4*vb - 1/4*vr)"),
    ];
    for (text, shift, expected) in rotated {
        let matrix = rules(text, "").matrix(12, 0).expect("a matrix");
        let found = infer::infer(&matrix, shift, "found").unwrap_or_else(|e| panic!("{expected}: {e}"));
        assert_eq!(production(&found), expected);
        turned(&matrix, &found, shift);
    }
    for (text, with) in [(CHAIKIN, "left"), (CHAIKIN, "far"), (CUBIC, "shifted"), (DLG, "shifted")] {
        let matrix = rules(text, with).matrix(12, 0).expect("a matrix");
        turned(&matrix, &infer::infer(&matrix, 0, "found").expect("a rule"), 0);
    }
}

/// The inferred rule's matrix is the given one turned by the shift.
#[track_caller]
fn turned(matrix: &Matrix, found: &str, shift: i64) {
    let again = rules(found, "").matrix(matrix.columns, 0).expect("a matrix");
    let n = matrix.rows.len();
    assert_eq!(again.rows.len(), n, "{found}");
    for r in 0..n {
        let from = (r as i64 + shift).rem_euclid(n as i64) as usize;
        for c in 0..matrix.columns {
            assert_eq!(again.get(r, c).exact(), matrix.get(from, c).exact(), "row {r}, column {c}: {found}");
        }
    }
}

fn refused(text: &str, shift: i64) -> InferError {
    infer::parse(text).and_then(|m| infer::infer(&m, shift, "s")).expect_err("an error")
}

#[test]
fn what_no_rule_has_is_named_by_row_and_column() {
    let chaikin = self::text(&rules(CHAIKIN, "").matrix(6, 0).expect("a matrix")).replace(' ', ",");
    assert!(infer::parse(&chaikin).and_then(|m| infer::infer(&m, 0, "s")).is_ok());
    let period = chaikin.replacen("0,1/4,3/4,0", "0,1/5,3/4,0", 1);
    let cases: [(&str, i64, &str); 9] = [
        ("", 0, "the matrix is empty"),
        ("1,0\n1", 0, "row 2 ends at column 1, row 1 at column 2"),
        ("1,0\n1,3/x", 0, "row 2, column 2: `3/x` is no number"),
        ("1,0\n1,", 0, "row 2, column 2: `` is no number"),
        ("1,1/0", 0, "row 1, column 2: `1/0` is no number"),
        ("1,0\n0,1\n1,0", 0, "3 rows and 2 columns: neither number is a multiple of the other"),
        (
            &period,
            0,
            "row 5, column 2: not periodic: 1/5 stands here, and 1/4 one module before, in row 3, column 1",
        ),
        ("1,2,3\n3,1,2\n2,3,1", 0, "row 1, column 3: not banded"),
        (
            &chaikin,
            20,
            "row 9, column 5: this entry asks for a context 10 deep on the right; contexts are at most 8 deep",
        ),
    ];
    for (text, shift, expected) in cases {
        let found = refused(text, shift).to_string();
        assert!(found.contains(expected), "{found}\n{expected}");
    }
    let identity = infer::parse("1,0\n0,1").expect("a matrix");
    for name in ["a b", "rules", "", "1a", "s : curve open\n//"] {
        assert_eq!(infer::infer(&identity, 0, name), Err(InferError::Name(name.to_string())));
    }
    assert_eq!(production(&infer::infer(&identity, 0, "s").expect("a rule")), "P(v) -> P(v)");
}

/// A periodic matrix of c new points a point: coefficients n/8 at places from −3 on.
fn banded(ring: usize, lines: &[Vec<i32>]) -> String {
    let row = |r: usize| {
        let (i, j) = (r / lines.len(), r % lines.len());
        let mut row = vec![0; ring];
        for (k, n) in lines[j].iter().enumerate() {
            row[(i + k + ring - 3) % ring] += n;
        }
        row.iter().map(|n| format!("{n}/8")).collect::<Vec<_>>().join(", ")
    };
    (0..ring * lines.len()).map(row).collect::<Vec<_>>().join("\n")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// What the engine derives with the inferred rule is the product of matrix and points.
    #[test]
    fn an_inferred_rule_is_its_matrix(
        ring in 8usize..14,
        lines in prop::collection::vec(prop::collection::vec(-8i32..9, 1..7), 1..5),
        shift in -5i64..6,
    ) {
        let matrix = infer::parse(&banded(ring, &lines)).expect("a matrix");
        let found = infer::infer(&matrix, shift, "found").unwrap_or_else(|e| panic!("{e}"));
        turned(&matrix, &found, shift);
        let system = system(&found, "");
        let plan = Plan::new(&system).expect("a plan");
        let mut axiom = Axiom::load::<String>(&system, &mut |_| Err("no file".into())).expect("an axiom");
        let control = moved(&mut axiom, 1);
        let (word, _) = cpu::derive_curve(&plan, &axiom, &Options::default(), 1).expect("a word");
        let n = matrix.rows.len();
        prop_assert_eq!(word.modules.len(), n);
        for (r, point) in word.points().iter().enumerate() {
            let row = &matrix.rows[(r as i64 + shift).rem_euclid(n as i64) as usize];
            for axis in 0..2 {
                let exact: f64 = row.iter().map(|(c, x)| x.to_f64() * f64::from(control[*c as usize][axis])).sum();
                // Seven products and sums of numbers up to 8.
                prop_assert!((exact - f64::from(point[axis])).abs() < 1e-5, "{exact} {point:?}");
            }
        }
    }

    /// A fraction of small numbers is found again in the float that it became.
    #[test]
    fn a_fraction_is_found_in_its_float(n in -4096i128..4097, d in 1i128..4097) {
        let fraction = Rational::new(n, d.max(n.abs())).expect("a fraction");
        prop_assert_eq!(Rational::nearest_simple(fraction.to_f32().expect("a float")), Some(fraction));
    }
}

// --- derivations as tables -------------------------------------------------------------------------

/// Puts other points into an axiom, a spiral that `turn` turns, and says what they are.
fn moved(axiom: &mut Axiom, turn: u32) -> Vec<[f32; 4]> {
    let mut points = Vec::new();
    for root in axiom.parts.iter_mut().flat_map(|part| &mut part.modules) {
        let Some(arg) = root.args.iter_mut().find(|arg| matches!(arg.ty, Type::Vec2 | Type::Vec3)) else {
            continue;
        };
        let angle = (points.len() as f32 + 1.0) * 0.7 * turn as f32;
        let p = [angle.cos() * (1.0 + angle * 0.01), angle.sin() * 2.0, (angle * 0.3).cos()];
        let (value, z) = match arg.ty {
            Type::Vec2 => (Value::Vec2([p[0], p[1]]), 0.0),
            _ => (Value::Vec3(p), p[2]),
        };
        *arg = Expr::literal(value, arg.span);
        points.push([p[0], p[1], z, 1.0]);
    }
    points
}

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
        let file = vec![vec![[0.0, 0.0, 0.0, 1.0]; points]];
        let mut axiom = Axiom::load::<String>(&system, &mut |_| Ok(file.clone())).expect("an axiom");
        let options = Options::default();
        // The table knows nothing of where the points are.
        let table = Stencils::new(&plan, &axiom, &options).unwrap_or_else(|e| panic!("{}: {e}", system.name));
        let control = moved(&mut axiom, turn);
        assert_eq!(Stencils::control(&plan, &axiom, &options).expect("points"), control);
        let (word, _) = cpu::derive_curve(&plan, &axiom, &options, 1).expect("a word");
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
            // A number that is none is far from all.
            (0..3).any(|k| !((f64::from(a[k]) - f64::from(b[k])).abs() <= bound))
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
    assert_eq!((table.columns(), table.len(), table.weights().len()), (64, 4096, 64 * 3));
    assert_eq!(table.bytes(), 4096 * 8 + 64 * 3 * 4);
    let with_indices: usize = (0..table.len()).map(|n| 4 + 8 * table.row(n).count()).sum();
    assert_eq!(with_indices, 4096 * 28);
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
    assert!(of(&many, 4).contains("more than 8388608 modules"));
    assert!(of(CHAIKIN, 0).contains("no points"));
    let sum = "system s : curve open\nmodule P(v: vec2)\naxiom: [(0,0), (1,0)]\nrules:\n  \
               P(a) > P(b) # -> P(a)\n  P(a) > # -> eps\n  # < P(a) > P(b) -> P(a)\n  P(a) > P(b) -> P(1/2*a + 1/2*b)\n\
               run:\n  derive 260\n";
    assert!(of(sum, 600).contains("hangs on 25"), "{}", of(sum, 600));
}

#[cfg(feature = "gpu")]
mod on_a_device {
    use super::*;
    use burgeon::codegen::{self, Edit, Tuning};
    use burgeon::gpu::{Engine, Stencil};

    /// Where the device's curve is another than the derived one: with one table for all frames, the points moved between them.
    fn difference(engine: &Engine) -> Option<String> {
        let frames: Vec<Vec<Case>> = [1, 3].map(cases).into();
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
        for (name, engine) in device::engines() {
            assert_eq!(difference(&engine), None, "{name}");
            let case = cases(1).swap_remove(0);
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

    pub const MUTANTS: &[(&str, &str, &str)] = &[
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
        let engine = Engine::new(&headless.device, &headless.queue);
        let text = std::fs::read_to_string("wgsl/stencil.wgsl").expect("the kernel");
        let mut wrong = Vec::new();
        for &(file, find, replace) in MUTANTS {
            if !text.contains(find) {
                wrong.push(format!("{file} has no `{find}` any more"));
            } else if difference(&engine.clone().with_edit(Edit { file, find, replace })).is_none() {
                wrong.push(format!("{file}: `{find}` → `{replace}` is not seen"));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}

/// How many mutants of a file are here.
#[cfg(feature = "gpu")]
pub fn mutants_of(file: &str) -> usize {
    on_a_device::MUTANTS.iter().filter(|m| m.0 == file).count()
}
