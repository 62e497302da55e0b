//! Flags, help, exit statuses of right and wrong usage.

use super::*;

const CPU: [&str; 2] = ["--backend", "cpu"];

fn run<'a>(file: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["run", file][..], &CPU, more].concat()
}

#[test]
fn a_run_says_what_came_of_it() {
    let folder = Folder::new();
    let ran = folder.run_in_vain(&run("quarters.burgeon", &[]));
    assert_eq!(ran.succeeds().stdout, "quarters: 2 steps, 16 modules\n");
    assert_eq!(ran.stderr, "");
}

#[test]
fn steps_stop_the_derivation() {
    let folder = Folder::new();
    for (steps, said) in
        [("0", "0 steps, 1 module"), ("1", "1 step, 4 modules"), ("99", "2 steps, 16 modules")]
    {
        let ran = folder.run_in_vain(&run("quarters.burgeon", &["--steps", steps]));
        assert_eq!(ran.succeeds().stdout, format!("quarters: {said}\n"));
    }
    folder.run_in_vain(&run("quarters.burgeon", &["--steps", "-1"])).fails(2, &["--steps"]);
    folder.run_in_vain(&run("quarters.burgeon", &["--steps", "many"])).fails(2, &["--steps", "many"]);
}

#[test]
fn one_of_several_systems() {
    let folder = Folder::new();
    let other = QUARTERS.replace("quarters", "keep").replace("derive 2", "derive 0");
    folder.write("two.burgeon", format!("{QUARTERS}{other}"));
    let run_system = |more: &[&'static str]| folder.run_in_vain(&run("two.burgeon", more));
    assert_eq!(run_system(&[]).succeeds().stdout, "keep: 0 steps, 1 module\n");
    assert_eq!(run_system(&["--system", "quarters"]).succeeds().stdout, "quarters: 2 steps, 16 modules\n");
    run_system(&["--system", "quarter"])
        .fails(2, &["two.burgeon has no system `quarter`", "quarters, keep", "did you mean `quarters`?"]);
}

#[test]
fn params_are_set() {
    let folder = Folder::new();
    let params = "param n: int = 1 in 0 .. 3\nparam x: float = 0.5\nparam yes: bool = true\nparam v: vec3 = (1, 2, 3)\n";
    let text = QUARTERS.replace("module", &format!("{params}module"));
    let text = text.replace("  derive 2", "  derive n\n  if yes && x > 0 && v.z > 2 {\n    derive 1\n  }");
    folder.write("p.burgeon", text);
    let steps = |set: &[&'static str]| {
        let set: Vec<&str> = set.iter().flat_map(|s| ["--set", s]).collect();
        let ran = folder.run_in_vain(&run("p.burgeon", &set));
        let stdout = ran.succeeds().stdout.clone();
        stdout.strip_prefix("quarters: ").and_then(|s| s[..1].parse::<u32>().ok()).expect("steps")
    };
    assert_eq!(steps(&[]), 2);
    assert_eq!(steps(&["n=3"]), 4);
    assert_eq!(steps(&["n=3", "n=0"]), 1, "the last one holds");
    assert_eq!(steps(&["n=3", "yes=false"]), 3);
    assert_eq!(steps(&["x=-1"]), 1, "an int where a float is wanted");
    assert_eq!(steps(&["x=-1e-3"]), 1);
    assert_eq!(steps(&["v=0,0,2"]), 1);
    assert_eq!(steps(&["v=(0, 0, 4)"]), 2);
}

#[test]
fn params_that_cannot_be_set() {
    let folder = Folder::new();
    let params = "param levels: int = 1 in 0 .. 3\nparam x: float = 0.5\n";
    let text = QUARTERS.replace("module", &format!("{params}module"));
    folder.write("p.burgeon", text.replace("  derive 2", "  if x > 0 {\n    derive levels\n  }"));
    let cases: [(&str, &[&str]); 13] = [
        (
            "level=1",
            &[
                "--set level: no such param of quarters; it has\n  param levels: int = 1 in 0 .. 3\n  param x: float = 0.5\n",
                "did you mean `levels`?",
            ],
        ),
        ("levels=4", &["levels = 4", "0 .. 3"]),
        ("levels=-1", &["levels = -1", "0 .. 3"]),
        ("levels=1.5", &["levels", "type int, not float"]),
        ("levels=true", &["levels", "type int, not bool"]),
        ("levels=1,2", &["levels", "type int, not vec2"]),
        ("x=1,2,3", &["x", "type float, not vec3"]),
        ("levels=two", &["`two` is no number"]),
        ("levels=9999999999", &["`9999999999` lies outside int", "9999999999.0"]),
        ("x=nan", &["`nan` is no number"]),
        ("x=1,2,3,4,5", &["5 components"]),
        ("levels", &["NAME=VALUE"]),
        ("=3", &["the name before = is missing"]),
    ];
    for (set, said) in cases {
        folder.run_in_vain(&run("p.burgeon", &["--set", set])).fails(2, said);
    }
    folder
        .run_in_vain(&run("quarters.burgeon", &["--set", "n=1"]))
        .fails(2, &["the system quarters has no params"]);
}

/// A param above the systems holds for all of them, so a call may set it for any.
#[test]
fn a_param_of_the_file_that_the_system_does_not_read() {
    let folder = Folder::new();
    let reads = QUARTERS.replace("quarters", "reads").replace("derive 2", "derive k");
    folder.write("shared.burgeon", format!("param k: int = 1\n{reads}{QUARTERS}"));
    let ran = folder.run_in_vain(&run("shared.burgeon", &["--set", "k=2"]));
    assert_eq!(ran.succeeds().stdout, "quarters: 2 steps, 16 modules\n");
    ran.says(&["note: quarters does not read the param `k`"]);
    let ran = folder.run_in_vain(&run("shared.burgeon", &["--set", "k=2", "--system", "reads"]));
    assert_eq!((ran.succeeds().stdout.as_str(), ran.stderr.as_str()), ("reads: 2 steps, 16 modules\n", ""));
}

#[test]
fn another_file_in_place_of_the_axioms() {
    let folder = Folder::new();
    let two = format!("{}{}", NET.replacen('1', "2", 1), NET.split_once('\n').expect("lines").1);
    folder.write("two.bpt", &two);
    folder.write("elsewhere.BPT", &two);
    for file in ["two.bpt", "elsewhere.BPT"] {
        let ran = folder.run_in_vain(&run("quarters.burgeon", &["--in", file]));
        assert_eq!(ran.succeeds().stdout, "quarters: 2 steps, 32 modules\n");
    }
    // All sources that name the first file, and no other: 2 + 2 + 1 roots.
    let axiom = "axiom: P(0) = file \"gone.bpt\"  P(1) = file \"gone.bpt\"  P(2) = file \"net.bpt\"\n";
    folder.write("three.burgeon", QUARTERS.replace("axiom: P(0) = file \"net.bpt\"\n", axiom));
    let ran = folder.run_in_vain(&run("three.burgeon", &["--in", "two.bpt", "--steps", "0"]));
    assert_eq!(ran.succeeds().stdout, "quarters: 0 steps, 5 modules\n");
}

#[test]
fn nothing_to_put_another_file_in_place_of() {
    let folder = Folder::new();
    let points: Vec<String> =
        NET.lines().skip(2).map(|line| format!("({})", line.replace(' ', ","))).collect();
    let net: Vec<String> = points.chunks(4).map(|row| format!("[{}]", row.join(", "))).collect();
    let axiom = format!("axiom: P(0) = [{}]", net.join(", "));
    folder.write("inline.burgeon", QUARTERS.replace("axiom: P(0) = file \"net.bpt\"", &axiom));
    assert_eq!(
        folder.run_in_vain(&run("inline.burgeon", &[])).succeeds().stdout,
        "quarters: 2 steps, 16 modules\n"
    );
    folder
        .run_in_vain(&run("inline.burgeon", &["--in", "net.bpt"]))
        .fails(2, &["--in net.bpt", "names no file"]);
}

#[test]
fn files_are_relative_to_the_rule_file() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("inner")).expect("a folder");
    let mut command = folder.command(&run("../quarters.burgeon", &["--out", "here.json"]));
    command.current_dir(folder.path("inner"));
    ran(command).succeeds();
    assert!(folder.holds("inner/here.json"));
}

#[test]
fn any_number_of_threads_gives_the_same_word() {
    let folder = Folder::new();
    for (threads, out) in [("1", "one.json"), ("3", "three.json"), ("0", "all.json")] {
        folder.run(&run("quarters.burgeon", &["--threads", threads, "--out", out])).succeeds();
    }
    assert_eq!(folder.read("one.json"), folder.read("three.json"));
    assert_eq!(folder.read("one.json"), folder.read("all.json"));
    folder.run_in_vain(&run("quarters.burgeon", &["--threads", "1025"])).fails(2, &["--threads"]);
}

/// The CPU backend looks for no adapter, so even one that does not exist is no matter.
#[test]
fn the_cpu_backend_opens_no_device() {
    let folder = Folder::new();
    folder.run_in_vain(&run("quarters.burgeon", &["--adapter", "no such adapter"])).succeeds();
    let out = ["--adapter", "no such adapter", "--out", "a.obj", "--out", "a.json", "--out", "a.bpt"];
    folder.run(&run("quarters.burgeon", &out)).succeeds();
}

#[test]
fn stats_are_one_line_of_json() {
    let folder = Folder::new();
    let ran = folder.run_in_vain(&run("quarters.burgeon", &["--stats"]));
    assert_eq!(ran.succeeds().stdout.lines().count(), 1);
    let stats: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let names: Vec<&str> = stats.as_object().expect("an object").keys().map(String::as_str).collect();
    assert_eq!(names, ["adapter", "backend", "compile_ms", "peak_bytes", "steps", "total_ms"]);
    assert_eq!(stats["backend"], "cpu");
    let steps = stats["steps"].as_array().expect("an array");
    assert_eq!(steps.iter().map(|s| s["modules"].as_u64()).collect::<Vec<_>>(), [Some(4), Some(16)]);
    assert!(steps.iter().all(|s| s["ms"].as_f64().is_some_and(|ms| ms >= 0.0)));
    assert!(stats["total_ms"].as_f64() > Some(0.0) && stats["compile_ms"].as_f64() >= Some(0.0));
    // 16 modules of 16 points beside the 4 that they come from.
    assert!(stats["peak_bytes"].as_u64() >= Some(20 * 256), "{stats}");
}

/// Growth that is sure is refused before a step is taken; other growth as soon as it does not fit.
#[test]
fn the_memory_budget_holds() {
    let folder = Folder::new();
    let sure = rules("  P(n) -> [ P(n) P(n) ; P(n) P(n) ]\nrun:\n  derive 1000000\n");
    folder.write("sure.burgeon", sure);
    let unsure = "  P(n) : n < 1000000 -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]\nrun:\n  derive until terminal max 1000000\n";
    folder.write("unsure.burgeon", rules(unsure));
    for file in ["sure.burgeon", "unsure.burgeon"] {
        let start = Instant::now();
        folder
            .run_in_vain(&run(file, &["--max-memory", "1M", "--out", "a.json"]))
            .fails(3, &["step 6 needs at least", "the memory budget is 1.00 MiB", "--max-memory"]);
        assert!(start.elapsed() < LIMIT / 4);
    }
    // With what the machine has, too; only the sure one, since the other takes its time.
    folder.run_in_vain(&run("sure.burgeon", &["--out", "a.json"])).fails(3, &["the memory budget is"]);
    folder.run_in_vain(&run("quarters.burgeon", &["--max-memory", "1"])).fails(3, &["the axiom alone"]);
    folder.run_in_vain(&run("quarters.burgeon", &["--max-memory", "1 GiB"])).fails(2, &["--max-memory"]);
    for size in ["10000", "100k", "100K", "1M", "1MB", "1MiB", "1G", "1g", "1T"] {
        folder.run_in_vain(&run("quarters.burgeon", &["--max-memory", size])).succeeds();
    }
    for size in ["", "G", "-1", "1.5G", "1Q", "99999999999G", "99999999999999999999"] {
        folder.run_in_vain(&run("quarters.burgeon", &["--max-memory", size])).fails(2, &["--max-memory"]);
    }
}

#[test]
fn nets_cannot_be_halved_for_ever() {
    let folder = Folder::new();
    folder.write("deep.burgeon", rules("  P(n) -> [ P(n) | eps ]\nrun:\n  derive 1000000\n"));
    let ran = folder.run_in_vain(&run("deep.burgeon", &["--out", "a.json"]));
    ran.fails(3, &["halved more than 31 times", "step 32"]);
}

#[test]
fn help_and_version() {
    let folder = Folder::new();
    let ran = folder.run_in_vain(&["--help"]);
    let commands =
        ["run", "tessellate", "check", "wgsl", "matrix", "infer", "compare", "selftest", "devices", "bench"];
    for command in commands {
        assert!(ran.succeeds().stdout.contains(&format!("\n  {command} ")), "{ran:?}");
        let help = folder.run_in_vain(&[command, "--help"]);
        assert!(help.succeeds().stdout.contains(&format!("Usage: burgeon {command}")), "{help:?}");
        assert!(help.stdout.lines().all(|line| line.chars().count() <= 100), "{help:?}");
    }
    let headings =
        ["Derivation", "Viewer", "Machine", "Output", "Triangles of patches", "Curves", "Pictures"];
    let help = folder.run_in_vain(&["run", "--help"]).stdout;
    headings.iter().for_each(|name| assert!(help.contains(&format!("\n{name}:\n")), "no {name} in {help}"));
    // No flag of a heading stands under the one before.
    let derivation = help.split("\nDerivation:\n").nth(1).and_then(|rest| rest.split("\n\n").next());
    assert!(
        derivation.is_some_and(|text| text.contains("--seed") && !text.contains("FILE.burgeon")),
        "{help}"
    );
    assert!(ran.stdout.contains("130  stopped by Ctrl-C"), "{ran:?}");
    let flags = [
        "--system",
        "--in",
        "--steps",
        "--set",
        "--backend",
        "--threads",
        "--adapter",
        "--max-memory",
        "--grid",
        "--tolerance",
        "--min-depth",
        "--max-depth",
        "--wireframe",
        "--by-symbol",
        "--up",
        "--stats",
        "--out",
    ];
    let help = folder.run_in_vain(&["run", "--help"]).stdout;
    flags.iter().for_each(|flag| assert!(help.contains(flag), "no {flag} in {help}"));
    let version = folder.run_in_vain(&["--version"]);
    assert_eq!(version.succeeds().stdout, format!("burgeon {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_usage() {
    let folder = Folder::new();
    let ran = folder.run_in_vain(&[]);
    assert_eq!(ran.status, Some(2));
    ran.says(&["Usage: burgeon <COMMAND>"]);
    let cases: [(&[&str], &str); 10] = [
        (&["grow"], "grow"),
        (&["run"], "<FILE.burgeon>"),
        (&["run", "a.burgeon", "b.burgeon"], "b.burgeon"),
        (&["run", "quarters.burgeon", "--bakend", "cpu"], "--backend"),
        (&["run", "quarters.burgeon", "--backend", "tpu"], "auto, gpu, cpu"),
        (&["run", "quarters.burgeon", "--up", "x"], "y, z"),
        (&["run", "quarters.burgeon", "--grid", "0"], "--grid"),
        (&["run", "quarters.burgeon", "--grid", "257"], "--grid"),
        (&["run", "net.bpt"], "net.bpt holds patches, not rules"),
        (&["bench", "nothing"], "no bench `nothing`"),
    ];
    for (args, said) in cases {
        folder.run_in_vain(args).fails(2, &[said]);
    }
}

/// `burgeon wgsl … | head` is no failure; a full disk is.
#[test]
fn a_reader_that_goes_away() {
    let folder = Folder::new();
    for args in [&["wgsl", "quarters.burgeon"][..], &["check", "quarters.burgeon"], &["run", "--help"]] {
        let mut command = folder.command(args);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        drop(child.stdout.take());
        let ran = finished(child, "a closed pipe");
        assert_eq!((ran.succeeds().stderr.as_str(), ran.stdout.as_str()), ("", ""));
    }
    #[cfg(target_os = "linux")]
    {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
        let mut command = folder.command(&["check", "quarters.burgeon"]);
        let child = command.stdout(full).stderr(Stdio::piped()).spawn().expect("it starts");
        finished(child, "a full disk").fails(1, &["standard output"]);
    }
}

#[test]
fn check_says_what_it_found() {
    let folder = Folder::new();
    let ran = folder.run_in_vain(&["check", "quarters.burgeon"]);
    assert_eq!(ran.succeeds().stdout, "quarters: checked and compiled, 1 root\n");
    let params =
        "param depth: int = 2 in 0 .. 9\nparam bend: float = 1e-5\nparam eye: vec3 = (0, -1.5, 4)\nmodule";
    let rule = "P(n) : n < depth && eye.x + bend > 0 ->";
    folder.write("p.burgeon", QUARTERS.replace("module", params).replace("P(n) ->", rule));
    let ran = folder.run_in_vain(&["check", "p.burgeon"]);
    let lines =
        "  param depth: int = 2 in 0 .. 9\n  param bend: float = 1e-5\n  param eye: vec3 = (0, -1.5, 4)\n";
    assert_eq!(ran.succeeds().stdout, format!("quarters: checked and compiled, 1 root\n{lines}"));
    for entry in std::fs::read_dir(example("")).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "burgeon") {
            let ran = folder.run_in_vain(&["check", &path.display().to_string()]);
            assert!(ran.succeeds().stdout.contains("checked"), "{ran:?}");
            assert_eq!(ran.stderr, "");
        }
    }
}

#[test]
fn check_says_everything_that_is_wrong() {
    let folder = Folder::new();
    let text = "system wrong : patch bezier 3\nmodule P(n: int)\naxiom: P(1.5) = file \"net.bpt\"\nrules:\n  \
                P(n) : n -> P(n)\n  P(n) -> P(n, n)\n  P(n) -> [ P(m) | eps ]\nrun:\n  derive many\n";
    folder.write("wrong.burgeon", text);
    let places =
        ["wrong.burgeon:3:", "wrong.burgeon:5:", "wrong.burgeon:6:", "wrong.burgeon:7:", "wrong.burgeon:9:"];
    for command in ["check", "run", "wgsl"] {
        let ran = folder.run_in_vain(&[command, "wrong.burgeon"]);
        ran.fails(1, &places).says(&["errors\n"]);
    }
}

#[test]
fn check_accepts_what_is_not_derived_and_says_so() {
    let folder = Folder::new();
    folder.write("mesh.burgeon", "system m : mesh\naxiom: box(1, 1, 1)\nrun:\n  subdivide catmull_clark 1\n");
    let ran = folder.run_in_vain(&["check", "mesh.burgeon"]);
    assert_eq!(ran.succeeds().stdout, "m: checked; this version does not derive mesh systems, line 1\n");
}

#[test]
fn check_reads_the_files_that_are_there() {
    let folder = Folder::new();
    folder.write("gone.burgeon", QUARTERS.replace("net.bpt", "gone.bpt"));
    let ran = folder.run_in_vain(&["check", "gone.burgeon"]);
    assert!(ran.succeeds().stdout.contains("cannot read gone.bpt: there is no such file"), "{ran:?}");
    folder.write("nan.bpt", NET.replace("2 2 0", "2 nan 0"));
    folder.write("nan.burgeon", QUARTERS.replace("net.bpt", "nan.bpt"));
    folder.run_in_vain(&["check", "nan.burgeon"]).fails(1, &["nan.bpt:13:3", "finite"]);
    folder.write("index.burgeon", QUARTERS.replace("net.bpt\"", "net.bpt\" [7]"));
    folder.run_in_vain(&["check", "index.burgeon"]).fails(1, &["index.burgeon:3:", "7"]);
    folder.write("none.burgeon", QUARTERS.replace("axiom: P(0) = file \"net.bpt\"\n", ""));
    let ran = folder.run_in_vain(&["check", "none.burgeon"]);
    assert!(ran.succeeds().stdout.contains("`run` needs an axiom"), "{ran:?}");
}

#[test]
fn wgsl_is_printed_for_every_pass() {
    let folder = Folder::new();
    // Where the growth is a closed form nothing is matched or counted.
    let ran = folder.run_in_vain(&["wgsl", "quarters.burgeon"]);
    assert_eq!(ran.succeeds().stderr, "");
    assert!(ran.stdout.starts_with("// ---- emit") && ran.stdout.matches("// ----").count() == 1);
    let text = "system some : patch bezier 3\nmodule P(n: int)\naxiom: P(2) = file \"x.bpt\"\nrules:\n  P(n) : n > 0 -> [ P(n - 1) | eps ]\n";
    folder.write("some.burgeon", text);
    let ran = folder.run_in_vain(&["wgsl", "some.burgeon"]);
    assert_eq!(ran.succeeds().stderr, "");
    for kernel in ["match_modules of some, stage 1", "count", "emit", "scan", "compact", "retire"] {
        assert!(ran.stdout.contains(&format!("// ---- {kernel}")), "{kernel}");
    }
    assert_eq!(ran.stdout.matches("// ----").count(), 6);
    for source in ran.stdout.split("// ----").skip(1) {
        let module = naga::front::wgsl::parse_str(source.split_once('\n').expect("a title").1);
        assert!(module.is_ok_and(|m| !m.entry_points.is_empty()));
    }
    folder.run_in_vain(&["wgsl", "quarters.burgeon", "--system", "none"]).fails(2, &["no system `none`"]);
}
