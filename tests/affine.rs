//! Rules as matrices: what the papers say of schemes, matrices as rules again, and whole derivations as tables.

mod tables;

use burgeon::affine::infer::{self, InferError};
use burgeon::affine::{Error, Matrix, Number, Rules};
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
    for shift in [-3, -1, 1, 2] {
        let matrix = rules(UNCHAIKIN, "").matrix(16, 0).expect("a matrix");
        turned(&matrix, &infer::infer(&matrix, shift, "found").expect("a rule"), shift);
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
            "row 10, column 6: this entry asks for a context 11 deep on the right; contexts are at most 8 deep",
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
        let (word, _) = cpu::derive(&plan, &axiom, &Options::default(), 1).expect("a word");
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

/// How many mutants of a file are here.
#[cfg(feature = "gpu")]
pub fn mutants_of(file: &str) -> usize {
    tables::on_a_device::MUTANTS.iter().filter(|m| m.0 == file).count()
}
