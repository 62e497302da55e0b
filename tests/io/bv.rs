//! `.bv`, the format of BezierView.

use super::{SQUARE, bits, word};
use burgeon::io::Problem::*;
use burgeon::io::{Element, Problem, bpt, bv};
use burgeon::patch::{Net, Word, net_points};
use proptest::prelude::*;

fn nets(text: &str, rational: bool) -> Vec<Net> {
    bv::parse(text.as_bytes(), rational).unwrap_or_else(|e| panic!("{e}: {text}")).value
}

fn problem(text: &str, rational: bool) -> (usize, usize, Problem) {
    let error = bv::parse(text.as_bytes(), rational).expect_err(text);
    (error.line, error.column, error.problem)
}

fn written(word: &Word) -> String {
    let mut text = Vec::new();
    bv::write(&mut text, word).expect("finite");
    String::from_utf8(text).expect("text")
}

/// Degree 1 along u and 2 along v; in the plane z = 0, v along x.
const STRIP: &str = "5\n1 2\n-1 -1 0\n 0 -1 0\n 1 -1 0\n-1  1 0\n 0  1 0\n 1  1 0\n";

/// The same square as [`SQUARE`].
const BILINEAR: &str = "4\n1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n";

#[test]
fn rows_run_along_u() {
    let nets = nets(STRIP, false);
    assert_eq!((nets.len(), nets[0].degree), (1, [1, 2]));
    assert_eq!(nets[0].points[1], [0.0, -1.0, 0.0, 1.0]);
    let sample = nets[0].view().evaluate(0.25, 1.0);
    assert_eq!(sample.position, [1.0, -0.5, 0.0]);
}

#[test]
fn one_degree_or_two() {
    let square = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    assert_eq!(nets(BILINEAR, false), square);
    assert_eq!(nets(&BILINEAR.replace("4\n1", "5\n1 1"), false), square);
    let degrees: Vec<_> =
        nets(&format!("{STRIP}{BILINEAR}{STRIP}"), false).iter().map(|n| n.degree).collect();
    assert_eq!(degrees, [[1, 2], [1, 1], [1, 2]]);
}

#[test]
fn groups_and_line_breaks_say_nothing() {
    let plain = nets(&format!("{STRIP}{BILINEAR}"), false);
    for text in [
        format!("Group 1 strip\n{STRIP}Group 0 rest #5\n{BILINEAR}"),
        format!("group -1 \u{fc}ber\r\ngroup 2 twice, 3 and 4\n{STRIP}{BILINEAR}group 7 behind"),
        format!("\u{feff}{STRIP}{BILINEAR}").replace('\n', " "),
        format!("{STRIP}\n\n{BILINEAR}").replace([' ', '\n'], "\r\n"),
    ] {
        assert_eq!(nets(&text, false), plain, "{text}");
    }
    assert_eq!(nets("Group 0 nothing", false), []);
    // A name may be missing, and a number is none.
    assert_eq!(nets(&format!("Group 12\n{STRIP}group 3 \n{BILINEAR}Group 7"), false), plain);
}

/// Each kind has its own length; of 6 and 7 it is not known.
#[test]
fn other_kinds_beside_patches_are_counted() {
    let plain = nets(&format!("{STRIP}{BILINEAR}"), false);
    let tetrahedron = "1\n4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n";
    let triangle = format!("3\n3\n{}", "4 5 8\n".repeat(10));
    let normals = format!("9\n3 2\n{}", "4 5 8\n".repeat(16));
    let quad = format!("10\n3 2 1 2\n{}", "4 5 8\n".repeat(18));
    let trimming = "6\n4 5 8 0 0 1\nGroup 2 more\n";
    let cases = [
        (format!("{STRIP}{tetrahedron}{BILINEAR}"), "1 × polyhedron (kind 1)"),
        (format!("{triangle}{STRIP}Group 2\n{triangle}{BILINEAR}"), "2 × triangular patch (kind 3)"),
        (format!("{STRIP}{normals}{BILINEAR}{quad}"), "1 × PN triangle (kind 9), 1 × PN quad (kind 10)"),
        (
            format!("{STRIP}{trimming}{BILINEAR}7\n1 2 3"),
            "1 × trimming curve (kind 6), 1 × B-spline (kind 7)",
        ),
    ];
    for (text, says) in cases {
        let read = bv::parse(text.as_bytes(), false).unwrap_or_else(|e| panic!("{e}: {text}"));
        assert_eq!((read.value, read.notes), (plain.clone(), vec![format!("skipped {says}")]), "{text}");
    }
    assert!(bv::parse(STRIP.as_bytes(), false).expect("a patch").notes.is_empty());
    // Before the first patch, too: what is in a later group is found, and what is not is not said to be missing.
    let read = bv::parse(format!("{trimming}{STRIP}{BILINEAR}").as_bytes(), false).expect("two patches");
    assert_eq!((read.value, read.notes.len()), (plain, 1));
    let broken = format!("9\n1 0\n0 0 0\nGroup 1\n{BILINEAR}");
    assert_eq!(
        problem(&broken, false),
        (4, 1, NotANumber { expected: Element::Skipped, found: "Group".into() })
    );
    for text in [format!("6\n1 2 3\n{STRIP}"), format!("9\n9 9\n{BILINEAR}")] {
        let error = bv::parse(text.as_bytes(), false).expect_err("taken for a part of it").to_string();
        assert!(error.contains("none was found (where the end of another kind is not known"), "{error}");
    }
}

/// A quarter of a cylinder: cos and sin come from weights, so the points must be homogeneous.
#[test]
fn weights_are_multiplied_in() {
    let text = "8\n2 1\n1 0 0 1\n1 0 2 1\n0.70710678 0.70710678 0 0.70710678\n\
                0.70710678 0.70710678 1.41421356 0.70710678\n0 1 0 1\n0 1 2 1\n";
    let nets = nets(text, true);
    use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};
    assert_eq!(nets[0].points[3], [FRAC_1_SQRT_2, FRAC_1_SQRT_2, SQRT_2, FRAC_1_SQRT_2]);
    for i in 0..=8 {
        let [x, y, z] = nets[0].view().evaluate(f64::from(i) / 8.0, 0.5).position;
        assert!((x.hypot(y) - 1.0).abs() < 1e-6 && (z - 1.0).abs() < 1e-6, "{x} {y} {z}");
    }
    assert_eq!(
        problem(text, false),
        (
            5,
            25,
            NotOne {
                element: Element::Coordinate { patch: 0, point: 2, axis: 3 },
                found: "0.70710678".into()
            }
        )
    );
}

#[test]
fn a_weight_of_one_is_no_weight() {
    let text = "8\n1 1\n0 0 0 1\n0 1 0 1.0\n1 0 0 1\n1 1 0 1e0\n";
    assert_eq!(nets(text, false), nets(BILINEAR, false));
}

#[test]
fn refusals_each_with_its_place() {
    let own = String::from;
    let kind = |kind: &str, name| Kind { patch: 0, kind: kind.into(), name };
    let coordinate = |point, axis| Element::Coordinate { patch: 0, point, axis };
    let degree = |patch, direction| Element::Degree { patch, direction };
    let table = [
        (own(""), 1, 1, Missing(Element::Kind { patch: 0 })),
        (own(" \n\n"), 1, 1, Missing(Element::Kind { patch: 0 })),
        (own("x"), 1, 1, NotAKind { patch: 0, found: own("x") }),
        (own("-4"), 1, 1, NotAKind { patch: 0, found: own("-4") }),
        (own("4.0"), 1, 1, NotAKind { patch: 0, found: own("4.0") }),
        (own("11"), 1, 1, NotAKind { patch: 0, found: own("11") }),
        ("9".repeat(30), 1, 1, NotAKind { patch: 0, found: "9".repeat(30) }),
        // Alone they are refused by name.
        (own("1\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), 1, 1, kind("1", "polyhedron")),
        (own("Group 1\n3\n1\n0 0 0 1 0 0 0 1 0\n6\n1 2 3\n"), 2, 1, kind("3", "triangular patch")),
        (own("6\n"), 1, 1, kind("6", "trimming curve")),
        (own("7\n3 3\n4 4\n"), 1, 1, kind("7", "B-spline")),
        (format!("9\n1 0\n{}", "0 0 0\n".repeat(4)), 1, 1, kind("9", "PN triangle")),
        (format!("10\n1 1 0 0\n{}", "0 0 0\n".repeat(5)), 1, 1, kind("10", "PN quad")),
        (own("1\n8 6\n"), 1, 1, kind("1", "polyhedron")),
        (format!("{BILINEAR}1\n8 6\n"), 8, 4, Missing(Element::Skipped)),
        (format!("{BILINEAR}3\n4294967295\n0 0 0"), 9, 6, Missing(Element::Skipped)),
        (format!("{BILINEAR}3\nx\n"), 8, 1, NotACount { expected: Element::Skipped, found: own("x") }),
        (
            format!("{BILINEAR}3\n1\n0 0 0 4 x"),
            9,
            9,
            NotANumber { expected: Element::Skipped, found: own("x") },
        ),
        (format!("{BILINEAR}2 2 0\n"), 7, 1, NotAKind { patch: 1, found: own("2") }),
        (own("Group"), 1, 6, Missing(Element::Group)),
        (own("Group\n4\n1\n"), 2, 1, NotACount { expected: Element::Group, found: own("4") }),
        (own("Group a b"), 1, 7, NotACount { expected: Element::Group, found: own("a") }),
        (own("4"), 1, 2, Missing(degree(0, 0))),
        (own("5\n3"), 2, 2, Missing(degree(0, 1))),
        (own("4\n0\n"), 2, 1, Degree { degree: degree(0, 0), found: own("0") }),
        (own("4\n9\n"), 2, 1, Degree { degree: degree(0, 0), found: own("9") }),
        (own("5\n3 4000000000\n"), 2, 3, Degree { degree: degree(0, 1), found: own("4000000000") }),
        (BILINEAR.replace("1 1 0\n", ""), 5, 6, Missing(coordinate(3, 0))),
        (BILINEAR.replace("1 1 0", "1 1"), 6, 4, Missing(coordinate(3, 2))),
        (
            BILINEAR.replace("1 1 0", "1 nan 0"),
            6,
            3,
            NotFinite { element: coordinate(3, 1), found: own("nan") },
        ),
        (
            BILINEAR.replace("1 1 0", "1 1 -1e39"),
            6,
            5,
            Overflow { element: coordinate(3, 2), found: own("-1e39") },
        ),
        (
            BILINEAR.replace("1 1 0", "1 1 o"),
            6,
            5,
            NotANumber { expected: coordinate(3, 2), found: own("o") },
        ),
        (own("8\n1 1\n0 0 0 0"), 3, 7, NotPositive { element: coordinate(0, 3), found: own("0") }),
        (own("8\n1 1\n0 0 0 -1"), 3, 7, NotPositive { element: coordinate(0, 3), found: own("-1") }),
    ];
    for (text, line, column, expected) in table {
        assert_eq!(problem(&text, true), (line, column, expected), "{text:?}");
    }
}

#[test]
fn errors_of_files_name_the_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bv/cut.bv");
    let error = bv::read(path, false).expect_err("a short file").to_string();
    assert!(
        error.ends_with("cut.bv:8:6: the file ends where z of point 4 of patch 0 should stand"),
        "{error}"
    );
    let error = bv::read("no/such/file.bv", false).expect_err("no such file").to_string();
    assert!(error.contains("no/such/file.bv"), "{error}");
}

#[test]
fn as_documented() {
    let nets = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    let word = Word::from_nets("s", "P", &nets).expect("a word");
    assert_eq!(written(&word), "Group 0 P\n4\n1\n0.0 0.0 0.0\n0.0 1.0 0.0\n1.0 0.0 0.0\n1.0 1.0 0.0\n");
    let mut points = vec![[0.5, 0.0, -0.0, 1.0]; 6];
    let two =
        Word::from_nets("s", "a name", &[Net { degree: [1, 2], points: points.clone() }]).expect("a word");
    assert!(written(&two).starts_with("Group 0 a_name\n5\n1 2\n0.5 0.0 -0.0\n"), "{}", written(&two));
    points[5] = [1.0, 2.0, 3.0, 0.25];
    let rational = Word::from_nets("s", "", &[Net { degree: [1, 2], points }]).expect("a word");
    let text = written(&rational);
    assert!(
        text.starts_with("Group 0 _\n8\n1 2\n0.5 0.0 -0.0 1.0\n") && text.ends_with("\n1.0 2.0 3.0 0.25\n")
    );
    let empty = Word::from_nets("empty", "P", &[]).expect("a word");
    assert_eq!(written(&empty), "Group 0 empty\n");
}

#[test]
fn writing_refuses_what_no_reader_takes() {
    let nets = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    let mut word = Word::from_nets("s", "P", &[nets[0].clone(), nets[0].clone()]).expect("a word");
    word.rational = true;
    for (bad, expected) in [
        ([f32::NAN, 0.0, 0.0, 1.0], "point 2 of module 1 holds NaN"),
        ([0.0, 0.0, 0.0, -1.0], "point 2 of module 1 has the weight -1"),
    ] {
        word.nets[6] = bad;
        let error = bv::write(&mut Vec::new(), &word).expect_err("refused").to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

proptest! {
    #[test]
    fn round_trip_bit_for_bit(word in word()) {
        let text = written(&word);
        let read = nets(&text, word.rational);
        prop_assert_eq!(read.len(), word.modules.len());
        for (index, net) in read.iter().enumerate() {
            prop_assert_eq!(net.degree, word.degree);
            prop_assert_eq!(bits(&net.points), bits(word.net(index)));
        }
        // But for the lines of groups, lines may break anywhere.
        let (group, rest) = text.split_once('\n').expect("a group");
        let flat = format!("{group}\n{}", rest.replace('\n', " "));
        prop_assert_eq!(bv::parse(flat.as_bytes(), word.rational).map(|read| read.value), Ok(read));
    }

    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), rational: bool) {
        let _ = bv::parse(&bytes, rational);
    }

    #[test]
    fn no_text_panics_and_places_lie_inside(
        text in "(([0-9]|10|nan|1e39|Group [0-9] [a-z]|-?[0-9.]{1,3})( |\n|\r\n)){0,60}",
        rational: bool,
    ) {
        match bv::parse(text.as_bytes(), rational) {
            Ok(nets) => prop_assert!(nets.value.iter().all(|n| n.points.len() == net_points(n.degree))),
            Err(error) => {
                let line = text.split('\n').nth(error.line - 1);
                prop_assert!(line.is_some_and(|line| error.column <= line.chars().count() + 1), "{}", error);
            }
        }
    }
}
