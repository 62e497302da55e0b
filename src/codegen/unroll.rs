//! Loops over the rows and columns of a net, written out.
//!
//! naga gives every loop a counter that ends it, and drivers that would unroll a loop of four turns leave one alone
//! that can end in two ways. Then each index is one of the running program, and nets lie in memory instead of
//! registers. On lavapipe `decide` takes 2.2 times as long so and six times as long to compile, `vertices` 1.8 times.
//!
//! A loop is one of the form `for (var i = a; i < b; i++) {`, or downwards, whose bounds are made of numbers and of the
//! sizes of nets; it stands on lines of its own, and is not left by `break` or `continue`.

/// The constants whose loops are written out.
const SIZES: [&str; 4] = ["ROWS", "COLUMNS", "LINES", "POINTS"];

/// The most lines that a loop becomes: nets of high degrees keep their outer loops.
const MOST_LINES: usize = 2000;

/// Lines, each with what came with it, where the sizes stand in `constants` as `const NAME = 4u;`.
pub fn unroll<T: Copy>(lines: Vec<(String, T)>, constants: &str) -> Vec<(String, T)> {
    let size = |line: &'_ str| -> Option<(String, i64)> {
        let (name, value) = line.strip_prefix("const ")?.strip_suffix("u;")?.split_once(" = ")?;
        SIZES.contains(&name).then_some((name.to_string(), value.parse().ok()?))
    };
    let mut known: Known = constants.lines().filter_map(size).collect();
    let mut out = Vec::with_capacity(lines.len());
    expand(&lines, &mut known, &mut out);
    out
}

/// Sizes, and variables of the loops around.
type Known = Vec<(String, i64)>;

fn expand<T: Copy>(lines: &[(String, T)], known: &mut Known, out: &mut Vec<(String, T)>) {
    let mut at = 0;
    while let Some((line, origin)) = lines.get(at) {
        at += 1;
        let indent = &line[..line.len() - line.trim_start().len()];
        let closes = |(l, _): &(String, T)| l.strip_prefix(indent).is_some_and(|l| l.starts_with('}'));
        // Of all others nothing is written out, and the ends of their blocks need not be looked for.
        let may = ["for (var ", "if "].iter().any(|start| line.trim_start().starts_with(start));
        let end = || lines[at..].iter().position(closes).filter(|n| lines[at + n].0.trim_start() == "}");
        let block = may.then(end).flatten();
        let Some(len) = block else {
            out.push((line.clone(), *origin));
            continue;
        };
        let (body, close) = (&lines[at..at + len], &lines[at + len]);
        if let Some(turns) = turns(line.trim_start(), known) {
            let start = out.len();
            for value in turns.values {
                out.push((format!("{indent}{{ let {} = {value}u;", turns.name), *origin));
                known.push((turns.name.to_string(), value));
                expand(body, known, out);
                known.pop();
                out.push(close.clone());
            }
            let leaves = |(l, _): &(String, T)| l.contains("break;") || l.contains("continue;");
            if out.len() - start <= MOST_LINES && !body.iter().any(leaves) {
                at += len + 1;
                continue;
            }
            out.truncate(start);
        }
        // What is behind a condition that never holds may name what is not there.
        match line.trim_start().strip_prefix("if ").and_then(|l| l.strip_suffix(" {")) {
            Some(condition) if never(condition, known) => at += len + 1,
            _ => out.push((line.clone(), *origin)),
        }
    }
}

/// Whether one of the terms that `&&` joins is known to be false.
fn never(condition: &str, known: &[(String, i64)]) -> bool {
    condition.split(" && ").any(|term| {
        let sides = term.split_once(" < ").and_then(|(a, b)| Some((number(a, known)?, number(b, known)?)));
        sides.is_some_and(|(a, b)| a >= b)
    })
}

/// The variable of a loop and its values.
struct Turns<'a> {
    name: &'a str,
    values: Vec<i64>,
}

fn turns<'a>(line: &'a str, known: &[(String, i64)]) -> Option<Turns<'a>> {
    let head = line.strip_prefix("for (var ")?.strip_suffix(") {")?;
    let (name, rest) = head.split_once(" = ")?;
    let [start, condition, step] = rest.split("; ").collect::<Vec<_>>().try_into().ok()?;
    let step = match step.strip_prefix(name)? {
        "++" => 1,
        "--" => -1,
        _ => return None,
    };
    if !SIZES.iter().any(|size| start.contains(size) || condition.contains(size)) {
        return None;
    }
    let (left, right, below) = match (condition.split_once(" < "), condition.split_once(" > ")) {
        (Some((left, right)), None) => (left, right, true),
        (None, Some((left, right))) => (left, right, false),
        _ => return None,
    };
    let mut value = number(start, known)?;
    let mut values = Vec::new();
    loop {
        let known = [known, &[(name.to_string(), value)]].concat();
        let (a, b) = (number(left, &known)?, number(right, &known)?);
        if !(if below { a < b } else { a > b }) {
            return Some(Turns { name, values });
        }
        values.push(value);
        value += step;
    }
}

/// A sum of numbers and of names that are known.
fn number(text: &str, known: &[(String, i64)]) -> Option<i64> {
    let (mut sum, mut sign) = (0, 1);
    for (n, word) in text.split(' ').enumerate() {
        match (n % 2, word) {
            (0, word) => {
                let value = known.iter().rev().find(|(name, _)| *name == word).map(|(_, value)| *value);
                sum += sign * value.or_else(|| word.strip_suffix('u')?.parse().ok())?;
            }
            (_, "+") => sign = 1,
            (_, "-") => sign = -1,
            _ => return None,
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unrolled(text: &str) -> Vec<(String, usize)> {
        let lines = text.lines().enumerate().map(|(n, line)| (line.to_string(), n)).collect();
        unroll(lines, "const ROWS = 2u;\nconst COLUMNS = 3u;\nconst LEVELS = 4u;")
    }

    fn text(lines: &[(String, usize)]) -> String {
        lines.iter().map(|(line, _)| line.trim()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn loops_over_a_net_are_written_out_and_lines_keep_their_numbers() {
        let lines = unrolled("for (var r = 0u; r < ROWS; r++) {\n  a(r);\n}\nb();");
        assert_eq!(text(&lines), "{ let r = 0u; a(r); } { let r = 1u; a(r); } b();");
        assert_eq!(lines.iter().map(|(_, n)| *n).collect::<Vec<_>>(), [0, 1, 2, 0, 1, 2, 3]);
    }

    #[test]
    fn loops_may_be_nested_run_down_and_begin_anywhere() {
        let nested = "for (var k = COLUMNS - 1u; k > 0u; k--) {\n  for (var j = 1u; j + 1u < COLUMNS; j++) {\n    a(k, j);\n  }\n}";
        let one = |k| format!("{{ let k = {k}u; {{ let j = 1u; a(k, j); }} }}");
        assert_eq!(text(&unrolled(nested)), format!("{} {}", one(2), one(1)));
    }

    #[test]
    fn other_loops_stay() {
        for kept in [
            "for (var k = 0u; k < count; k++) {\n  a(k);\n}",
            "for (var k = 0u; k < LEVELS; k++) {\n  a(k);\n}",
            "for (var r = 0u; r < ROWS; r += 2u) {\n  a(r);\n}",
            "for (var r = 0u; r < ROWS; r++) {\n  if a(r) {\n    break;\n  }\n}",
            "while r < ROWS {\n  a(r);\n}",
        ] {
            assert_eq!(
                text(&unrolled(kept)),
                text(&kept.lines().map(|l| (l.to_string(), 0)).collect::<Vec<_>>())
            );
        }
    }

    #[test]
    fn what_never_holds_is_left_out() {
        let text_of = |condition: &str| {
            let lines = format!(
                "for (var c = 1u; c < COLUMNS; c++) {{\n  if {condition} {{\n    a[c + 1u]();\n  }}\n}}"
            );
            text(&unrolled(&lines))
        };
        let both = "{ let c = 1u; if c + 1u < COLUMNS { a[c + 1u](); } } { let c = 2u; }";
        assert_eq!(text_of("c + 1u < COLUMNS"), both);
        assert_eq!(text_of("c + 1u < COLUMNS && b()"), both.replace("COLUMNS {", "COLUMNS && b() {"));
        assert_eq!(text_of("c < n").matches("if c < n").count(), 2);
    }

    #[test]
    fn what_would_be_too_long_keeps_its_outer_loop() {
        let body = "    a(r, c);\n".repeat(400);
        let text = format!(
            "for (var r = 0u; r < ROWS; r++) {{\n  for (var c = 0u; c < COLUMNS; c++) {{\n{body}  }}\n}}"
        );
        let lines = unrolled(&text);
        assert!(lines[0].0.starts_with("for (var r"));
        assert_eq!(lines.len(), 2 + 3 * 402);
    }
}
