//! What must hold of a text, whatever it is: the tests and the targets of `fuzz/` ask the same.

use burgeon::codegen::{self, Tuning};
use burgeon::io::Noted;
use burgeon::language::expr::Type;
use burgeon::language::print::print;
use burgeon::language::system::{Field, Topology};
use burgeon::language::vocabulary::Vocabulary;
use burgeon::language::{Span, System, Value, compile, diagnostic, parse};
use burgeon::patch::{self, Axiom, Net, Word};
use burgeon::plan::derive::StageId;
use burgeon::plan::{Options, Plan};
use burgeon::word::{Params, Symbol};
use burgeon::{cpu, curve, io};

fn assert_inside(span: Span, text: &str) {
    let (start, end) = (span.start as usize, span.end as usize);
    assert!(start <= end && text.is_char_boundary(start) && text.is_char_boundary(end), "{span:?}");
}

/// Returns how many of its systems were derived.
pub fn check_rules(text: &str) -> u64 {
    let parsed = parse::parse(text);
    let checked = compile(text, &Vocabulary::default());
    for d in parsed.diagnostics.iter().chain(&checked.diagnostics) {
        assert_inside(d.span, text);
        d.labels.iter().for_each(|(span, _)| assert_inside(*span, text));
    }
    let shown = diagnostic::render(&checked.diagnostics, "fuzz.burgeon", text, false);
    assert_eq!(shown.is_empty(), checked.diagnostics.is_empty());
    if parsed.diagnostics.is_empty() {
        let printed = print(&parsed.file);
        let again = parse::parse(&printed);
        assert!(again.diagnostics.is_empty() && again.file == parsed.file, "printed:\n{printed}");
    }
    if checked.has_errors() {
        return 0;
    }
    // Each is planned, and its kernels are what naga accepts, or it is refused by name.
    let derived = |system: &System| match Plan::new(system) {
        Ok(plan) => {
            generate(&plan);
            derive(system, &plan)
        }
        Err(e) => {
            assert_inside(e.span, text);
            0
        }
    };
    checked.systems.iter().map(derived).sum()
}

/// The kernels of the first stages; the more there are, the more alike they are.
fn generate(plan: &Plan) {
    let sets = plan.tables.rule_sets.iter().enumerate();
    let ids =
        sets.flat_map(|(rule_set, s)| (0..s.stages.len()).map(move |stage| StageId { rule_set, stage }));
    for id in ids.take(2) {
        codegen::stage(plan, id, &Tuning::CPU_DRIVER).expect("naga accepts what the tables say");
    }
}

/// A few steps on the CPU within little memory: a word that holds together, or an error in words.
/// Returns how many words came.
fn derive(system: &System, plan: &Plan) -> u64 {
    // Only patch systems have nets to begin with.
    let Some(degree) = plan.tables.layout.net else { return 0 };
    let points = (0..patch::net_points(degree)).map(|k| [k as f32, (k * k % 7) as f32, 1.0, 1.0]).collect();
    let net = Net { degree, points };
    let Ok(axiom) = Axiom::load::<String>(system, &mut |_| Ok(vec![net.clone(); 2])) else { return 0 };
    let options = Options { steps: Some(3), max_bytes: 1 << 18, ..Options::default() };
    match cpu::derive(plan, &axiom, &options, 1) {
        Ok((word, _)) => {
            word.validate().expect("a word holds together");
            1
        }
        Err(e) => {
            assert!(!e.to_string().is_empty());
            0
        }
    }
}

/// What a reader accepts is whole, and comes back the same from what is written. Returns 1 if so.
fn check_nets(nets: &[Net]) -> u64 {
    for net in nets {
        assert_eq!(net.points.len(), patch::net_points(net.degree));
        assert!(net.points.iter().flatten().all(|x| x.is_finite()), "{net:?}");
        assert!(net.points.iter().all(|p| p[3] > 0.0), "{net:?}");
    }
    // Nets of several degrees, or too large to be halved, are no word.
    let Ok(word) = Word::from_nets("s", "P", nets) else { return 0 };
    let mut written = Vec::new();
    io::bv::write(&mut written, &word).expect("what is read is written");
    assert_eq!(io::bv::parse(&written, true).expect("and read again").value, nets);
    if !word.rational {
        written.clear();
        io::bpt::write(&mut written, &word).expect("what is read is written");
        assert_eq!(io::bpt::parse(&written, false).expect("and read again"), nets);
    }
    u64::from(!nets.is_empty())
}

/// Every reader of nets, on one text. Returns how many found nets that make a word.
pub fn check_files(bytes: &[u8]) -> u64 {
    let lines = bytes.split(|b| *b == b'\n').count();
    let mut whole = 0;
    for rational in [false, true] {
        let bv = |bytes: &[u8], rational| io::bv::parse(bytes, rational).map(|read| read.value);
        for parse in [io::bpt::parse, bv, io::obj::parse_bspline] {
            match parse(bytes, rational) {
                Ok(nets) => whole += check_nets(&nets),
                Err(e) => assert!(e.line >= 1 && e.line <= lines && e.column >= 1, "{e}"),
            }
        }
    }
    whole
}

/// Every reader of curves, on one text: what it accepts is whole, is drawn, and comes back from what is drawn. Returns
/// how many accepted it.
pub fn check_curves(bytes: &[u8]) -> u64 {
    let lines = bytes.split(|b| *b == b'\n').count();
    let mut whole = 0;
    let csv = |bytes: &[u8]| io::curves::csv::parse(bytes, 4).map(Noted::from);
    for parse in [csv, io::obj::lines, io::curves::svg::parse] {
        let curves = match parse(bytes) {
            Ok(read) => read.value,
            Err(e) => {
                assert!(e.line >= 1 && e.line <= lines && e.column >= 1, "{e}");
                continue;
            }
        };
        whole += 1;
        for curve in curves {
            let curve = curve.points;
            assert!(curve.iter().flatten().all(|x| x.is_finite()), "{curve:?}");
            let points = curve.iter().map(|&[x, y, z, _]| Value::Vec3([x, y, z]));
            let field = Field { name: "v".to_string(), ty: Type::Vec3 };
            let symbols = vec![Symbol { name: "P".to_string(), fields: vec![field] }];
            let mut params = Params::new(&symbols);
            let module = |point| curve::Module {
                symbol: 0,
                row: params.push(0, &[point]).expect("a point"),
                path: 0,
                parent: None,
                lateral: false,
            };
            let modules = points.map(module).collect();
            let word = curve::Word {
                system: "s".to_string(),
                steps: 0,
                topology: Topology::Ring,
                symbols,
                modules,
                params,
            };
            let picture = io::curves::Picture::of(&[&word], &Default::default()).expect("finite points");
            io::curves::raster::draw(&picture, 40);
            let mut text = Vec::new();
            io::curves::svg::write(&mut text, &picture).expect("memory");
            if curve.is_empty() {
                continue;
            }
            let again = io::curves::svg::parse(&text).expect("what is drawn is read").value;
            // What ends at its start, or so near that nobody sees it, has it once.
            let ends = usize::from(curve.len() > 1 && near(&curve));
            assert!(again.len() == 1 && again[0].points.len() == curve.len() - ends, "{again:?}");
        }
    }
    whole
}

/// Whether the last point is the first but for a hundred-thousandth of the size.
fn near(curve: &[[f32; 4]]) -> bool {
    let (first, last) = (curve[0], curve[curve.len() - 1]);
    let size = |k: usize| {
        let axis = || curve.iter().map(|p| f64::from(p[k]));
        axis().fold(f64::NEG_INFINITY, f64::max) - axis().fold(f64::INFINITY, f64::min)
    };
    let size = size(0).max(size(1));
    (0..2).all(|k| (f64::from(last[k]) - f64::from(first[k])).abs() <= 1e-5 * size)
}

/// Every reader of words and values, on one text. Returns how many accepted it.
pub fn check_values(bytes: &[u8]) -> u64 {
    let mut whole = 0;
    if let Ok(word) = io::json::parse(bytes) {
        word.validate().expect("what is read holds together");
        let mut written = Vec::new();
        io::json::write(&mut written, &word).expect("what is read is written");
        assert_eq!(io::json::parse(&written).expect("and read again"), word);
        whole += 1;
    }
    for ty in [Type::Bool, Type::Int, Type::Float, Type::Vec2, Type::Vec3] {
        let list = io::values::parse_csv(bytes, &ty);
        let grid = io::values::parse_json(bytes, &ty).map(|grid| grid.values);
        for values in [list, grid].into_iter().flatten() {
            assert!(values.iter().all(|v| v.ty() == ty), "{values:?}");
            whole += u64::from(!values.is_empty());
        }
    }
    whole
}
