//! The files that a run writes, and does not write.

use super::*;
use burgeon::io::{bpt, json};

const CURVE: &str = "system c : curve ring\nmodule P(v: vec2)\naxiom: P((0,0)) P((4,0)) P((4,3))\nrules:\n  \
                     P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\nrun:\n  derive 2\n";

fn run(folder: &Folder, file: &str, outs: &[&str]) -> Ran {
    let mut args = vec!["run", file, "--backend", "cpu"];
    args.extend(outs.iter().flat_map(|out| ["--out", out]));
    folder.run(&args)
}

/// Lines that begin with a word, a word's count each.
fn lines(text: &str, word: &str) -> usize {
    text.lines().filter(|line| line.split(' ').next() == Some(word)).count()
}

#[test]
fn every_format_is_written_whole() {
    let folder = Folder::new();
    let ran = run(&folder, "quarters.burgeon", &["a.bpt", "a.json", "a.obj", "b.JSON"]);
    assert_eq!(ran.succeeds().stdout, "quarters: 2 steps, 16 modules\n");
    assert_eq!(bpt::parse(&folder.read("a.bpt"), false).expect("nets").len(), 16);
    let word = json::parse(&folder.read("a.json")).expect("a word");
    assert_eq!((word.system.as_str(), word.steps, word.modules.len()), ("quarters", 2, 16));
    assert_eq!(folder.read("a.json"), folder.read("b.JSON"));
    let obj = folder.text("a.obj");
    let counts = ["v", "vt", "vn", "f"].map(|k| lines(&obj, k));
    assert_eq!(counts, [16 * 81, 16 * 81, 16 * 81, 16 * 128]);
    assert_eq!(folder.files().len(), 6, "{:?}", folder.files().keys());
}

/// What one run writes another can read: two steps and two more are four.
#[test]
fn a_word_can_be_derived_further() {
    let folder = Folder::new();
    run(&folder, "quarters.burgeon", &["once.bpt"]).succeeds();
    let again = ["run", "quarters.burgeon", "--backend", "cpu", "--in", "once.bpt", "--out", "twice.bpt"];
    folder.run(&again).succeeds();
    folder.write("four.burgeon", QUARTERS.replace("derive 2", "derive 4"));
    run(&folder, "four.burgeon", &["four.bpt"]).succeeds();
    assert_eq!(folder.text("twice.bpt"), folder.text("four.bpt"));
}

#[test]
fn the_grid_is_what_is_asked_for() {
    let folder = Folder::new();
    for n in [1, 2, 7] {
        let grid = n.to_string();
        let args = ["run", "quarters.burgeon", "--backend", "cpu", "--grid", &grid, "--out", "a.obj"];
        folder.run(&args).succeeds();
        let obj = folder.text("a.obj");
        assert_eq!([lines(&obj, "v"), lines(&obj, "f")], [16 * (n + 1) * (n + 1), 16 * 2 * n * n]);
    }
    // 16,384 leaves with 8² cells each are over two million triangles; one that is asked for is kept all the same.
    folder.write("seven.burgeon", QUARTERS.replace("derive 2", "derive 7"));
    let seven = ["run", "seven.burgeon", "--backend", "cpu", "--out", "a.ply"];
    let faces = |count: usize| {
        let ply = folder.read("a.ply");
        String::from_utf8_lossy(&ply[..400]).contains(&format!("\nelement face {count}\n"))
    };
    folder.run(&seven).succeeds().says(&["note: a grid of 4 in place of 8: ", "2 million", "--grid N"]);
    assert!(faces(16384 * 32));
    let ran = folder.run(&[&seven[..], &["--grid", "8"]].concat());
    assert_eq!(ran.succeeds().stderr, "");
    assert!(faces(16384 * 128));
}

/// What is too much is said with its counts; what is no triangle is still written.
#[test]
fn a_grid_beyond_the_budget() {
    let folder = Folder::new();
    folder.write("six.burgeon", QUARTERS.replace("derive 2", "derive 6"));
    let args = ["run", "six.burgeon", "--backend", "cpu", "--grid", "256", "--max-memory", "64M", "--out"];
    let ran = folder.run(&[&args[..], &["a.obj", "--out", "a.bpt"]].concat());
    let counts = "a.obj: a grid of 256 × 256 on 4,096 modules makes 536,870,912 triangles, which take at least 14.06 GiB";
    ran.fails(3, &[counts, "the memory budget is 64.00 MiB", "a smaller --grid"]);
    assert!(folder.holds("a.bpt") && !folder.holds("a.obj"));
}

/// The standard output takes one file and nothing else, byte for byte.
#[test]
fn the_standard_output() {
    let folder = Folder::new();
    folder.write("c.burgeon", CURVE);
    let raw = |args: &[&str]| {
        let output = folder.command(args).stdin(Stdio::null()).output().expect("the command runs");
        assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        (output.stdout, String::from_utf8(output.stderr).expect("UTF-8"))
    };
    let patches = ["run", "quarters.burgeon", "--backend", "cpu"];
    let curves = ["run", "c.burgeon", "--backend", "cpu"];
    let mesh = ["tessellate", "net.bpt", "--backend", "cpu", "--tolerance", "1"];
    let of_patches = ["bpt", "bv", "json", "obj", "ply", "glb"].map(|format| (&patches[..], format));
    let of_curves = ["svg", "png", "obj", "csv", "json"].map(|format| (&curves[..], format));
    let of_mesh = ["obj", "ply", "glb"].map(|format| (&mesh[..], format));
    for (args, format) in of_patches.into_iter().chain(of_curves).chain(of_mesh) {
        let (content, said) = raw(&[args, &["--out", "-", "--format", format]].concat());
        let file = format!("a.{format}");
        let ran = folder.run(&[args, &["--out", &file]].concat());
        assert!(content == folder.read(&file) && !content.is_empty(), "{args:?} {format}");
        // What is said otherwise on stdout.
        assert_eq!(said.lines().last(), ran.succeeds().stdout.lines().last(), "{args:?} {format}");
    }
    let (word, said) =
        raw(&[&patches[..], &["--out", "-", "--format", "json", "--out", "b.json", "--stats"]].concat());
    assert!(json::parse(&word).is_ok_and(|word| word.modules.len() == 16) && word == folder.read("b.json"));
    assert!(
        serde_json::from_str::<serde_json::Value>(said.trim_end())
            .is_ok_and(|stats| stats["backend"] == "cpu")
    );
}

#[test]
fn the_standard_output_has_a_format() {
    let folder = Folder::new();
    folder.write("c.burgeon", CURVE);
    let cases: [(&str, &[&str], &[&str]); 6] = [
        ("quarters", &["--out", "-"], &["--format says, as in --format json", ".bpt, .bv, .json"]),
        ("quarters", &["--out", "-", "--format", "svg"], &["--format svg: patches are written as .bpt"]),
        ("c", &["--out", "-", "--format", "glb"], &["--format glb: curves are written as .svg"]),
        ("c", &["--out", "a.svg", "--format", "svg"], &["--format is for --out -", "the extension"]),
        ("c", &["--out", "-", "--out", "-", "--format", "svg"], &["--out - is given twice"]),
        ("c", &["--out", "./-"], &["--out ./-: curves are written as"]),
    ];
    for (file, flags, says) in cases {
        let file = format!("{file}.burgeon");
        folder.run_in_vain(&[&["run", &file, "--backend", "cpu"], flags].concat()).fails(2, says);
    }
    // What fails leaves nothing there, either.
    let args = ["run", "quarters.burgeon", "--backend", "cpu", "--grid", "256", "--max-memory", "1M"];
    let ran = folder.run_in_vain(&[&args[..], &["--out", "-", "--format", "obj"]].concat());
    ran.fails(3, &["the standard output: a grid of 256 × 256"]);
}

/// `burgeon run … --out - | head` is no failure; a full disk is.
#[test]
fn a_reader_of_the_standard_output_that_goes_away() {
    let folder = Folder::new();
    let args = ["run", "quarters.burgeon", "--backend", "cpu", "--out", "-", "--format", "obj"];
    let mut child =
        folder.command(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    drop(child.stdout.take());
    finished(child, "a closed pipe").succeeds();
    #[cfg(target_os = "linux")]
    {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full");
        let child = folder.command(&args).stdout(full).stderr(Stdio::piped()).spawn().expect("it starts");
        finished(child, "a full disk").fails(1, &["cannot write to the standard output: No space left"]);
    }
}

#[test]
fn an_old_file_is_replaced() {
    let folder = Folder::new();
    folder.write("a.json", "old");
    run(&folder, "quarters.burgeon", &["a.json"]).succeeds();
    assert!(folder.text("a.json").starts_with("{\"version\":1"));
}

#[test]
fn an_extension_that_nobody_writes() {
    let folder = Folder::new();
    for name in ["a.stp", "a", ".json", "a.json.gz", "/dev/stdout"] {
        let args = ["run", "quarters.burgeon", "--backend", "cpu", "--out", "a.json", "--out", name];
        folder.run_in_vain(&args).fails(2, &[name, ".bpt, .bv, .json, .obj, .ply, .glb, .stl or .png"]);
    }
}

#[test]
fn where_one_file_cannot_be_written_the_others_are() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.json")).expect("a folder");
    let outs = ["gone/a.json", "a.json", "folder.json", "net.bpt/a.obj", "a.obj"];
    let ran = run(&folder, "quarters.burgeon", &outs);
    ran.fails(1, &["gone/a.json: there is no folder gone", "folder.json", "net.bpt/a.obj"]);
    assert_eq!(ran.stderr.lines().count(), 3, "{ran:?}");
    assert_eq!(json::parse(&folder.read("a.json")).expect("a word").modules.len(), 16);
    assert_eq!(lines(&folder.text("a.obj"), "f"), 16 * 128);
    assert_eq!(folder.files().len(), 5, "{:?}", folder.files().keys());
    assert_eq!(folder.text("net.bpt"), NET);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/full", folder.path("full.json")).expect("a link");
    run(&folder, "quarters.burgeon", &["full.json"]).fails(1, &["full.json", "No space left"]);
    assert!(std::fs::symlink_metadata(folder.path("full.json")).is_ok_and(|m| m.is_symlink()));
}

/// Halving would leave the range of floats, so such nets are refused.
#[test]
fn coordinates_near_the_end_of_the_range_are_refused() {
    let folder = Folder::new();
    let great = NET.replace("3 3 0", "3e38 3e38 -3e38").replace("2 3 0", "3e38 3e38 -3e38");
    folder.write("net.bpt", great);
    let before = folder.files();
    let ran = run(&folder, "quarters.burgeon", &["a.json", "a.bpt", "a.obj"]);
    ran.fails(1, &["patch 0 of the axiom: point 11 is [3e38, 3e38, -3e38, 1.0]", "must lie within"]);
    assert!(before == folder.files());
}

/// A word may become empty, by `eps` or from a file without patches.
#[test]
fn an_empty_word_is_written() {
    let folder = Folder::new();
    folder.write("erase.burgeon", rules("  P(n) -> eps\nrun:\n  derive 2\n"));
    folder.write("none.bpt", "0\n");
    for args in [&["run", "erase.burgeon"][..], &["run", "quarters.burgeon", "--in", "none.bpt"]] {
        let outs = ["--backend", "cpu", "--out", "a.bpt", "--out", "a.json", "--out", "a.obj"];
        let ran = folder.run(&[args, &outs].concat());
        assert!(ran.succeeds().stdout.ends_with("2 steps, 0 modules\n"), "{ran:?}");
        assert_eq!(folder.text("a.bpt"), "0\n");
        assert_eq!(json::parse(&folder.read("a.json")).expect("a word").modules.len(), 0);
        assert_eq!(lines(&folder.text("a.obj"), "o"), 1);
        assert_eq!(["v", "f"].map(|k| lines(&folder.text("a.obj"), k)), [0, 0]);
    }
    // What was written can be read again.
    folder.run(&["run", "quarters.burgeon", "--in", "a.bpt", "--backend", "cpu"]).succeeds();
}

#[test]
fn counts_of_the_examples() {
    let folder = Folder::new();
    // The double Sierpinski has two alphabets over one another.
    let cases: [(&str, &[&str], u64); 4] = [
        ("sierpinski", &["--set", "depth=5"], 3u64.pow(5)),
        ("sierpinski2", &["--steps", "5"], 2 * 3u64.pow(5)),
        ("holes", &["--set", "depth=3"], 2 * 4u64.pow(3)),
        ("teapot", &["--set", "levels=3"], 32 * 4u64.pow(3)),
    ];
    for (name, more, modules) in cases {
        let file = example(&format!("{name}.burgeon"));
        let args = [&["run", &file, "--backend", "cpu", "--stats"][..], more].concat();
        let ran = folder.run_in_vain(&args);
        let stats: serde_json::Value = serde_json::from_str(&ran.succeeds().stdout).expect("JSON");
        let last = stats["steps"].as_array().and_then(|s| s.last()).expect("a step");
        assert_eq!(last["modules"], modules, "{name}");
    }
}
