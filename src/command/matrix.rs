//! `burgeon matrix` and `burgeon infer`.

use super::load;
use super::source::Loaded;
use super::{Failure, counted, flags, print};
use burgeon::affine::infer::{InferError, infer, parse};
use burgeon::affine::properties::MOST_DEGREE;
use burgeon::affine::{Eigenvalue, Error, Matrix, Number, Rules, Scheme};
use burgeon::language::rational::Rational;
use burgeon::language::{Diagnostic, lex};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// The subdivision matrix of a group of rules, and what follows from it.
pub fn matrix(flags: &flags::Matrix) -> Result<(), Failure> {
    let loaded = Loaded::read(&flags.system)?;
    let set = loaded.set(&flags.set)?;
    let Loaded { source, system } = loaded;
    let failure = |e: Error| match e {
        Error::NotAffine { span, .. } => source.error(Diagnostic::error("E0406", span, e.to_string())),
        Error::Unsupported(e) => source.unsupported(&e),
        Error::Plan(burgeon::plan::Error::Set(what)) => Failure::Usage(format!("error: --set: {what}")),
        e => Failure::File(format!("error: {}: {e}", flags.system.file.display())),
    };
    let with: Vec<&str> = flags.with.iter().map(String::as_str).collect();
    let rules = Rules::new(&system, &with, &set).map_err(failure)?;
    let matrix = rules.matrix(flags.n as usize, flags.step).map_err(failure)?;
    // An open word has end rules; only what lies between them repeats.
    let scheme = if rules.is_ring() { Some(rules.scheme(flags.step).map_err(failure)?) } else { None };
    let title = Title { system: &system.name, with: &with, step: flags.step, ring: rules.is_ring() };
    match flags.json {
        true => print(&format!("{}\n", title.json(&matrix, scheme.as_ref()))),
        false => print(&title.text(&matrix, scheme.as_ref())),
    }
}

/// What a matrix is of.
struct Title<'a> {
    system: &'a str,
    with: &'a [&'a str],
    step: u32,
    ring: bool,
}

impl Title<'_> {
    fn text(&self, matrix: &Matrix, scheme: Option<&Scheme>) -> String {
        let with =
            if self.with.is_empty() { String::new() } else { format!(", rules {}", self.with.join(", ")) };
        let step = if self.step == 0 { String::new() } else { format!(", step {}", self.step) };
        let word = if self.ring { "a ring" } else { "an open word" };
        let (rows, columns) = (matrix.rows.len(), matrix.columns);
        let mut text = format!(
            "{}{with}{step}: {rows} × {columns}, on {word} of {}\n\n",
            self.system,
            counted(columns as u64, "point")
        );
        grid(matrix, &mut text);
        text.push('\n');
        let mut line = |name: &str, value: String| {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{name:<14}{value}");
        };
        let Some(scheme) = scheme else {
            let affine = sums_to_one(matrix);
            line("rows", affine_text(affine));
            line("", "mask, eigenvalues and degrees are those of a ring".to_string());
            return text;
        };
        if let Some((_, mask)) = scheme.mask() {
            line("mask", mask_text(&mask));
        }
        line("rows", affine_text(scheme.is_affine()));
        if let Some(degree) = scheme.generates() {
            line("generates", degree_text(degree));
        }
        if let Some(degree) = scheme.reproduces() {
            let at = if degree > 0 {
                format!(", new point i at {}", parametrisation(scheme))
            } else {
                String::new()
            };
            line("reproduces", format!("{}{at}", degree_text(degree)));
        }
        if let Some(values) = scheme.eigenvalues() {
            let list: Vec<String> = values.iter().map(Eigenvalue::to_string).collect();
            line("eigenvalues", list.join(", "));
            line("", format!("of the local subdivision matrix, {0} × {0}", values.len()));
        }
        text
    }

    fn json(&self, matrix: &Matrix, scheme: Option<&Scheme>) -> Value {
        let dense = |f: &dyn Fn(Number) -> Value| -> Vec<Vec<Value>> {
            let row = |r: usize| (0..matrix.columns).map(|c| f(matrix.get(r, c))).collect();
            (0..matrix.rows.len()).map(row).collect()
        };
        let fraction = |x: Number| x.exact().map_or(Value::Null, |x| json!(x.to_string()));
        let degree = |d: Option<u32>| d.map_or(Value::Null, |d| json!(d));
        let mask = scheme.and_then(Scheme::mask).map(|(_, mask)| mask);
        let values = scheme.and_then(Scheme::eigenvalues);
        let pair = |z: &Eigenvalue| json!([z.re, z.im]);
        json!({
            "system": self.system,
            "with": self.with,
            "step": self.step,
            "ring": self.ring,
            "matrix": dense(&|x| json!(x.to_f64())),
            "fractions": dense(&fraction),
            "mask": mask.map(|mask| mask.iter().map(|x| x.to_f64()).collect::<Vec<_>>()),
            "affine": scheme.map_or_else(|| sums_to_one(matrix), Scheme::is_affine),
            "generates": degree(scheme.and_then(Scheme::generates)),
            "reproduces": degree(scheme.and_then(Scheme::reproduces)),
            "shift": scheme.map(|scheme| scheme.shift().to_f64()),
            "eigenvalues": values.map(|values| values.iter().map(pair).collect::<Vec<_>>()),
        })
    }
}

/// Rows and columns, numbered from 1, with points for zeros.
fn grid(matrix: &Matrix, text: &mut String) {
    let cell = |r: usize, c: usize| match matrix.get(r, c) {
        x if x.is_zero() => ".".to_string(),
        x => x.to_string(),
    };
    let rows: Vec<Vec<String>> =
        (0..matrix.rows.len()).map(|r| (0..matrix.columns).map(|c| cell(r, c)).collect()).collect();
    let digits = matrix.columns.to_string().len();
    let width = rows.iter().flatten().map(|t| t.chars().count()).max().unwrap_or(1).max(digits) + 2;
    let first = matrix.rows.len().to_string().len().max(1) + 2;
    text.push_str(&" ".repeat(first));
    (1..=matrix.columns).for_each(|c| text.push_str(&format!("{c:>width$}")));
    text.push('\n');
    for (r, row) in rows.iter().enumerate() {
        text.push_str(&format!("{:>first$}", r + 1));
        row.iter().for_each(|cell| text.push_str(&format!("{cell:>width$}")));
        text.push('\n');
    }
}

fn sums_to_one(matrix: &Matrix) -> bool {
    let sum = |row: &Vec<(u32, Number)>| row.iter().map(|e| e.1).fold(Number::ZERO, |sum, x| sum + x);
    matrix.rows.iter().all(|row| sum(row).is(Number::ONE))
}

fn affine_text(affine: bool) -> String {
    match affine {
        true => "all sum to 1: affine-invariant".to_string(),
        false => "do not all sum to 1: not affine-invariant".to_string(),
    }
}

fn degree_text(degree: u32) -> String {
    match degree {
        0 => "constants".to_string(),
        1 => "lines".to_string(),
        MOST_DEGREE.. => "polynomials of any degree".to_string(),
        _ => format!("polynomials of degree {degree}"),
    }
}

/// Over the common denominator, if there is a short one.
fn mask_text(mask: &[Number]) -> String {
    let fractions: Option<Vec<Rational>> = mask.iter().map(|x| x.exact()).collect();
    let common = fractions.as_ref().and_then(|list| {
        let lcm = |a: i128, b: i128| a.checked_mul(b / gcd(a, b)).filter(|&d| d <= 10_000);
        list.iter().try_fold(1, |d, x| lcm(d, x.parts().1))
    });
    let list = |scale: i128| {
        let scale = Number::whole(scale as i64);
        let list: Vec<String> = mask.iter().map(|x| (*x * scale).to_string()).collect();
        format!("({})", list.join(", "))
    };
    match common {
        None | Some(1) => list(1),
        Some(d) => format!("{}/{d}", list(d)),
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Where new point i lies among the old ones, both counted from 0.
fn parametrisation(scheme: &Scheme) -> String {
    let step = Number::whole(scheme.width as i64) / Number::whole(scheme.height as i64);
    let spaced = match step.exact() {
        Some(Rational::ONE) => "i".to_string(),
        Some(x) if x.is_whole() => format!("{x}i"),
        Some(x) if x.parts().0 == 1 => format!("i/{}", x.parts().1),
        _ => format!("{step}·i"),
    };
    let shift = scheme.shift();
    match shift {
        x if x.is(Number::ZERO) => spaced,
        x if x.to_f64() < 0.0 => format!("{spaced} - {}", -x),
        x => format!("{spaced} + {x}"),
    }
}

/// The rule of a subdivision matrix.
pub fn infer_rule(flags: &flags::Infer) -> Result<(), Failure> {
    let path = &flags.file;
    let shown = path.display();
    let bytes =
        std::fs::read(path).map_err(|e| Failure::File(format!("error: {}", load::cannot_read(path, &e))))?;
    let text =
        lex::decode(&bytes).map_err(|_| Failure::File(format!("error: {shown} is no text in UTF-8")))?;
    let matrix = parse(text).map_err(|e| Failure::File(format!("error: {shown}: {e}")))?;
    let rules = match &flags.name {
        Some(name) => infer(&matrix, flags.shift, name),
        None => match infer(&matrix, flags.shift, &stem(path)) {
            Err(InferError::Name(_)) => infer(&matrix, flags.shift, "scheme"),
            found => found,
        },
    };
    let rules = rules.map_err(|e| match e {
        InferError::Name(_) => Failure::Usage(format!("error: --name: {e}")),
        e => Failure::File(format!("error: {shown}: {e}")),
    })?;
    print(&rules)
}

/// The file's name without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map_or(String::new(), |name| name.to_string_lossy().into_owned())
}
