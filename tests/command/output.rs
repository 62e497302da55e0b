//! The files that a run writes, and does not write.

use super::*;
use burgeon::io::{bpt, json};

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
    // 4,096 leaves with 256² cells each are over two million triangles; with 8² they are not.
    folder.write("six.burgeon", QUARTERS.replace("derive 2", "derive 6"));
    let args = ["run", "six.burgeon", "--backend", "cpu", "--grid", "256", "--out", "a.obj"];
    folder.run(&args).succeeds().says(&["--grid 8 in place of 256", "2 million"]);
    assert_eq!(lines(&folder.text("a.obj"), "f"), 4096 * 128);
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
