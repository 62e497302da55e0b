//! Every format from the outside: what one run writes, another reads.

use super::*;
use burgeon::io::{bpt, bv};

const CPU: [&str; 2] = ["--backend", "cpu"];

fn run(folder: &Folder, more: &[&str]) -> Ran {
    folder.run(&[&["run", "quarters.burgeon"], &CPU[..], more].concat())
}

fn run_in_vain(folder: &Folder, more: &[&str]) -> Ran {
    folder.run_in_vain(&[&["run", "quarters.burgeon"], &CPU[..], more].concat())
}

/// Control points in rows of `columns`, a hill.
fn control_points(rows: usize, columns: usize) -> String {
    let cells = |m: usize, n: usize| (0..m).flat_map(move |i| (0..n).map(move |j| (i, j)));
    let vertices = cells(rows, columns).map(|(i, j)| format!("v {i} {j} {}\n", (i * j) % 3));
    let faces = cells(rows - 1, columns - 1).map(|(i, j)| {
        let a = i * columns + j + 1;
        format!("f {a} {} {} {}\n", a + columns, a + columns + 1, a + 1)
    });
    vertices.chain(faces).collect()
}

/// Nets survive every format that holds them: the same bits come out.
#[test]
fn what_is_written_is_read() {
    let folder = Folder::new();
    folder.write("third.bpt", NET.replace("2 2 0", "0.1 0.7 -0.0"));
    let outs = ["--out", "a.bpt", "--out", "a.bv", "--out", "a.json"];
    run(&folder, &[&["--in", "third.bpt"], &outs[..]].concat()).succeeds();
    assert_eq!(
        bv::parse(&folder.read("a.bv"), false).map(|read| read.value).ok(),
        bpt::parse(&folder.read("a.bpt"), false).ok()
    );
    for input in ["a.bpt", "a.bv", "a.json"] {
        let ran = run(&folder, &["--in", input, "--steps", "0", "--out", "b.bpt"]);
        assert_eq!(ran.succeeds().stdout, "quarters: 0 steps, 16 modules\n");
        assert_eq!(folder.text("b.bpt"), folder.text("a.bpt"), "{input}");
    }
}

/// Weights and other degrees, too: a quarter of a cylinder, whose points in a `.bv` are homogeneous.
#[test]
fn rational_nets_of_other_degrees() {
    let folder = Folder::new();
    let quarter = "8\n2 1\n1 0 0 1\n1 0 2 1\n0.7 0.7 0 0.7\n0.7 0.7 1.4 0.7\n0 1 0 1\n0 1 2 1\n";
    folder.write("quarter.bv", quarter);
    let rational = QUARTERS.replace("bezier 3", "bezier 2 1 rational");
    folder.write("quarters.burgeon", rational.replace("net.bpt", "quarter.bv"));
    run(&folder, &["--out", "a.bv", "--out", "a.bpt", "--out", "a.json"]).succeeds();
    let nets = bv::parse(&folder.read("a.bv"), true).expect("nets").value;
    assert_eq!((nets.len(), nets[0].degree, nets[0].points[0]), (16, [2, 1], [1.0, 0.0, 0.0, 1.0]));
    for input in ["a.bv", "a.bpt", "a.json"] {
        run(&folder, &["--in", input, "--steps", "0", "--out", "b.bv"]).succeeds();
        assert_eq!(folder.text("b.bv"), folder.text("a.bv"), "{input}");
    }
    folder.write("quarters.burgeon", QUARTERS.replace("bezier 3", "bezier 2 1"));
    run_in_vain(&folder, &["--in", "quarter.bv"]).fails(1, &["quarter.bv:5:11", "weights must be 1"]);
    run_in_vain(&folder, &["--in", "a.json"]).fails(1, &["a.json: point ", "the nets wanted are polynomial"]);
}

/// The rule file may name any of them, and `--in` takes the place of any.
#[test]
fn the_axiom_names_any_format() {
    let folder = Folder::new();
    run(&folder, &["--steps", "0", "--out", "once.bv", "--out", "once.JSON"]).succeeds();
    for name in ["once.bv", "once.JSON"] {
        folder.write("named.burgeon", QUARTERS.replace("net.bpt", name));
        let named = folder.run(&[&["run", "named.burgeon"], &CPU[..], &["--out", "named.bpt"]].concat());
        assert_eq!(named.succeeds().stdout, "quarters: 2 steps, 16 modules\n");
        run(&folder, &["--out", "plain.bpt"]).succeeds();
        assert_eq!(folder.text("named.bpt"), folder.text("plain.bpt"));
        folder.run(&["check", "named.burgeon"]).succeeds();
    }
    // Symbols and parameters are the axiom's, not those of the word.
    run(&folder, &["--out", "twice.json"]).succeeds();
    run(&folder, &["--in", "twice.json", "--steps", "0", "--out", "fresh.json"]).succeeds();
    assert!(folder.text("twice.json").contains("\"params\":[2]"));
    assert!(!folder.text("fresh.json").contains("\"params\":[2]"));
}

#[test]
fn meshes_by_extension() {
    let folder = Folder::new();
    let args = ["--grid", "2", "--out", "a.ply", "--out", "a.glb", "--out", "a.GLB", "--up", "z"];
    run(&folder, &args).succeeds();
    let ply = folder.read("a.ply");
    let header = String::from_utf8_lossy(&ply[..ply.len().min(400)]).into_owned();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\ncomment burgeon "), "{header}");
    assert!(header.contains("\nelement vertex 144\n") && header.contains("\nelement face 128\n"), "{header}");
    let gltf = gltf::Gltf::from_slice(&folder.read("a.glb")).expect("a valid glTF");
    let node = gltf.nodes().next().expect("a node");
    assert_eq!((node.name(), node.transform().matrix()[2][1]), (Some("quarters"), 1.0));
    assert_eq!(gltf.accessors().map(|a| a.count()).collect::<Vec<_>>(), [144, 144, 144, 384]);
    assert_eq!(folder.read("a.glb"), folder.read("a.GLB"));
}

#[test]
fn an_empty_word() {
    let folder = Folder::new();
    folder.write("none.bv", "Group 0 none\n");
    let outs = ["a.bv", "a.ply", "a.glb"];
    let flags: Vec<&str> = outs.iter().flat_map(|out| ["--out", out]).collect();
    run(&folder, &[&["--in", "none.bv"], &flags[..]].concat()).succeeds();
    run(&folder, &["--in", "a.bv", "--out", "b.bpt"]).succeeds();
    assert_eq!(folder.text("b.bpt"), "0\n");
    assert!(gltf::Gltf::from_slice(&folder.read("a.glb")).is_ok_and(|gltf| gltf.meshes().len() == 0));
}

#[test]
fn control_points_of_a_bspline() {
    let folder = Folder::new();
    folder.write("cage.obj", control_points(5, 6));
    let ran = run(&folder, &["--in", "cage.obj", "--bspline", "--steps", "0", "--out", "a.bpt"]);
    assert_eq!(ran.succeeds().stdout, "quarters: 0 steps, 6 modules\n");
    assert_eq!(bpt::parse(&folder.read("a.bpt"), false).expect("nets")[0].points[0][..2], [1.0, 1.0]);
    folder.write("named.burgeon", QUARTERS.replace("net.bpt", "cage.obj"));
    let named = [&["run", "named.burgeon", "--bspline"], &CPU[..]].concat();
    assert_eq!(folder.run(&named).succeeds().stdout, "quarters: 2 steps, 96 modules\n");
    folder.run(&["check", "named.burgeon"]).succeeds();
    let without = run_in_vain(&folder, &["--in", "cage.obj"]);
    without.fails(1, &["cannot read cage.obj", "holds a mesh", "--bspline"]);
    run_in_vain(&folder, &["--bspline"]).fails(2, &["--bspline is for an .obj"]);
    run_in_vain(&folder, &["--bspline", "--in", "net.bpt"]).fails(2, &["--bspline is for an .obj"]);
}

#[cfg(feature = "gpu")]
#[test]
fn compare_reads_them_too() {
    let Some(adapter) = gpu() else { return };
    let folder = Folder::new();
    folder.write("cage.obj", control_points(4, 5));
    let adapter: Vec<&str> = adapter.iter().map(String::as_str).collect();
    let args = ["compare", "quarters.burgeon", "--steps", "1", "--in", "cage.obj", "--bspline"];
    let ran = folder.run(&[&args[..], &adapter].concat());
    assert!(ran.succeeds().stdout.contains("1 step, 8 modules"), "{ran:?}");
}

/// What is wrong with a file is said once, with its place and, where there is one, the line.
#[test]
fn bad_files() {
    let folder = Folder::new();
    let bilinear = "4\n1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n";
    let cage = control_points(4, 4);
    run(&folder, &["--steps", "0", "--out", "good.json"]).succeeds();
    let json = folder.text("good.json");
    let swap = |from: &str, to: &str| json.replacen(from, to, 1);
    let long = |text: &str| text.repeat(10_000_000 / text.len());
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("bv", String::new(), &["bad.bv:1:1: the file ends where the kind of patch 0"]),
        (
            "bv",
            "3\n2\n".into(),
            &["bad.bv:1:1", "patch 0 is a triangular patch, of kind 3; kinds 4, 5 and 8", "1 | 3"],
        ),
        ("bv", bilinear.replace("1 1 0", "1 x 0"), &["bad.bv:6:3", "`x`", "6 | 1 x 0"]),
        ("bv", bilinear.into(), &["patch 0 of bad.bv", "1×1", "3×3"]),
        ("bv", "8\n1 1\n0 0 0 2".into(), &["bad.bv:3:7", "weights must be 1", "3 | 0 0 0 2"]),
        ("bv", long("x"), &["bad.bv:1:1", "…"]),
        ("bv", format!("4\n3\n{}", long("0 ")), &["bad.bv:3:", "the kind of patch 1"]),
        ("json", String::new(), &["bad.json:1:1", "EOF"]),
        ("json", "[]".into(), &["bad.json:1:"]),
        ("json", "{\"version\": 1,\n \"kind\": \"patch\",\n x".into(), &["bad.json:3:2", "3 |  x"]),
        ("json", swap("\"version\":1", "\"version\":2"), &["bad.json: this is version 2"]),
        ("json", swap("\"patch\"", "\"mesh\""), &["bad.json: the word is of kind `mesh`"]),
        ("json", swap("[0.0,1.0,0.0,1.0]", "[0.0,1.0,0.0,0.0]"), &["point 1 of module 0 has the weight 0"]),
        (
            "json",
            swap("\"rational\":false", "\"rational\":true").replacen(
                "[0.0,1.0,0.0,1.0]",
                "[0.0,1.0,0.0,2.5]",
                1,
            ),
            &["point 1 of module 0 has the weight 2.5", "polynomial"],
        ),
        ("json", swap("[0.0,1.0,0.0,1.0]", "[0.0,1e39,0.0,1.0]"), &["bad.json:2:", "out of range"]),
        ("json", json[..json.len() - 20].into(), &["bad.json:", "EOF"]),
        ("json", "[".repeat(100_000), &["bad.json:1:"]),
        ("obj", String::new(), &["bad.obj:1:1", "no faces"]),
        (
            "obj",
            cage.replace("f 6 10 11 7", "f 6 10 11"),
            &["bad.obj:21:1: face 5 has 3 corners", "21 | f 6"],
        ),
        ("obj", cage.replace("f 6 10 11 7", "f 6 10 11 70"), &["bad.obj:21:11", "vertex 70", "has 16"]),
        (
            "obj",
            cage.replace("f 6 10 11 7\n", ""),
            &["bad.obj:6:1", "vertex 6 lies on the border", "6 | v 1 1"],
        ),
        ("obj", control_points(3, 5), &["the grid has 3 × 5 control points"]),
        ("obj", long("x"), &["bad.obj:1:1", "…"]),
        ("txt", bilinear.into(), &["cannot read bad.txt: patches are read from .bpt, .bv, .json"]),
    ];
    for (extension, text, said) in cases {
        let name = format!("bad.{extension}");
        folder.write(&name, text);
        let mut args = vec!["--in", &name, "--out", "a.json"];
        args.extend((extension == "obj").then_some("--bspline"));
        let ran = run_in_vain(&folder, &args);
        ran.fails(1, said);
        assert!(ran.stderr.lines().all(|line| line.chars().count() <= 220), "{ran:?}");
    }
    for extension in ["bv", "json"] {
        let name = format!("gone.{extension}");
        run_in_vain(&folder, &["--in", &name])
            .fails(1, &[&format!("cannot read {name}: there is no such file")]);
        folder.write(&name, "");
        folder.run_in_vain(&["run", &name]).fails(2, &["holds patches, not rules", "--in"]);
    }
}
