//! Files in and out: what is read, what is refused and where, and that writing loses nothing.

mod bspline;
mod bv;
mod closing;
mod curves;
mod lines;
mod meshes;
mod svg;

use burgeon::io::{Element, ParseError, Problem, WriteError, bpt, write_atomically};
use burgeon::language::system::Field;
use burgeon::language::{Type, Value};
use burgeon::patch::{Bounds, Cell, Module, Net, Word, WordError};
use burgeon::word::{Params, Symbol};
use proptest::prelude::*;
use std::fs;
use std::io::Write;

const TEAPOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/teapot.bpt");
const SHEET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/sheet.bpt");

/// A bilinear patch in the plane z = 0.
const SQUARE: &str = "1\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n";

fn problem(text: &str, rational: bool) -> (usize, usize, Problem) {
    let error = bpt::parse(text.as_bytes(), rational).expect_err(text);
    (error.line, error.column, error.problem)
}

/// A drawing of these elements.
fn in_svg(body: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\">\n{body}\n</svg>\n")
}

#[track_caller]
fn refused<T: std::fmt::Debug>(read: Result<T, ParseError>, place: (usize, usize), says: &str) {
    let error = read.expect_err(says);
    assert_eq!((error.line, error.column), place, "{error}");
    assert!(error.to_string().contains(says), "{error}");
}

mod bpt_reading {
    use super::*;

    #[test]
    fn the_teapot() {
        let nets = bpt::read(TEAPOT, false).expect("the teapot");
        assert_eq!(nets.len(), 32);
        assert!(nets.iter().all(|net| net.degree == [3, 3]));
        assert_eq!(nets[0].points[4], [1.4, 2.4, 0.784, 1.0]);
        let word = Word::from_nets("teapot", "P", &nets).expect("a word");
        let Bounds { min, max } = word.bounds().expect("modules");
        assert_eq!((min, max), ([-3.0, 0.0, -2.0], [3.525, 3.15, 2.0]));
    }

    #[test]
    fn the_sheet_faces_up() {
        let nets = bpt::read(SHEET, false).expect("the sheet");
        assert_eq!(nets.len(), 1);
        for (u, v) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.25)] {
            assert!(nets[0].view().evaluate(u, v).normal[1] > 0.5);
        }
    }

    #[test]
    fn lines_may_break_anywhere() {
        let plain = bpt::parse(SQUARE.as_bytes(), false).expect("regular lines");
        for text in [
            SQUARE.replace('\n', " "),
            SQUARE.replace([' ', '\n'], "\n"),
            SQUARE.replace('\n', "\r\n"),
            SQUARE.replace('\n', "\n\n  "),
            format!("\u{feff}{SQUARE}"),
            "1 1 1 0 0 0 1 0 1 0 1 1 0 0 1 1 1 0 1".into(),
        ] {
            assert_eq!(bpt::parse(text.as_bytes(), true).expect(&text), plain, "{text}");
        }
    }

    #[test]
    fn lines_decide_point_by_point_where_they_are_regular() {
        // 12 + 4 numbers a patch: counted alone, these two patches could not be told apart.
        let text = "1\n1 1\n1 2 3 0.5\n0 1 0\n1 0 0 1\n1 1 0\n";
        let nets = bpt::parse(text.as_bytes(), true).expect("mixed");
        let points =
            vec![[0.5, 1.0, 1.5, 0.5], [0.0, 1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0]];
        assert_eq!(nets, vec![Net { degree: [1, 1], points }]);
    }

    #[test]
    fn mixed_degrees_and_no_patches() {
        let text = format!("2\n2 1\n{}1 1\n{}", "0 0 0\n".repeat(6), "0 0 0\n".repeat(4));
        let degrees: Vec<_> =
            bpt::parse(text.as_bytes(), false).expect("two").iter().map(|n| n.degree).collect();
        assert_eq!(degrees, [[2, 1], [1, 1]]);
        assert_eq!(bpt::parse(b"0\n", false), Ok(vec![]));
    }

    #[test]
    fn a_weight_of_one_is_no_weight() {
        let text = "1\n1 1\n0 0 0 1\n0 1 0 1.0\n1 0 0 1\n1 1 0 1e0\n";
        assert_eq!(bpt::parse(text.as_bytes(), false), bpt::parse(SQUARE.as_bytes(), false));
    }
}

mod bpt_refusals {
    use super::*;

    fn coordinate(point: usize, axis: usize) -> Element {
        Element::Coordinate { patch: 0, point, axis }
    }

    /// The last point of the square, replaced.
    fn last(point: &str) -> String {
        SQUARE.replace("1 1 0\n", point)
    }

    #[test]
    fn each_with_its_place() {
        use Problem::*;
        let own = String::from;
        let table = [
            (own(""), 1, 1, Missing(Element::Count)),
            (own(" \n\n "), 1, 1, Missing(Element::Count)),
            (own("x"), 1, 1, NotACount { expected: Element::Count, found: own("x") }),
            (own("-1\n"), 1, 1, NotACount { expected: Element::Count, found: own("-1") }),
            (own("1.5"), 1, 1, NotACount { expected: Element::Count, found: own("1.5") }),
            (own("1"), 1, 2, Missing(Element::Degree { patch: 0, direction: 0 })),
            (own("2 1"), 1, 4, Missing(Element::Degree { patch: 0, direction: 1 })),
            (
                SQUARE.replacen('1', "4294967295", 1),
                1,
                1,
                TooMany { count: own("4294967295"), bytes: SQUARE.len() + 9, possible: 1 },
            ),
            (
                SQUARE.replacen('1', &"9".repeat(30), 1),
                1,
                1,
                TooMany { count: "9".repeat(30), bytes: SQUARE.len() + 29, possible: 2 },
            ),
            (
                SQUARE.replace("1 1\n0", "1 4000000000\n0"),
                2,
                3,
                Degree { degree: Element::Degree { patch: 0, direction: 1 }, found: own("4000000000") },
            ),
            (
                SQUARE.replace("1 1\n0", "0 1\n0"),
                2,
                1,
                Degree { degree: Element::Degree { patch: 0, direction: 0 }, found: own("0") },
            ),
            (
                SQUARE.replace("1 1\n0", "9 1\n0"),
                2,
                1,
                Degree { degree: Element::Degree { patch: 0, direction: 0 }, found: own("9") },
            ),
            (last(""), 5, 6, Missing(Element::Point { patch: 0, point: 3 })),
            (last("1 1\n"), 6, 1, Line { point: Element::Point { patch: 0, point: 3 }, found: 2 }),
            (last("1 1 0 1 5\n"), 6, 1, Line { point: Element::Point { patch: 0, point: 3 }, found: 5 }),
            (last("1 1 0\n7 8 9\n"), 7, 1, Trailing { patches: 1, found: own("7") }),
            (last("1 NaN 0\n"), 6, 3, NotFinite { element: coordinate(3, 1), found: own("NaN") }),
            (last("1 1 -inf\n"), 6, 5, NotFinite { element: coordinate(3, 2), found: own("-inf") }),
            (last("1e999 1 0\n"), 6, 1, Overflow { element: coordinate(3, 0), found: own("1e999") }),
            (last("1 3.5e38 0\n"), 6, 3, Overflow { element: coordinate(3, 1), found: own("3.5e38") }),
            (last("1 1,5 0\n"), 6, 3, NotANumber { expected: coordinate(3, 1), found: own("1,5") }),
            (last("é ü 0\n"), 6, 1, NotANumber { expected: coordinate(3, 0), found: own("é") }),
            (last("1 1 0 0\n"), 6, 7, NotPositive { element: coordinate(3, 3), found: own("0") }),
            (last("1 1 0 -2\n"), 6, 7, NotPositive { element: coordinate(3, 3), found: own("-2") }),
            (last("1 1 0 2\n"), 6, 7, NotOne { element: coordinate(3, 3), found: own("2") }),
        ];
        for (text, line, column, expected) in table {
            assert_eq!(problem(&text, false), (line, column, expected), "{text:?}");
        }
    }

    #[test]
    fn a_product_beyond_f32() {
        let text = last("1e30 1 0 1e30\n");
        let (line, column, problem) = problem(&text, true);
        assert_eq!((line, column), (6, 1));
        assert!(matches!(problem, Problem::Overflow { .. }), "{problem}");
    }

    #[test]
    fn columns_count_characters() {
        let (line, column, _) = problem(&last("1 \u{a0}é 0\n"), false);
        assert_eq!((line, column), (6, 3));
        let (line, column, _) = problem("1\n1 1\n0 0 0\n0 1 0\nü 0 0 \n1 x 0\n", false);
        assert_eq!((line, column), (5, 1));
    }

    #[test]
    fn one_huge_line_is_shown_short() {
        let text = format!("1 1 1 {}", "8".repeat(1 << 20));
        let (.., problem) = problem(&text, false);
        assert!(problem.to_string().len() < 200);
        // A million numbers in a line are no trouble either.
        let text = format!("1 1 1 {}", "0 ".repeat(1 << 20));
        let (.., problem) = super::problem(&text, false);
        assert!(matches!(problem, Problem::Trailing { .. }), "{problem}");
    }

    #[test]
    fn errors_of_files_name_the_file() {
        let error = bpt::read("no/such/file.bpt", false).expect_err("no such file").to_string();
        assert!(error.contains("no/such/file.bpt"), "{error}");
        let error = bpt::read(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bpt/short.bpt"), false);
        let error = error.expect_err("a short file").to_string();
        assert!(
            error.ends_with("short.bpt:14:17: the file ends where point 12 of patch 0 should stand"),
            "{error}"
        );
    }

    /// Text that is nearly right: the tokens of a file, some of them replaced.
    fn nearly() -> impl Strategy<Value = String> {
        let token = prop_oneof![
            8 => (0u8..4).prop_map(|n| n.to_string()),
            1 => Just("nan".to_string()),
            1 => Just("4294967296".to_string()),
            1 => "[-+0-9.eE]{1,6}",
        ];
        let space = prop_oneof![4 => Just(" "), 2 => Just("\n"), 1 => Just("\r\n")];
        prop::collection::vec((token, space), 0..60)
            .prop_map(|parts| parts.into_iter().map(|(token, space)| token + space).collect())
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), rational: bool) {
            let _ = bpt::parse(&bytes, rational);
        }

        #[test]
        fn no_text_panics_and_places_lie_inside(text in nearly(), rational: bool) {
            match bpt::parse(text.as_bytes(), rational) {
                Ok(nets) => prop_assert!(nets.iter().all(|n| n.points.len() == burgeon::patch::net_points(n.degree))),
                Err(error) => {
                    let line = text.split('\n').nth(error.line - 1);
                    prop_assert!(line.is_some_and(|line| error.column <= line.chars().count() + 1), "{}", error);
                }
            }
        }
    }
}

/// Floats of every size and sign, and the ones that are hard to print.
fn finite() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
        2 => -10.0f32..10.0,
        1 => prop::sample::select(vec![0.0, -0.0, f32::MIN_POSITIVE, f32::MAX, f32::MIN, 1e-45, 16777216.0, 0.1, 7.038531e-26]),
    ]
}

/// Most programs read numbers in double precision; the shortest decimal of one f32 does not survive that.
#[test]
fn numbers_survive_double_precision() {
    let hard = f32::from_bits(0x15ae_43fd);
    assert_ne!("7.038531e-26".parse::<f64>().expect("a number") as f32, hard);
    for x in [hard, -hard, 0.1, f32::MAX, f32::MIN_POSITIVE, 1e-45, -0.0] {
        let mut text = Vec::new();
        burgeon::io::write_f32(&mut text, x).expect("written");
        let text = std::str::from_utf8(&text).expect("text");
        assert_eq!(text.parse::<f32>().map(f32::to_bits), Ok(x.to_bits()));
        assert_eq!((text.parse::<f64>().expect("a number") as f32).to_bits(), x.to_bits(), "{text}");
    }
}

fn symbols() -> Vec<Symbol> {
    let field = |name: &str, ty| Field { name: name.into(), ty };
    vec![
        Symbol { name: "P".into(), fields: vec![] },
        Symbol {
            name: "Q".into(),
            fields: vec![
                field("a", Type::Int),
                field("b", Type::Float),
                field("c", Type::Bool),
                field("d", Type::Vec2),
                field("e", Type::Vec3),
                field("f", Type::Vec4),
            ],
        },
    ]
}

fn params() -> impl Strategy<Value = Vec<Value>> {
    let floats = prop::array::uniform10(finite());
    (any::<i32>(), any::<bool>(), floats).prop_map(|(i, b, x)| {
        vec![
            Value::Int(i),
            Value::Float(x[0]),
            Value::Bool(b),
            Value::Vec2([x[1], x[2]]),
            Value::Vec3([x[3], x[4], x[5]]),
            Value::Vec4([x[6], x[7], x[8], x[9]]),
        ]
    })
}

/// Random words; keys count the modules of a root, as they do in a word read from a file.
fn word() -> impl Strategy<Value = Word> {
    ((1u8..=8, 1u8..=8), any::<bool>(), 0usize..4).prop_flat_map(|((m, n), rational, count)| {
        let points = count * (m as usize + 1) * (n as usize + 1);
        let weight = if rational { (0.01f32..100.0).boxed() } else { Just(1.0f32).boxed() };
        // Coordinates and weights whose quotient a 32-bit float can hold, as in every net there is.
        let coordinate = finite().prop_map(|x| x % 1e30);
        let point = (prop::array::uniform3(coordinate), weight).prop_map(|([x, y, z], w)| [x, y, z, w]);
        let nets = prop::collection::vec(point, points);
        let modules =
            prop::collection::vec((params(), 0u32..3, 0u8..5, 0u8..5, any::<u32>(), any::<u32>()), count);
        (nets, modules).prop_map(move |(nets, mut modules)| {
            modules.sort_by_key(|&(_, root, ..)| root);
            let mut keys = [0; 3];
            let symbols = symbols();
            let mut params = Params::new(&symbols);
            let modules = modules.into_iter().map(|(values, root, du, dv, i, j)| {
                let key = keys[root as usize];
                keys[root as usize] += 1;
                let cell = Cell { du, dv, i: i % (1 << du), j: j % (1 << dv) };
                let row = params.push(1, &values).expect("as declared");
                Module { symbol: 1, row, root, key, cell }
            });
            let (system, modules) = ("s \"\\\n\u{1F33F}".into(), modules.collect());
            Word { system, steps: 7, symbols, degree: [m, n], rational, modules, params, nets }
        })
    })
}

fn bits(nets: &[[f32; 4]]) -> Vec<[u32; 4]> {
    nets.iter().map(|point| point.map(f32::to_bits)).collect()
}

proptest! {
    #[test]
    fn bpt_round_trip_bit_for_bit(word in word()) {
        let mut text = Vec::new();
        bpt::write(&mut text, &word).expect("finite");
        let nets = bpt::parse(&text, word.rational).expect("what was written");
        prop_assert_eq!(nets.len(), word.modules.len());
        for (index, net) in nets.iter().enumerate() {
            prop_assert_eq!(net.degree, word.degree);
            prop_assert_eq!(bits(&net.points), bits(word.net(index)));
        }
        // Lines or not, the numbers are the same.
        let flat = String::from_utf8(text).expect("text").replace('\n', " ");
        prop_assert_eq!(bpt::parse(flat.as_bytes(), word.rational), Ok(nets));
    }

    #[test]
    fn random_words_hold_together(word in word()) {
        prop_assert_eq!(word.validate(), Ok(()));
    }
}

#[test]
fn bpt_writing_refuses_what_no_reader_takes() {
    let nets = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    let word = Word::from_nets("s", "P", &nets).expect("a word");
    for (bad, expected) in [
        ([f32::NAN, 0.0, 0.0, 1.0], "point 3 of module 0 holds NaN"),
        ([0.0, f32::INFINITY, 0.0, 1.0], "point 3 of module 0 holds inf"),
        ([1e30, 0.0, 0.0, 1e-20], "point 3 of module 0 holds inf"),
        ([0.0, 0.0, 0.0, 0.0], "point 3 of module 0 has the weight 0"),
        ([0.0, 0.0, 0.0, f32::NAN], "point 3 of module 0 holds NaN"),
    ] {
        let mut word = word.clone();
        word.nets[3] = bad;
        let error = bpt::write(&mut Vec::new(), &word).expect_err("refused").to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn words_are_validated() {
    type Break = (fn(&mut Word), &'static str);
    let nets = bpt::read(TEAPOT, false).expect("the teapot");
    let word = Word::from_nets("teapot", "P", &nets).expect("a word");
    let table: [Break; 10] = [
        (|w| w.degree = [3, 9], "the degrees [3, 9]"),
        (|w| w.degree = [0, 3], "the degrees [0, 3]"),
        (|w| _ = w.nets.pop(), "511 points where its 32 modules ask for 512"),
        (|w| w.modules[5].symbol = 1, "module 5 has the symbol 1"),
        (|w| w.modules[5].row = 32, "module 5 (P) has row 32 of the parameters of P, which has 32 rows"),
        (|w| w.modules[5].cell = Cell { du: 1, dv: 1, i: 2, j: 0 }, "outside its root"),
        (|w| w.modules[5].cell = Cell { du: 32, dv: 31, i: 0, j: 0 }, "outside its root"),
        (|w| w.modules.swap(5, 6), "module 6 does not follow"),
        (|w| w.nets[17][1] = f32::NAN, "point 1 of module 1 is"),
        (|w| w.nets[17][3] = 2.0, "point 1 of module 1 has the weight 2"),
    ];
    for (break_it, expected) in table {
        let mut word = word.clone();
        break_it(&mut word);
        let error = word.validate().expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
    let mut mixed = nets.clone();
    mixed[4] = Net { degree: [1, 1], points: vec![[0.0, 0.0, 0.0, 1.0]; 4] };
    let expected = WordError::MixedDegrees { module: 4, first: [3, 3], found: [1, 1] };
    assert_eq!(Word::from_nets("s", "P", &mixed), Err(expected));
    mixed[4] = Net { degree: [3, 3], points: vec![] };
    assert_eq!(
        Word::from_nets("s", "P", &mixed),
        Err(WordError::Points { module: 4, found: 0, expected: 16 })
    );
}

#[test]
fn parameters_of_the_wrong_type_are_found() {
    let nets = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    let mut word = Word::from_nets("s", "P", &nets).expect("a word");
    let field = |ty| vec![Field { name: "depth".into(), ty }];
    word.symbols[0].fields = field(Type::Float);
    let error = word.validate().expect_err("none").to_string();
    assert_eq!(error, "module 0 (P) has 0 parameters where P declares 1");
    word.params = Params::new(&word.symbols);
    let float = [Value::Float(1.0)];
    assert_eq!(word.params.push(0, &float), Ok(0));
    word.symbols[0].fields = field(Type::Int);
    let error = word.validate().expect_err("a float").to_string();
    assert_eq!(error, "parameter depth of module 0 (P) is of type float, declared as int");
}

mod whole_files {
    use super::*;

    fn text(writer: &mut dyn Write) -> Result<(), WriteError> {
        Ok(writer.write_all(b"all of it")?)
    }

    fn half(writer: &mut dyn Write) -> Result<(), WriteError> {
        writer.write_all(&[b'x'; 100_000])?;
        Err(WriteError::Unsupported("stopped half way".into()))
    }

    fn names(folder: &std::path::Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn all_or_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.obj");
        let error = write_atomically(&path, half).expect_err("half").to_string();
        assert!(error.contains("out.obj") && error.ends_with("stopped half way"), "{error}");
        assert!(names(folder.path()).is_empty());
        write_atomically(&path, text).expect("written");
        assert_eq!(fs::read(&path).expect("the file"), b"all of it");
        write_atomically(&path, half).expect_err("half");
        assert_eq!(fs::read(&path).expect("the old file"), b"all of it");
        write_atomically(&path, |w| Ok(w.write_all(b"new")?)).expect("replaced");
        assert_eq!(fs::read(&path).expect("the new file"), b"new");
        assert_eq!(names(folder.path()), ["out.obj"]);
    }

    #[test]
    fn folders_that_will_not_do() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = folder.path().join("missing").join("out.obj");
        let error = write_atomically(&missing, text).expect_err("no folder").to_string();
        assert!(error.contains("missing/out.obj") && error.contains("there is no folder"), "{error}");
        let error = write_atomically(folder.path(), text).expect_err("a folder").to_string();
        assert!(error.contains("directory"), "{error}");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("a file");
        let error = write_atomically(file.join("out.obj"), text).expect_err("a file as folder").to_string();
        assert!(!error.contains(".burgeon-"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let mode = |path: &std::path::Path| fs::metadata(path).expect("a file").permissions().mode() & 0o777;
        let (path, plain) = (folder.path().join("out.obj"), folder.path().join("plain"));
        fs::write(&plain, "").expect("a plain file");
        write_atomically(&path, text).expect("written");
        assert_eq!(mode(&path), mode(&plain), "as any new file");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("mode");
        let link = folder.path().join("link.obj");
        symlink("out.obj", &link).expect("a link");
        write_atomically(&link, |w| Ok(w.write_all(b"through")?)).expect("written");
        assert!(fs::symlink_metadata(&link).expect("the link").is_symlink());
        assert_eq!(fs::read(&path).expect("the file"), b"through");
        assert_eq!(mode(&path), 0o640);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o440)).expect("mode");
        let error = write_atomically(&path, text).expect_err("read-only").to_string();
        assert!(error.ends_with("the file is read-only"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_written_straight() {
        write_atomically("/dev/null", text).expect("swallowed");
        assert!(!fs::metadata("/dev/null").expect("still there").is_file());
        write_atomically("/dev/full", text).expect_err("a full device");
    }
}

mod json_words {
    use super::*;
    use burgeon::io::json;

    fn written(word: &Word) -> String {
        let mut text = Vec::new();
        json::write(&mut text, word).expect("finite");
        String::from_utf8(text).expect("text")
    }

    /// Every module of the word, which has one symbol, has these.
    fn set_params(word: &mut Word, values: &[Value]) {
        let field = |(n, value): (usize, &Value)| Field { name: format!("p{n}"), ty: value.ty() };
        word.symbols[0].fields = values.iter().enumerate().map(field).collect();
        word.params = Params::new(&word.symbols);
        for module in &mut word.modules {
            module.row = word.params.push(0, values).expect("as declared");
        }
    }

    #[test]
    fn as_documented() {
        let nets = [Net { degree: [1, 1], points: vec![[0.1, -0.0, 1e-7, 1.0]; 4] }];
        let mut word = Word::from_nets("sierpinski", "A", &nets).expect("a word");
        word.steps = 3;
        set_params(&mut word, &[Value::Int(3)]);
        word.modules[0].cell = Cell { du: 2, dv: 2, i: 1, j: 3 };
        let point = "[0.1,-0.0,1e-7,1.0]";
        let expected = format!(
            "{{\"version\":1,\"kind\":\"patch\",\"system\":\"sierpinski\",\"steps\":3,\"rational\":false,\"modules\":[\n\
             {{\"symbol\":\"A\",\"params\":[3],\"root\":0,\"cell\":[2,2,1,3],\
             \"net\":{{\"degree\":[1,1],\"points\":[{point},{point},{point},{point}]}}}}\n]}}\n"
        );
        assert_eq!(written(&word), expected);
    }

    #[test]
    fn no_modules() {
        let word = Word::from_nets("empty", "P", &[]).expect("a word");
        let text = written(&word);
        assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "{text}");
        assert!(json::parse(text.as_bytes()).expect("a word").modules.is_empty());
    }

    #[test]
    fn numbers_that_json_lacks() {
        let nets = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
        let mut word = Word::from_nets("s", "P", &[nets[0].clone(), nets[0].clone()]).expect("a word");
        word.nets[6][2] = f32::NAN;
        let error = json::write(&mut Vec::new(), &word).expect_err("NaN").to_string();
        assert_eq!(error, "point 2 of module 1 (P) holds NaN, which is not a finite number");
        set_params(&mut word, &[Value::Int(1), Value::Vec2([0.0, f32::INFINITY])]);
        let error = json::write(&mut Vec::new(), &word).expect_err("infinity").to_string();
        assert_eq!(error, "parameter 1 of module 0 (P) holds inf, which is not a finite number");
    }

    #[test]
    fn refusals() {
        let module = |params: &str, cell: &str, points: &str| {
            format!(
                r#"{{"version":1,"kind":"patch","system":"s","steps":0,"rational":false,"modules":[
                {{"symbol":"P","params":{params},"root":0,"cell":{cell},"net":{{"degree":[1,1],"points":{points}}}}}]}}"#
            )
        };
        let points = "[[0,0,0,1],[0,1,0,1],[1,0,0,1],[1,1,0,1]]";
        assert!(json::parse(module("[]", "[0,0,0,0]", points).as_bytes()).is_ok());
        for (text, expected) in [
            (String::new(), "EOF"),
            (r#"{"version":1,"kind":"mesh"}"#.into(), "of kind `mesh`"),
            (r#"{"version":2,"kind":"patch"}"#.into(), "version 2"),
            (r#"{"version":1,"kind":"patch"}"#.into(), "missing field"),
            (module("[null]", "[0,0,0,0]", points), "parameter 0 of module 0 is `null`"),
            (module("[[1]]", "[0,0,0,0]", points), "an array of 2, 3 or 4"),
            (module("[2147483648]", "[0,0,0,0]", points), "an int has 32 bits"),
            (module("[1e39]", "[0,0,0,0]", points), "the range of 32-bit floats"),
            (module("[]", "[1,0,2,0]", points), "outside its root"),
            (module("[]", "[0,0,0,0]", "[[0,0,0,1]]"), "1 points where its degrees ask for 4"),
            (
                module("[]", "[0,0,0,0]", &points.replace("1,1,0,1", "1,1e39,0,1")),
                "number out of range at line 2",
            ),
            (module("[]", "[0,0,0,0]", &points.replace("1,1,0,1", "1,1,0,0")), "weight 0"),
        ] {
            let error = json::parse(text.as_bytes()).expect_err(expected).to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    proptest! {
        #[test]
        fn round_trip_bit_for_bit(word in word()) {
            let text = written(&word);
            let read = json::parse(text.as_bytes()).expect("what was written");
            prop_assert_eq!(written(&read), text);
            prop_assert_eq!(bits(&read.nets), bits(&word.nets));
            prop_assert_eq!(&read.system, &word.system);
            prop_assert_eq!((read.steps, read.rational), (word.steps, word.rational));
            for (n, (a, b)) in read.modules.iter().zip(&word.modules).enumerate() {
                prop_assert_eq!(&read.symbols[a.symbol].name, &word.symbols[b.symbol].name);
                prop_assert_eq!((a.root, a.key, a.cell), (b.root, b.key, b.cell));
                let words = |w: &Word| w.params(n).iter().map(|p| (p.ty(), p.words())).collect::<Vec<_>>();
                prop_assert_eq!(words(&read), words(&word));
            }
        }

        #[test]
        fn no_text_panics(text in r#"[\[\]{}",:0-9a-z.-]{0,80}"#) {
            let _ = json::parse(text.as_bytes());
        }
    }
}

mod obj_meshes {
    use super::*;
    use burgeon::io::obj;
    use burgeon::tessellate::{Mesh, dice};

    /// A small reader of exactly what is written.
    fn read(text: &str) -> (String, Mesh) {
        let (mut name, mut mesh) = (String::new(), Mesh::default());
        for line in text.lines() {
            let (keyword, rest) = line.split_once(' ').expect("a keyword");
            let numbers = || rest.split(' ').map(|x| x.parse::<f32>().expect("a number")).collect::<Vec<_>>();
            match keyword {
                "o" => name = rest.into(),
                "v" => mesh.positions.push(numbers().try_into().expect("x y z")),
                "vt" => mesh.uvs.push(numbers().try_into().expect("u v")),
                "vn" => mesh.normals.push(numbers().try_into().expect("x y z")),
                "f" => mesh.indices.extend(rest.split(' ').map(corner)),
                other => panic!("{other}"),
            }
        }
        (name, mesh)
    }

    fn corner(text: &str) -> u32 {
        let indices: Vec<u32> = text.split('/').map(|i| i.parse().expect("an index")).collect();
        assert!(indices.len() == 3 && indices.iter().all(|&i| i == indices[0]), "{text}");
        indices[0] - 1
    }

    #[test]
    fn the_teapot_read_back() {
        let nets = bpt::read(TEAPOT, false).expect("the teapot");
        let mesh = dice(&Word::from_nets("teapot", "P", &nets).expect("a word"), 3).expect("a mesh");
        let mut text = Vec::new();
        obj::write(&mut text, &mesh, "the\nteapot ").expect("written");
        let (name, read) = read(std::str::from_utf8(&text).expect("text"));
        assert_eq!(name, "the_teapot");
        assert_eq!(read, mesh);
    }

    #[test]
    fn numbers_that_obj_lacks() {
        let vertex = [[0.0, 1.0, 0.0]];
        let mesh = |x| Mesh {
            positions: vertex.into(),
            normals: vertex.into(),
            uvs: vec![[0.0, x]],
            indices: vec![],
        };
        assert!(obj::write(&mut Vec::new(), &mesh(0.0), "").is_ok());
        let error = obj::write(&mut Vec::new(), &mesh(f32::NAN), "").expect_err("NaN").to_string();
        assert_eq!(error, "the uv of vertex 0 holds NaN, which is not a finite number");
    }
}

mod png_pictures {
    use burgeon::io::png::{self, Image};

    #[test]
    fn read_back() {
        let pixels: Vec<u8> = (0..4 * 7 * 5).map(|i| (i * 37 % 256) as u8).collect();
        let image = Image { width: 7, height: 5, pixels };
        let mut file = Vec::new();
        png::write(&mut file, &image).expect("written");
        let mut reader = ::png::Decoder::new(std::io::Cursor::new(&file)).read_info().expect("a picture");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("a frame");
        assert_eq!((info.width, info.height, info.color_type), (7, 5, ::png::ColorType::Rgba));
        assert_eq!(pixels, image.pixels);
        assert_eq!(image.pixel(6, 4), Some(image.pixels[image.pixels.len() - 4..].try_into().expect("four")));
        assert_eq!((image.pixel(7, 0), image.pixel(0, 5)), (None, None));
    }

    #[test]
    fn pixels_that_do_not_fit() {
        for (width, height, bytes) in [(2, 2, 15), (2, 2, 17), (0, 0, 0)] {
            let image = Image { width, height, pixels: vec![0; bytes] };
            assert!(png::write(&mut Vec::new(), &image).is_err(), "{width} × {height}, {bytes} bytes");
        }
    }
}
