//! The reference of the language cannot rot: its examples are run, and its tables are made from the
//! code. `BURGEON_BLESS=1` writes the tables anew.
//!
//! The examples of `reference.md` stand in fences that begin with `burgeon`. The words behind it:
//!
//! | word | meaning |
//! |---|---|
//! | `patch`, `ring`, `open` | a fragment of a system that declares `P(level: int), A, B, C, D` or `P(v: vec3)` |
//! | `values` | each line is an expression and, in a comment, its value |
//! | `derived` | it is derived on the CPU; numbers are the counts of modules after each step |
//! | a code | it is found; no others are |

use burgeon::io::bpt;
use burgeon::language::expr::{ExprKind, Type, Value};
use burgeon::language::ops::{Row, TABLE};
use burgeon::language::system::{Axiom, System};
use burgeon::language::vocabulary::{Owner, ParameterKind, Role, Slots};
use burgeon::language::{Vocabulary, compile, diagnostic};
use burgeon::plan::measure::MEASURES;
use burgeon::plan::{Options, Plan};
use burgeon::{cpu, patch};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A page of `src/language`.
fn page(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/language").join(name);
    std::fs::read_to_string(path).expect("a page of the reference")
}

// The examples.

struct Example {
    line: usize,
    words: Vec<String>,
    text: String,
}

impl Example {
    fn has(&self, word: &str) -> bool {
        self.words.iter().any(|w| w == word)
    }

    /// What stands before the text so that it is a whole file.
    fn frame(&self) -> &'static str {
        let frames = [
            (
                "patch",
                "system s : patch bezier 3\nmodule P(level: int), A, B, C, D\naxiom: P(0) = file \"sheet.bpt\"\n",
            ),
            ("ring", "system s : curve ring\nmodule P(v: vec3)\n"),
            ("open", "system s : curve open\nmodule P(v: vec3)\n"),
        ];
        frames.iter().find(|(word, _)| self.has(word)).map_or("", |(_, text)| text)
    }
}

fn examples(page: &str) -> Vec<Example> {
    let mut examples = Vec::new();
    let mut open: Option<Example> = None;
    for (n, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(info), None) => {
                let words = info.split_whitespace().map(String::from).collect();
                open = Some(Example { line: n + 1, words, text: String::new() });
            }
            (Some(_), Some(_)) => examples.extend(open.take()),
            (None, Some(example)) => example.text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    examples.retain(|e| e.words.first().is_some_and(|w| w == "burgeon"));
    examples
}

fn is_code(word: &str) -> bool {
    word.len() == 5
        && word.starts_with(['E', 'W'])
        && word[1..].starts_with('0')
        && word[1..].bytes().all(|b| b.is_ascii_digit())
}

#[test]
fn the_examples_of_the_reference_hold() {
    let examples = examples(&page("reference.md"));
    assert!(examples.len() > 20, "the examples were not found");
    let wrong: Vec<String> = examples
        .iter()
        .filter_map(|e| hold(e).err().map(|why| format!("reference.md:{}: {why}\n{}", e.line, e.text)))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn hold(example: &Example) -> Result<(), String> {
    if example.has("values") {
        return example.text.lines().try_for_each(value_holds);
    }
    let frame = example.frame();
    let text = format!("{frame}{}", example.text);
    let checked = compile(&text, &Vocabulary::default());
    let mut found: BTreeSet<&str> = checked.diagnostics.iter().map(|d| d.code).collect();
    if !frame.is_empty() {
        // A fragment need not use what it declares.
        found.remove("W0306");
    }
    let expected: BTreeSet<&str> = example.words.iter().map(String::as_str).filter(|w| is_code(w)).collect();
    if found != expected {
        return Err(diagnostic::render(&checked.diagnostics, "example", &text, false));
    }
    if example.has("derived") {
        let system = checked.systems.last().ok_or("no system")?;
        let counts: Vec<u64> = example.words.iter().filter_map(|w| w.parse().ok()).collect();
        let steps = derive(system)?;
        if steps != counts {
            return Err(format!("the counts are {steps:?}"));
        }
    }
    Ok(())
}

/// The counts of modules after each step, every file being one patch.
fn derive(system: &System) -> Result<Vec<u64>, String> {
    let plan = Plan::new(system).map_err(|e| e.to_string())?;
    let sheet = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/sheet.bpt");
    let axiom = patch::Axiom::load(system, &mut |_| bpt::read(&sheet, false)).map_err(|e| e.to_string())?;
    let (_, derivation) = cpu::derive(&plan, &axiom, &Options::default(), 1).map_err(|e| e.to_string())?;
    Ok(derivation.steps.iter().map(|s| s.modules).collect())
}

/// `expression // value`, and behind the value whatever helps the reader.
fn value_holds(line: &str) -> Result<(), String> {
    let (expression, comment) = line.split_once("//").ok_or("a line without a value")?;
    let comment = comment.split(" (W").next().unwrap_or(comment).trim();
    let wanted = read_value(comment).ok_or_else(|| format!("`{comment}` is no value"))?;
    let text = format!(
        "system s : patch bezier 3\nmodule Q(x: {})\naxiom: Q({expression}) = file \"sheet.bpt\"\n",
        wanted.ty()
    );
    let checked = compile(&text, &Vocabulary::default());
    let found = checked.systems.first().and_then(|s| match &s.axiom {
        Axiom::Patches(starts) => starts.first()?.args.first(),
        _ => None,
    });
    match found.map(|e| &e.kind) {
        Some(ExprKind::Literal(value)) if *value == wanted => Ok(()),
        Some(other) => Err(format!("`{expression}` is {other:?}")),
        None => Err(diagnostic::render(&checked.diagnostics, "example", &text, false)),
    }
}

/// `true`, `3`, `2.5` or a vector of numbers.
fn read_value(text: &str) -> Option<Value> {
    if let Some(inner) = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')) {
        let parts: Option<Vec<f32>> = inner.split(',').map(|x| x.trim().parse().ok()).collect();
        return match parts?[..] {
            [x, y] => Some(Value::Vec2([x, y])),
            [x, y, z] => Some(Value::Vec3([x, y, z])),
            _ => None,
        };
    }
    let int = || text.parse().ok().map(Value::Int);
    let bool = || text.parse().ok().map(Value::Bool);
    let float = || text.parse().ok().map(Value::Float);
    int().or_else(bool).or_else(float)
}

#[test]
fn a_system_is_parsed_in_one_call() {
    let text = "system a : patch bezier 3\nmodule P\nsystem b : curve\nmodule Q";
    assert_eq!(System::parse(text).expect("two systems").name, "b");
    let errors = System::parse("system s : patch bezier 3\nrules:\n  P -> Q").unwrap_err();
    assert_eq!(errors.list.len(), 2);
    let shown = errors.to_string();
    assert!(shown.contains("`P`") && shown.contains("`Q`") && shown.contains("rules:3:"), "{shown}");
    assert!(format!("{errors:?}").contains(&shown));
    assert!(System::parse("// nothing\n").unwrap_err().to_string().contains("expected a system"));
}

// The generated pages.

/// Whether `src/language/NAME` holds this text; written if the tables are being blessed.
fn same(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/language").join(name);
    if std::env::var_os("BURGEON_BLESS").is_some_and(|v| v == "1") {
        std::fs::write(&path, text).expect("the page can be written");
    }
    let held = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(held == text, "{name} is out of date: run the tests with BURGEON_BLESS=1 and commit it");
}

/// Text that stands in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// What the tables say of a row; the test below makes them keep their word.
fn runs_in_rules(row: &Row) -> bool {
    !row.name.ends_with(" *")
}

/// Rows that no rule file can name: behind `rand` and the draw among alternatives.
fn is_internal(row: &Row) -> bool {
    row.name.ends_with(" #")
}

/// The signature, with V for a vector type if the same is there for all three.
fn signature(row: &Row) -> String {
    let shown = match row.name.strip_suffix(" *") {
        Some(name) => format!("{name} * {} -> {}", row.args[1], row.result),
        None => row.to_string(),
    };
    let generic =
        |text: &str| ["vec2", "vec3", "vec4"].iter().fold(text.to_string(), |t, v| t.replace(v, "V"));
    let alike =
        TABLE.iter().filter(|r| r.name == row.name && generic(&r.to_string()) == generic(&row.to_string()));
    if alike.count() == 3 { generic(&shown) } else { shown }
}

#[test]
fn the_page_of_operations_is_the_table() {
    let mut text = String::from(
        "Operators and functions of expressions.\n\n\
         Where an operation takes a float an int will do. `V` stands for `vec2`, `vec3` and `vec4` alike, the same\n\
         one throughout a line. In consts, params, counts and axioms the host computes all of them but\n\
         `noise` and `frame * v`; *in rules* says whether this version runs them there, on CPU and GPU.\n\
         The meaning of numbers is told in the [reference](super#values).\n",
    );
    for (title, operators) in [("Operators", true), ("Functions", false)] {
        let is_operator = |r: &&Row| r.is_operator() || r.name.ends_with(" *");
        let rows = TABLE.iter().filter(|r| !is_internal(r) && is_operator(r) == operators);
        let mut by_name: Vec<(&str, Vec<&Row>)> = Vec::new();
        for row in rows {
            match by_name.iter_mut().find(|(name, _)| *name == row.name) {
                Some((_, rows)) => rows.push(row),
                None => by_name.push((row.name, vec![row])),
            }
        }
        if !operators {
            by_name.sort_by_key(|(name, _)| *name);
        }
        write!(text, "\n# {title}\n\n| operation | meaning | in rules |\n|---|---|---|\n").unwrap();
        let mut written = BTreeSet::new();
        for row in by_name.into_iter().flat_map(|(_, rows)| rows) {
            let signature = signature(row);
            if written.insert(signature.clone()) {
                let runs = if runs_in_rules(row) { "yes" } else { "" };
                writeln!(text, "| `{}` | {} | {runs} |", cell(&signature), cell(row.doc)).unwrap();
            }
        }
    }
    text += "\n# Random numbers\n\n\
             Not in the table, since they are no functions of their arguments alone; see the\n\
             [reference](super#random-numbers).\n\n\
             | operation | meaning | in rules |\n|---|---|---|\n\
             | `rand() -> float` | Uniform from 0 up to 1, 1 left out. | yes |\n\
             | `rand(a: float, b: float) -> float` | Uniform from a to b. | yes |\n\
             | `randn() -> float` | Nearly normal, of mean 0 and deviation 1. | yes |\n";
    same("operations.md", &text);
}

/// A rule whose condition is `expression`, beside names of every type.
fn rule_with(expression: &str) -> String {
    format!(
        "system s : patch bezier 3\n\
         param q_float: float = 0.5\nparam q_vec2: vec2 = (1, 2)\n\
         param q_vec3: vec3 = (1, 2, 3)\nparam q_vec4: vec4 = (1, 2, 3, 4)\n\
         module P(q_int: int, q_bool: bool)\naxiom: P(0, true) = file \"sheet.bpt\"\n\
         rules:\n  P(q_int, q_bool) : {expression} -> [ P(q_int, q_bool) | eps ]\n"
    )
}

/// The system of a text, and whether this version derives it.
fn is_derived(text: &str) -> bool {
    let system = System::parse(text).unwrap_or_else(|e| panic!("{e}"));
    Plan::new(&system).is_ok()
}

/// An expression as a condition.
fn as_condition(expression: String, ty: &Type) -> String {
    match ty {
        Type::Bool => expression,
        Type::Int | Type::Float => format!("{expression} > 0"),
        _ => format!("length({expression}) > 0"),
    }
}

#[test]
fn operations_run_in_rules_where_the_page_says_so() {
    for row in TABLE.iter().filter(|r| !r.name.ends_with(" *") && !is_internal(r)) {
        let args: Vec<String> = row.args.iter().map(|ty| format!("q_{ty}")).collect();
        let expression = match args.as_slice() {
            [a] if row.is_operator() => format!("{}{a}", row.name),
            [a, b] if row.is_operator() => format!("{a} {} {b}", row.name),
            args => format!("{}({})", row.name, args.join(", ")),
        };
        let text = rule_with(&as_condition(format!("({expression})"), &row.result));
        assert_eq!(is_derived(&text), runs_in_rules(row), "{row}\n{text}");
    }
}

const OWNERS: [(Owner, &str); 7] = [
    (Owner::Rule, "All rules"),
    (Owner::Patch, "Rules and queries of patch systems"),
    (Owner::Face, "Rules, queries and `mark` of mesh systems"),
    (Owner::Slot, "Slots of templates"),
    (Owner::Place, "`place` of mesh systems"),
    (Owner::Displacement, "`place` of patch systems"),
    (Owner::Edge, "`crease`"),
];

#[test]
fn the_page_of_names_is_the_vocabulary() {
    let vocabulary = Vocabulary::default();
    let mut text = String::from(
        "Names that rule files use without declaring them: attributes, shapes, schemes, constants.\n\n\
         They come from the default [`Vocabulary`](super::Vocabulary). A const, a param or a bound name of a rule\n\
         file hides an attribute or constant of the same name.\n\n# Attributes\n\n\
         This version derives those of patch systems and `step`; the others are checked only.\n",
    );
    for (owner, title) in OWNERS {
        write!(text, "\n## {title}\n\n| name | type | meaning |\n|---|---|---|\n").unwrap();
        for a in vocabulary.attributes.iter().filter(|a| a.of == owner) {
            writeln!(text, "| `{}` | {} | {} |", a.name, a.ty, cell(a.doc)).unwrap();
        }
    }
    for (role, title) in [
        (Role::Axiom, "Shapes, for the axioms of mesh systems"),
        (Role::Template, "Templates that fit any face"),
    ] {
        write!(text, "\n# {title}\n\n| shape | slots | meaning |\n|---|---|---|\n").unwrap();
        for shape in vocabulary.shapes.iter().filter(|s| s.role == role) {
            let parameters = shape.parameters.iter().map(|p| match &p.kind {
                ParameterKind::Value(ty) => format!("{}: {ty}", p.name),
                ParameterKind::PerPoint => format!("{}: float at each point", p.name),
                ParameterKind::Curve => format!("{}: curve system", p.name),
                ParameterKind::Patch => format!("{}: patch system", p.name),
            });
            let parameters: Vec<String> = parameters.collect();
            let slots = match &shape.slots {
                Slots::SymbolsOf => "the symbols of the system".to_string(),
                Slots::Named(slots) => {
                    slots.iter().map(|s| format!("`{}`", s.name)).collect::<Vec<_>>().join(", ")
                }
            };
            let (name, parameters) = (shape.name, parameters.join(", "));
            writeln!(text, "| `{name}({parameters})` | {slots} | {} |", shape.doc).unwrap();
        }
    }
    text += "\n# Schemes, for `subdivide`\n\n| scheme | meaning |\n|---|---|\n";
    for scheme in &vocabulary.schemes {
        writeln!(text, "| `{}` | {} |", scheme.name, cell(scheme.doc)).unwrap();
    }
    text += "\n# Constants and params\n\n| name | value |\n|---|---|\n";
    for (name, value) in &vocabulary.constants {
        writeln!(text, "| `{name}` | {value} |").unwrap();
    }
    for (name, value) in &vocabulary.params {
        let Value::Int(value) = value else { panic!("how is {name} to be written?") };
        writeln!(text, "| `{name}` | {value}, an int; a param that can be set |").unwrap();
    }
    same("names.md", &text);
}

#[test]
fn attributes_of_patches_are_derived() {
    for a in Vocabulary::default().attributes.iter().filter(|a| matches!(a.of, Owner::Patch | Owner::Rule)) {
        let text = rule_with(&as_condition(a.name.to_string(), &a.ty));
        assert!(is_derived(&text), "{}", a.name);
        // Measured, or known from the record and the run.
        let known = ["level", "step"].contains(&a.name);
        assert!(known != MEASURES.iter().any(|m| m.name == a.name), "{}", a.name);
    }
}

// Codes.

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of src") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

fn source_texts() -> Vec<String> {
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    files.iter().map(|path| std::fs::read_to_string(path).expect("a source")).collect()
}

/// Each code that a constant holds, with what the constant's documentation says.
fn documented_codes() -> BTreeMap<String, String> {
    let mut codes = BTreeMap::new();
    for text in source_texts() {
        let mut doc = String::new();
        for line in text.lines().map(str::trim) {
            if let Some(more) = line.strip_prefix("/// ") {
                doc += if doc.is_empty() { "" } else { " " };
                doc += more;
                continue;
            }
            let value = line.strip_prefix("pub const ").and_then(|l| l.split_once(": &str = \""));
            if let Some((_, value)) = value
                && let Some(code) = value.strip_suffix("\";").filter(|c| is_code(c))
            {
                let first = codes.insert(code.to_string(), doc.clone());
                assert!(first.is_none() && !doc.is_empty(), "{code} is there twice, or says nothing");
            }
            doc.clear();
        }
    }
    codes
}

/// Words of the text that are codes.
fn mentioned(text: &str) -> BTreeSet<String> {
    text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| is_code(w)).map(String::from).collect()
}

#[test]
fn the_page_of_codes_is_what_the_sources_say() {
    let parts = [
        ("E00", "Text"),
        ("E01", "The form of a file"),
        ("E02", "Names, types, structure"),
        ("E", "Others"),
        ("W", "Warnings"),
    ];
    let mut codes = documented_codes();
    assert!(codes.len() > 60, "the codes were not found");
    let mut text = String::from(
        "Codes of errors and warnings about a rule file.\n\n\
         A code never changes its meaning. How findings are made is told in the\n\
         [reference](super#errors-and-warnings).\n",
    );
    for (prefix, title) in parts {
        let (here, others) = codes.into_iter().partition(|(code, _)| code.starts_with(prefix));
        let here: BTreeMap<String, String> = here;
        codes = others;
        if here.is_empty() {
            continue;
        }
        write!(text, "\n# {title}\n\n| code | meaning |\n|---|---|\n").unwrap();
        for (code, doc) in here {
            writeln!(text, "| {code} | {} |", cell(&doc)).unwrap();
        }
    }
    same("codes.md", &text);
}

#[test]
fn every_code_stands_in_the_reference_and_in_the_sources() {
    let mut documented = mentioned(&page("reference.md"));
    documented.extend(documented_codes().into_keys());
    let used: BTreeSet<String> = source_texts()
        .iter()
        .flat_map(|text| text.split('"').filter(|w| is_code(w)).map(String::from).collect::<Vec<_>>())
        .collect();
    assert_eq!(
        documented.difference(&used).collect::<Vec<_>>(),
        Vec::<&String>::new(),
        "no source has these"
    );
    assert_eq!(used.difference(&documented).collect::<Vec<_>>(), Vec::<&String>::new(), "no page has these");
}
