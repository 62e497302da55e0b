//! Rule files and patch files that are wrong in every way: a message that names the place, soon, and
//! nothing left behind.

use super::*;

/// Runs the rules on the CPU with an output that must not come to be.
#[track_caller]
fn run(folder: &Folder, file: &str, more: &[&str]) -> Ran {
    let args = ["run", file, "--backend", "cpu", "--max-memory", "64M", "--out", "a.json", "--out", "a.obj"];
    let start = Instant::now();
    let ran = folder.run_in_vain(&[&args, more].concat());
    assert!(start.elapsed() < LIMIT / 2, "{file} took {:?}", start.elapsed());
    ran
}

/// Of the lines of a message, those that show the file are cut to 120 columns.
#[track_caller]
fn is_cut(ran: &Ran) {
    let shown =
        |line: &&str| line.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()).starts_with(" |");
    let longest = ran.stderr.lines().filter(shown).map(|line| line.chars().count()).max();
    assert!(longest.is_some_and(|n| n <= 120), "{longest:?} columns in {ran:?}");
}

/// Bytes without a pattern, the same in every run.
fn noise(count: usize) -> impl Iterator<Item = u32> {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    std::iter::repeat_with(move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 32) as u32
    })
    .take(count)
}

#[test]
fn rule_files_of_noise() {
    let folder = Folder::new();
    let words = "P n m ( ) [ ] { } -> : ; , | < > == && + - * / % ! eps let rules module const param run derive 1 2.5 \
                 \"s\" system patch bezier 3 @ # ? . .. ε";
    let words: Vec<&str> = words.split(' ').collect();
    let files: [(&str, Vec<u8>); 5] = [
        ("bytes", noise(100_000).map(|x| x as u8).collect()),
        ("ascii", noise(100_000).map(|x| b' ' + (x % 95) as u8).collect()),
        ("zeros", vec![0; 100_000]),
        (
            "words",
            noise(50_000)
                .flat_map(|x| [words[x as usize % words.len()], " "].concat().into_bytes())
                .collect(),
        ),
        (
            "lines",
            noise(50_000)
                .flat_map(|x| [words[x as usize % words.len()], "\n"].concat().into_bytes())
                .collect(),
        ),
    ];
    for (name, bytes) in files {
        let file = format!("{name}.burgeon");
        let head = rules("  P(n) -> ").into_bytes();
        folder.write(&file, if name == "words" || name == "lines" { [head, bytes].concat() } else { bytes });
        let ran = run(&folder, &file, &[]);
        ran.fails(1, &[&format!("{file}:1:")[..file.len() + 1]]);
        is_cut(&ran);
        if name == "bytes" || name == "zeros" {
            ran.says(&["error[E0121]: this is no rule file: it is no text"]);
        }
    }
}

/// One error, not one for each line.
#[test]
fn files_that_are_no_rules() {
    let folder = Folder::new();
    let readme = include_str!("../../README.md");
    folder.write("README.md", readme);
    folder.write("notes.burgeon", "Notes of May.\nNothing here (yet) is a rule;\nit will be.\n");
    folder.write("picture.burgeon", include_bytes!("../../examples/pictures/chaikin.png"));
    folder.write("lines.svg.txt", "<svg>\n<path d=\"M0,0\"/>\n</svg>\n");
    for file in ["README.md", "notes.burgeon", "picture.burgeon", "lines.svg.txt"] {
        for command in ["check", "run", "wgsl"] {
            let ran = folder.run_in_vain(&[command, file]);
            ran.fails(
                1,
                &["error[E0121]: this is no rule file", &format!("{file}:1:1"), "`system name : curve`"],
            );
            assert_eq!(ran.stderr.matches("error").count(), 1, "{ran:?}");
        }
    }
}

/// Rules that nothing ends are named before they run.
#[test]
fn rules_without_end() {
    let folder = Folder::new();
    folder.write("s.burgeon", "system s : curve\nmodule A\naxiom: A\nrules:\n  A : 1 < 2 -> A A\nrun:\n  derive until terminal max 1000000\n");
    let start = Instant::now();
    let ran = run(&folder, "s.burgeon", &[]);
    assert!(start.elapsed() < LIMIT / 8, "{:?}", start.elapsed());
    let expected = "error[E0407]: this never becomes terminal: `A` is rewritten in every step, and leads to `A` again
 --> s.burgeon:5:3
  |
5 |   A : 1 < 2 -> A A
  |   ^^^^^^^^^^^^^^^^
  |
 ::: s.burgeon:7:3
  |
7 |   derive until terminal max 1000000
  |   --------------------------------- step 23 would need at least 128.00 MiB for 8,388,608 modules; the memory budget is 64.00 MiB
  |
  = help: give the rule a condition that ends it, or say by `derive N` how many steps are meant
";
    assert_eq!(ran.fails(1, &[]).stderr, expected);
    folder.run_in_vain(&["run", "s.burgeon", "--backend", "cpu", "--steps", "5"]).succeeds();
}

#[test]
fn lines_of_ten_megabytes() {
    let folder = Folder::new();
    let many = |text: &str| text.repeat(10_000_000 / text.len());
    let files = [
        ("name", format!("  {}(n) -> P(n)\n", many("Q")), 5),
        ("numeral", format!("  P(n) -> P({})\n", many("9")), 5),
        ("string", format!("  P(n) -> P(\"{}\n", many("9")), 5),
        ("sum", format!("  P(n) -> P(n{})\n", many("+1")), 5),
        ("spaces", format!("  P(n) ->{}Q(n)\n", many(" ")), 5),
        ("errors", format!("  {}\n", many("$ ")), 5),
        ("block", format!("  P(n) -> [ {} ]\n", many("P(n) ")), 5),
        ("behind", format!("  P(n) -> P(n+1) {}\n  P(n) -> Q\n", many("// ")), 6),
    ];
    for (name, text, line) in files {
        let file = format!("{name}.burgeon");
        folder.write(&file, rules(&text));
        let ran = run(&folder, &file, &[]);
        ran.fails(1, &[&format!("{file}:{line}:")]);
        is_cut(&ran);
    }
    // Nothing is wrong with a long comment.
    folder.write("comment.burgeon", format!("// {}\n{QUARTERS}", many("x")));
    folder.run_in_vain(&["run", "comment.burgeon", "--backend", "cpu"]).succeeds();
}

#[test]
fn nesting_a_hundred_thousand_deep() {
    let folder = Folder::new();
    let n = 100_000;
    let wrap = |open: &str, inner: &str, close: &str| format!("{}{inner}{}", open.repeat(n), close.repeat(n));
    let files = [
        ("parentheses", format!("  P(n) -> P({})\n", wrap("(", "n", ")"))),
        ("open", format!("  P(n) -> P({}\n", "(".repeat(n))),
        ("calls", format!("  P(n) -> P({})\n", wrap("max(1,", "n", ")"))),
        ("minus", format!("  P(n) -> P({}n)\n", "-".repeat(n))),
        ("not", format!("  P(n) : {}true -> P(n)\n", "!".repeat(n))),
        ("brackets", format!("  P(n) -> {}\n", wrap("[ ", "P(n)", " ]"))),
        ("blocks", format!("  P(n) -> {}\n", wrap("[ eps | ", "P(n)", " ]"))),
        ("indices", format!("  P(n) -> P({})\n", wrap("n[", "n", "]"))),
        ("repeats", format!("  P(n) -> P(n)\nrun:\n{}", wrap("repeat 1 {\n", "derive 1\n", "}\n"))),
        ("ifs", format!("  P(n) -> P(n)\nrun:\n{}", wrap("if true {\n", "derive 1\n", "}\n"))),
    ];
    for (name, text) in files {
        let file = format!("{name}.burgeon");
        folder.write(&file, rules(&text));
        let ran = run(&folder, &file, &[]);
        ran.fails(1, &[&format!("{file}:")]);
        is_cut(&ran);
        folder.run_in_vain(&["check", &file]).fails(1, &[]);
    }
}

#[test]
fn too_many_rules() {
    let folder = Folder::new();
    folder.write("many.burgeon", rules(&"  P(n) : n == 1 -> P(n+1)\n".repeat(100_000)));
    run(&folder, "many.burgeon", &[]).fails(1, &["many.burgeon:4101:3", "more than 4096 rules"]);
}

#[test]
fn schedules_without_end() {
    let folder = Folder::new();
    let cases = [
        ("derive 4000000000", "beyond the range of int"),
        ("derive 2000000000", "`derive 2000000000`"),
        ("derive -1", "below zero"),
        ("repeat 1000000 {\n    repeat 1000000 {\n      derive 1\n    }\n  }", "more than 65536"),
    ];
    for (run_block, said) in cases {
        folder.write("long.burgeon", rules(&format!("  P(n) -> P(n+1)\nrun:\n  {run_block}\n")));
        run(&folder, "long.burgeon", &[]).fails(1, &[said, "long.burgeon:7:"]);
    }
}

/// Files that are not there, are folders, are empty, hold nothing.
#[test]
fn nothing_to_run() {
    let folder = Folder::new();
    run(&folder, "gone.burgeon", &[]).fails(1, &["cannot read gone.burgeon: there is no such file"]);
    run(&folder, "quarters", &[]).fails(1, &["there is no such file", "help: there is quarters.burgeon"]);
    run(&folder, ".", &[]).fails(1, &["cannot read .: it is a folder"]);
    for (text, what) in
        [("", "it is empty"), ("\n \n", "it is empty"), ("// nothing\n", "it holds comments only")]
    {
        folder.write("empty.burgeon", text);
        for command in ["run", "check"] {
            let said = format!("error: empty.burgeon is no rule file: {what}\nhelp: a system begins with");
            folder.run_in_vain(&[command, "empty.burgeon"]).fails(1, &[&said]);
        }
    }
    for text in ["const a: int = 1\n", "burgeon 1\n"] {
        folder.write("empty.burgeon", text);
        run(&folder, "empty.burgeon", &[])
            .fails(1, &["empty.burgeon holds no system", "system NAME : patch"]);
        let ran = folder.run_in_vain(&["check", "empty.burgeon"]);
        assert_eq!(ran.succeeds().stdout, "empty.burgeon: no system\n");
    }
    folder.write("none.burgeon", QUARTERS.replace("axiom: P(0) = file \"net.bpt\"\n", ""));
    run(&folder, "none.burgeon", &[]).fails(1, &["none.burgeon:1:8", "no axiom", "axiom: P = file"]);
    folder.write("gone.burgeon", QUARTERS.replace("net.bpt", "gone.bpt"));
    run(&folder, "gone.burgeon", &[])
        .fails(1, &["cannot read gone.bpt: there is no such file", "gone.burgeon:3:20", "--in FILE"]);
    run(&folder, "quarters.burgeon", &["--in", "gone.bpt"]).fails(1, &["cannot read gone.bpt"]);
    run(&folder, "quarters.burgeon", &["--in", "quarters.burgeon"]).fails(1, &["patches are read from .bpt"]);
    std::fs::create_dir(folder.path("folder.bpt")).expect("a folder");
    run(&folder, "quarters.burgeon", &["--in", "folder.bpt"]).fails(1, &["folder.bpt: it is a folder"]);
}

/// A wrong text of `net.bpt`, and what is said of it.
#[test]
fn patch_files() {
    let folder = Folder::new();
    let swap = |from: &str, to: &str| NET.replacen(from, to, 1).into_bytes();
    let long = |text: &str| text.repeat(10_000_000 / text.len());
    let flat = NET.replace('\n', " ");
    let nines = "9".repeat(500);
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty", vec![], &["bad.bpt:1:1", "the number of patches"]),
        ("truncated", NET.as_bytes()[..60].to_vec(), &["bad.bpt:11:6", "point 9 of patch 0"]),
        ("short", NET.as_bytes()[..NET.len() - 6].to_vec(), &["bad.bpt:", "point 15 of patch 0"]),
        ("two announced", swap("1", "2"), &["bad.bpt:18:", "patch 1"]),
        ("4 billion patches", swap("1", "4000000000"), &["bad.bpt:1:1", "4000000000 patches"]),
        ("2^64 patches", swap("1", "18446744073709551616"), &["bad.bpt:1:1", "patches are announced"]),
        ("more digits", swap("1", &nines), &["bad.bpt:1:1", "patches are announced"]),
        ("-1 patches", swap("1", "-1"), &["bad.bpt:1:1", "`-1`"]),
        ("1.5 patches", swap("1", "1.5"), &["bad.bpt:1:1", "`1.5`"]),
        ("degrees of 4 billion", swap("3 3", "4000000000 4000000000"), &["bad.bpt:2:1", "`4000000000`"]),
        ("a degree of 4 billion", swap("3 3", "3 4000000000"), &["bad.bpt:2:3", "along v", "`4000000000`"]),
        ("a degree of 0", swap("3 3", "0 3"), &["bad.bpt:2:1", "`0`", "from 1 to 8"]),
        ("a degree of -3", swap("3 3", "-3 3"), &["bad.bpt:2:1", "`-3`"]),
        (
            "another degree",
            b"1\n1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n".to_vec(),
            &["patch 0 of bad.bpt", "1×1", "3×3"],
        ),
        ("NaN", swap("2 2 0", "2 nan 0"), &["bad.bpt:13:3", "y of point 10 of patch 0", "finite"]),
        ("-NaN", swap("2 2 0", "2 2 -NaN"), &["bad.bpt:13:5", "z of point 10", "finite"]),
        ("infinity", swap("2 2 0", "inf 2 0"), &["bad.bpt:13:1", "x of point 10", "finite"]),
        ("-infinity", swap("2 2 0", "-Infinity 2 0"), &["bad.bpt:13:1", "finite"]),
        ("1e39", swap("2 2 0", "1e39 2 0"), &["bad.bpt:13:1", "beyond the range"]),
        ("a word", swap("2 2 0", "2 two 0"), &["bad.bpt:13:3", "`two`"]),
        ("a weight", swap("2 2 0", "2 2 0 3"), &["bad.bpt:13:7", "weights must be 1"]),
        ("two numbers", swap("2 2 0", "2 2"), &["bad.bpt:13:", "point 10 of patch 0"]),
        ("more", format!("{NET}1 2 3\n").into_bytes(), &["bad.bpt:19:1", "follows after the last"]),
        ("noise", noise(100_000).map(|x| x as u8).collect(), &["bad.bpt:1:1"]),
        ("zeros", vec![0; 100_000], &["bad.bpt:1:1"]),
        ("a long token", long("x").into_bytes(), &["bad.bpt:1:1", "…"]),
        ("a long line", format!("{flat}{}x", long(" ")).into_bytes(), &["bad.bpt:1:100001"]),
        ("a long line of numbers", format!("{flat}{}", long("1 ")).into_bytes(), &["bad.bpt:1:"]),
        ("many lines", format!("{NET}{}", long("1 2 3\n")).into_bytes(), &["bad.bpt:19:1"]),
    ];
    for (what, bytes, said) in cases {
        folder.write("bad.bpt", bytes);
        let ran = run(&folder, "quarters.burgeon", &["--in", "bad.bpt"]);
        assert_eq!(ran.status, Some(1), "{what}: {ran:?}");
        ran.fails(1, said);
        if what != "another degree" {
            is_cut(&ran);
        }
    }
}

/// What a later version derives is named, with its place, and not derived in part.
#[test]
fn constructs_that_are_not_derived() {
    let folder = Folder::new();
    let patch = |head: &str, module: &str, rest: &str| {
        format!(
            "system s : patch {head}\nmodule {module}\naxiom: P(0) = file \"net.bpt\"\n{rest}\nrun:\n  derive 1\n"
        )
    };
    let bicubic = |rest: &str| patch("bezier 3", "P(n: int)", &format!("rules:\n  {rest}"));
    let cases = [(
        "mesh systems",
        "system s : mesh\naxiom: box(1, 1, 1)\nrun:\n  subdivide catmull_clark 1\n".to_string(),
    )];
    for (construct, text) in cases {
        folder.write("s.burgeon", text);
        for command in ["run", "compare", "wgsl"] {
            let ran = folder.run_in_vain(&[command, "s.burgeon"]);
            let said =
                ["this version does not derive", construct, "s.burgeon:", "a later version derives it"];
            ran.fails(1, &said);
        }
        let ran = folder.run_in_vain(&["check", "s.burgeon"]);
        assert!(ran.succeeds().stdout.contains(construct), "{ran:?}");
    }
    // Reserved by the language itself, so the checker refuses it.
    folder.write("s.burgeon", bicubic("P(n) -> P(n) [ + P(n) ]"));
    run(&folder, "s.burgeon", &[]).fails(1, &["s.burgeon:5:"]);
}

/// Weights that no net can have, in a file and written out.
#[test]
fn weights() {
    let folder = Folder::new();
    let head = "system s : patch bezier 1 rational\nmodule P\naxiom: P = ";
    let tail = "\nrules:\n  P -> [ P P ; P P ]\nrun:\n  derive 2\n";
    let inline = |point: &str| format!("{head}[[(0,0,0,2), (1,0,0,1)], [(0,1,0,1), {point}]]{tail}");
    folder.write("s.burgeon", inline("(1,1,0,0.5)"));
    folder.run_in_vain(&["run", "s.burgeon", "--backend", "cpu"]).succeeds();
    for (point, said) in [
        ("(1,1,0,0)", "point 1 of row 1 has the weight 0; a weight must be positive"),
        ("(1,1,0,-2)", "point 1 of row 1 has the weight -2; a weight must be positive"),
        ("(1,1,0,1e-31)", "patch 0 of the axiom: point 3 has the weight"),
        ("(1,1e38,0,10)", "y of point 3 of this net, 1e38, times its weight, 1e1"),
        ("(1,1e38,0,2)", "these must lie within"),
    ] {
        folder.write("s.burgeon", inline(point));
        run(&folder, "s.burgeon", &[]).fails(1, &["s.burgeon:3:", said]);
    }
    folder.write("s.burgeon", inline("(1,1,0,2)").replace(" rational", ""));
    run(&folder, "s.burgeon", &[]).fails(1, &["s.burgeon:3:", "point 0 of row 0", "needs a rational system"]);
    folder.write("s.burgeon", format!("{head}file \"w.bpt\"{tail}"));
    let file = |weight: &str| format!("1\n1 1\n0 0 0\n1 0 0 {weight}\n0 1 0\n1 1 0\n");
    for (weight, said) in [
        ("0", "w.bpt:4:7: the weight of point 1 of patch 0 is `0`; weights must be positive"),
        ("-1", "w.bpt:4:7: the weight of point 1 of patch 0 is `-1`"),
        ("1e-40", "patch 0 of the axiom: point 1 has the weight"),
        ("1e39", "w.bpt:4:7:"),
    ] {
        folder.write("w.bpt", file(weight));
        run(&folder, "s.burgeon", &[]).fails(1, &[said]);
    }
}

/// An expression of the axiom or the schedule that has no value.
#[test]
fn values_that_do_not_exist() {
    let folder = Folder::new();
    let text = QUARTERS.replace("module", "param d: float = 1\nconst n: int = int(1/d)\nmodule");
    folder.write("s.burgeon", text.replace("derive 2", "derive n"));
    folder.run_in_vain(&["run", "s.burgeon", "--backend", "cpu"]).succeeds();
    folder
        .run_in_vain(&["run", "s.burgeon", "--backend", "cpu", "--set", "d=-0.5"])
        .fails(1, &["s.burgeon:", "-2"]);
}
