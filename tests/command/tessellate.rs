//! Watertight meshes: `tessellate`, and `run --tolerance`.

use super::*;
use burgeon::io::json;

fn tessellate<'a>(file: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["tessellate", file, "--backend", "cpu"][..], more].concat()
}

/// Bilinear nets, each by its corners (0, 0), (0, 1), (1, 0), (1, 1).
fn bilinear(nets: &[[[f32; 3]; 4]]) -> String {
    let point = |[x, y, z]: &[f32; 3]| format!("{x} {y} {z}\n");
    let net = |points: &[[f32; 3]; 4]| format!("1 1\n{}", points.iter().map(point).collect::<String>());
    format!("{}\n{}", nets.len(), nets.iter().map(net).collect::<String>())
}

/// The square from (x, y), so wide.
fn square(x: f32, y: f32, size: f32) -> [[f32; 3]; 4] {
    [[x, y, 0.0], [x, y + size, 0.0], [x + size, y, 0.0], [x + size, y + size, 0.0]]
}

/// A bump: one bicubic net, whose inner points are raised.
fn bump() -> String {
    NET.replace("1 1 0", "1 1 2")
        .replace("1 2 0", "1 2 2")
        .replace("2 1 0", "2 1 2")
        .replace("2 2 0", "2 2 2")
}

/// Lines that begin with a word.
fn lines<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    text.lines().filter(|line| line.split(' ').next() == Some(word)).collect()
}

#[test]
fn a_mesh_shares_its_vertices() {
    let folder = Folder::new();
    folder.write("two.bpt", bilinear(&[square(0.0, 0.0, 1.0), square(1.0, 0.0, 1.0)]));
    let outs = ["--tolerance", "0.1", "--out", "a.obj", "--out", "a.ply", "--out", "a.glb"];
    let ran = folder.run(&tessellate("two.bpt", &outs));
    assert_eq!(ran.succeeds().stdout, "two: 2 patches, 6 vertices, 4 triangles\n");
    ran.says(&["note: the surface is open at 6 sides"]);
    assert_eq!(ran.stderr.lines().count(), 1, "{ran:?}");
    let obj = folder.text("a.obj");
    assert_eq!(["v", "vn", "vt", "f"].map(|k| lines(&obj, k).len()), [6, 6, 6, 4]);
    let ply = folder.read("a.ply");
    let header = String::from_utf8_lossy(&ply[..ply.len().min(400)]).into_owned();
    assert!(header.contains("\nelement vertex 6\n") && header.contains("\nelement face 4\n"), "{header}");
    let gltf = gltf::Gltf::from_slice(&folder.read("a.glb")).expect("a valid glTF");
    assert_eq!(gltf.nodes().next().and_then(|n| n.name()), Some("two"));
    assert_eq!(gltf.accessors().map(|a| a.count()).collect::<Vec<_>>(), [6, 6, 6, 12]);
    // And one patch is not many.
    let ran = folder.run(&tessellate("net.bpt", &["--tolerance", "1"]));
    assert_eq!(ran.succeeds().stdout, "net: 1 patch, 4 vertices, 2 triangles\n");
}

#[test]
fn finer_tolerances_take_more_triangles_and_depths_bound_them() {
    let folder = Folder::new();
    folder.write("bump.bpt", bump());
    let triangles = |more: &[&str]| {
        let ran = folder.run_in_vain(&tessellate("bump.bpt", more));
        let last = ran.succeeds().stdout.trim_end().rsplit(", ").next().map(str::to_string);
        last.and_then(|t| t.split(' ').next()?.replace(',', "").parse::<u32>().ok()).expect("triangles")
    };
    let of = |tolerance: &str| triangles(&["--tolerance", tolerance]);
    let counts = [of("100"), of("0.5"), of("0.05"), of("1e-2")];
    assert!(counts[0] == 2 && counts.is_sorted() && counts[3] > 100, "{counts:?}");
    assert_eq!(triangles(&["--tolerance", "100", "--min-depth", "2"]), 2 * 16);
    assert_eq!(triangles(&["--tolerance", "1e-9", "--max-depth", "3"]), 2 * 64);
    assert_eq!(triangles(&["--tolerance", "1e-9", "--min-depth", "3", "--max-depth", "3"]), 2 * 64);
    let most = folder.run_in_vain(&tessellate("bump.bpt", &["--tolerance", "1e-9", "--max-depth", "2"]));
    most.succeeds().says(&["halved 2 times the tolerance may not be kept", "a greater --max-depth may help"]);
}

/// What is far from the origin takes no more triangles, and a note says what rounding adds there.
#[test]
fn far_from_the_origin() {
    let folder = Folder::new();
    folder.write("far.bpt", bilinear(&[square(10000.0, 0.0, 1.0)]));
    let ran = folder.run_in_vain(&tessellate("far.bpt", &[]));
    assert_eq!(ran.succeeds().stdout, "far: 1 patch, 4 vertices, 2 triangles\n");
    ran.says(&["note: rounding adds up to 0.0008 to the tolerance of 0.0014: numbers of single precision lie 0.00098 apart at 10001\n"]);
    let near = folder.run_in_vain(&tessellate("net.bpt", &[]));
    assert!(!near.succeeds().stderr.contains("rounding"), "{near:?}");
    // One stray point makes one large patch.
    folder.write("stray.bpt", bump().replace("2 2 2", "1e30 2 2"));
    let ran = folder.run_in_vain(&tessellate("stray.bpt", &[]));
    ran.succeeds();
    // As small as single precision tells.
    folder.write("small.bpt", bilinear(&[square(0.0, 0.0, 1e-30)]));
    let ran = folder.run_in_vain(&tessellate("small.bpt", &[]));
    assert_eq!(ran.succeeds().stdout, "small: 1 patch, 4 vertices, 2 triangles\n");
}

/// The note names a tolerance that gives the same mesh.
#[test]
fn without_a_tolerance_there_is_a_default() {
    let folder = Folder::new();
    folder.write("bump.bpt", bump());
    let ran = folder.run(&tessellate("bump.bpt", &["--out", "a.obj"]));
    let note = "note: --tolerance 0.0047, a thousandth of the model's diagonal";
    ran.succeeds().says(&[note]);
    let ran = folder.run(&tessellate("bump.bpt", &["--tolerance", "0.0047", "--out", "b.obj"]));
    assert!(!ran.succeeds().stderr.contains("--tolerance"), "{ran:?}");
    assert!(folder.read("a.obj") == folder.read("b.obj"));
    // All control points in one place have no triangles, and no diagonal.
    folder.write("point.bpt", bilinear(&[[[1.0; 3]; 4]]));
    let ran = folder.run(&tessellate("point.bpt", &["--out", "p.obj"]));
    assert!(ran.succeeds().stdout.ends_with(", 0 triangles\n"), "{ran:?}");
    ran.says(&["--tolerance 1,", "patch 0 has two neighbouring sides that are points"]);
}

#[test]
fn patches_of_every_kind_and_format() {
    let folder = Folder::new();
    let quarter = "8\n2 1\n1 0 0 1\n1 0 2 1\n0.7 0.7 0 0.7\n0.7 0.7 1.4 0.7\n0 1 0 1\n0 1 2 1\n";
    folder.write("quarter.bv", quarter);
    let ran = folder.run_in_vain(&tessellate("quarter.bv", &["--tolerance", "0.01"]));
    assert!(ran.succeeds().stdout.starts_with("quarter: 1 patch, "), "{ran:?}");
    folder.run(&["run", "quarters.burgeon", "--backend", "cpu", "--out", "word.json"]).succeeds();
    let ran = folder.run_in_vain(&tessellate("word.json", &["--tolerance", "1"]));
    assert_eq!(ran.succeeds().stdout, "word: 16 patches, 25 vertices, 32 triangles\n");
    let cage: String = (0..4).flat_map(|i| (0..4).map(move |j| format!("v {i} {j} 0\n"))).collect();
    let quads = (0..3).flat_map(|i| (1..4).map(move |j| 4 * i + j));
    let quads: String = quads.map(|a| format!("f {a} {} {} {}\n", a + 4, a + 5, a + 1)).collect();
    folder.write("cage.obj", cage + &quads);
    let ran = folder.run_in_vain(&tessellate("cage.obj", &["--bspline", "--tolerance", "1"]));
    assert_eq!(ran.succeeds().stdout, "cage: 1 patch, 4 vertices, 2 triangles\n");
    folder.run_in_vain(&tessellate("cage.obj", &[])).fails(1, &["cannot read cage.obj", "--bspline"]);
    let teapot = example("data/teapot.bpt");
    let ran = folder.run_in_vain(&tessellate(&teapot, &["--tolerance", "0.1", "--threads", "2"]));
    assert!(ran.succeeds().stdout.starts_with("teapot: 32 patches, "), "{ran:?}");
}

#[test]
fn files_that_cannot_be_tessellated() {
    let folder = Folder::new();
    folder.write("none.bpt", "0\n");
    let mixed =
        format!("2\n{}{}", NET.split_once('\n').expect("lines").1, "1 1\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n");
    folder.write("mixed.bpt", mixed);
    folder.write("nan.bpt", NET.replace("2 2 0", "2 nan 0"));
    folder.write("great.bpt", NET.replace("3 3 0", "3e38 3e38 -3e38"));
    let cases: [(&str, i32, &[&str]); 8] = [
        ("none.bpt", 1, &["none.bpt holds no patches; one at least is needed"]),
        ("mixed.bpt", 1, &["patch 1 of mixed.bpt has degree 1×1, and patch 0 3×3", "help: "]),
        ("nan.bpt", 1, &["nan.bpt:", "`nan`; coordinates must be finite"]),
        ("great.bpt", 1, &["patch 0 of great.bpt: point 15", "must lie within"]),
        ("gone.bpt", 1, &["cannot read gone.bpt: there is no such file"]),
        ("net.stl", 1, &["cannot read net.stl: patches are read from .bpt, .bv, .json"]),
        ("quarters.burgeon", 2, &["holds rules, not patches", "burgeon run quarters.burgeon --tolerance"]),
        (".", 1, &["cannot read ."]),
    ];
    for (file, status, said) in cases {
        let outs = ["--out", "a.obj", "--out", "a.glb"];
        folder.run_in_vain(&tessellate(file, &outs)).fails(status, said);
        // Whatever is wrong with the flags beside.
        for flags in [&["--out", "a.bpt"][..], &["--out", "-"], &["--tolerance", "1px"], &["--eye", "1,2,3"]]
        {
            folder.run_in_vain(&tessellate(file, flags)).fails(status, said);
        }
    }
}

#[test]
fn wrong_usage_of_a_tessellation() {
    let folder = Folder::new();
    let cases: [(&[&str], &[&str]); 24] = [
        (&["--tolerance", "1e-50"], &["--tolerance", "too small for single precision; the least is 1e-"]),
        (&["--tolerance", "1e-5000"], &["--tolerance", "too small for single precision"]),
        (&["--tolerance", "1e50"], &["--tolerance", "too large for single precision"]),
        (&["--tolerance", "-1e-50"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "0e9"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "1px", "--eye", "nan,0,0"], &["--eye", "must be finite"]),
        (&["--tolerance", "1px", "--eye", "0,0,1e99"], &["--eye", "must be finite"]),
        (&["--out", "a.obj", "--out", "b.obj", "--out", "a.obj"], &["--out a.obj is given twice"]),
        (&["--tolerance", "0"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "-0.1"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "nan"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "inf"], &["--tolerance", "a number above 0"]),
        (&["--tolerance", "-2px"], &["--tolerance", "0.5px (pixels)"]),
        (&["--tolerance", "1mm"], &["--tolerance", "0.01 (units of the model)"]),
        (&["--tolerance", "1e-37"], &["--tolerance: a tolerance of 1e-37", "scale the model up"]),
        (&["--tolerance", "1px"], &["--tolerance 1px", "--eye X,Y,Z"]),
        (&["--eye", "1,2,3"], &["--eye is for a tolerance in pixels"]),
        (
            &["--tolerance", "1px", "--eye", "1,2,3", "--look-at", "1,2,3"],
            &["--eye 1,2,3", "--look-at X,Y,Z"],
        ),
        (&["--tolerance", "1px", "--eye", "3e38,0,-3e38"], &["--eye", "finite matrix"]),
        (&["--min-depth", "24"], &["--min-depth", "0..=23"]),
        (&["--max-depth", "-1"], &["--max-depth", "0..=23"]),
        (&["--min-depth", "4", "--max-depth", "3"], &["--min-depth 4 is more than --max-depth 3"]),
        (&["--bspline"], &["--bspline is for an .obj, and net.bpt is none"]),
        (&["--out", "a.bpt"], &["--out a.bpt", "triangles are written as .obj, .ply, .glb, .stl or .png"]),
    ];
    for (more, said) in cases {
        folder.run_in_vain(&tessellate("net.bpt", more)).fails(2, said);
    }
    let both: &[&str] = &["run", "quarters.burgeon", "--grid", "4", "--tolerance", "1"];
    folder.run_in_vain(both).fails(2, &["--grid", "--tolerance", "cannot be used with"]);
    for depth in ["--min-depth", "--max-depth"] {
        let said = format!("{depth} is for the mesh that --tolerance makes");
        folder.run_in_vain(&["run", "quarters.burgeon", depth, "2"]).fails(2, &[&said]);
    }
    folder
        .run_in_vain(&["run", "quarters.burgeon", "--tolerance", "1px"])
        .fails(2, &["--tolerance 1px", "--eye X,Y,Z"]);
}

/// What is near takes more triangles than what is far, and what is not seen takes two.
#[test]
fn a_tolerance_in_pixels() {
    let folder = Folder::new();
    folder.write("bump.bpt", bump());
    let triangles = |eye: &str, more: &[&str]| {
        let flags = [&["--tolerance", "0.5px", "--eye", eye, "--stats"], more].concat();
        let ran = folder.run_in_vain(&tessellate("bump.bpt", &flags));
        let stats: serde_json::Value = serde_json::from_str(&ran.succeeds().stdout).expect("JSON");
        assert_eq!((&stats["pixels"], &stats["tolerance"]), (&true.into(), &0.5.into()));
        stats["triangles"].as_u64().expect("a count")
    };
    let [near, far] = [triangles("1.5,1.5,5", &[]), triangles("1.5,1.5,100", &[])];
    assert!(near > 2 * far, "{near} and {far}");
    assert!(triangles("1.5,1.5,5", &["--pixels", "320x180"]) < near);
    assert_eq!(triangles("1.5,1.5,5", &["--look-at", "1.5,1.5,100"]), 2);
    // From above by y or z: there is an up for who looks along it.
    triangles("1.5,9,1", &["--up", "z"]);
    triangles("1.5,9,0", &["--up", "y", "--look-at", "1.5,0,0"]);
}

/// Sides are named as the file has them.
#[test]
fn how_patches_meet_is_said() {
    let folder = Folder::new();
    folder.write(
        "halves.bpt",
        bilinear(&[square(0.0, 0.0, 2.0), square(2.0, 0.0, 1.0), square(2.0, 1.0, 1.0)]),
    );
    let ran = folder.run_in_vain(&tessellate("halves.bpt", &["--tolerance", "1"]));
    ran.succeeds().says(&[
        "side u = 0 of patch 1 meets half of side u = 1 of patch 0",
        "side u = 0 of patch 2 meets half of side u = 1 of patch 0",
        "there may be cracks; halve patch 0 at v = 0.5",
    ]);
    let page = |x: f32, z: f32| [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [x, 0.0, z], [x, 1.0, z]];
    folder.write("book.bpt", bilinear(&[page(1.0, 0.0), page(0.0, 1.0), page(-1.0, 0.5)]));
    let ran = folder.run_in_vain(&tessellate("book.bpt", &["--tolerance", "1"]));
    assert_eq!(ran.succeeds().stdout, "book: 3 patches, 8 vertices, 6 triangles\n");
    ran.says(&["note: on 1 side more than two patches meet"]);
}

#[test]
fn a_mesh_beyond_the_budget() {
    let folder = Folder::new();
    folder.write("bump.bpt", bump());
    let flags = ["--tolerance", "1e-9", "--max-memory", "100k", "--out", "a.obj"];
    let said = ["a.obj: a mesh of ", "the memory budget is 100.00 KiB", "a larger --tolerance"];
    folder.run_in_vain(&tessellate("bump.bpt", &flags)).fails(3, &said);
    folder.run_in_vain(&tessellate("bump.bpt", &flags[..4])).fails(3, &["error: a mesh of "]);
    // The word is written all the same.
    let run = ["run", "quarters.burgeon", "--backend", "cpu", "--out", "a.json", "--in", "bump.bpt"];
    folder.run(&[&run[..], &flags].concat()).fails(3, &said);
    assert!(folder.holds("a.json") && !folder.holds("a.obj"));
}

/// The word is the one without its holes, whatever the mesh is made from.
#[test]
fn a_word_becomes_a_watertight_mesh() {
    let folder = Folder::new();
    let lace = rules("  P(n) -> [ P(n+1) eps ; P(n+1) P(n+1) ]\nrun:\n  derive 3\n");
    folder.write("lace.burgeon", lace);
    folder.write("net.bpt", bump());
    let run = ["run", "lace.burgeon", "--backend", "cpu"];
    folder.run(&[&run[..], &["--out", "a.json", "--out", "a.bpt"]].concat()).succeeds();
    let outs = ["--tolerance", "10", "--out", "b.json", "--out", "b.bpt", "--out", "b.obj"];
    let ran = folder.run(&[&run[..], &outs].concat());
    assert!(ran.succeeds().stdout.starts_with("quarters: 3 steps, 27 modules, "), "{ran:?}");
    assert!(ran.stdout.ends_with(" triangles\n"), "{ran:?}");
    assert!(folder.read("a.json") == folder.read("b.json") && folder.read("a.bpt") == folder.read("b.bpt"));
    assert_eq!(json::parse(&folder.read("b.json")).expect("a word").symbols.len(), 1);
    // Two triangles a leaf, or more where a neighbour is finer, and no two vertices in one place.
    let obj = folder.text("b.obj");
    assert!(lines(&obj, "f").len() >= 2 * 27);
    let places: std::collections::BTreeSet<&str> = lines(&obj, "v").into_iter().collect();
    assert_eq!(places.len(), lines(&obj, "v").len());
    let stats = folder.run(&[&run[..], &["--tolerance", "10", "--stats"]].concat());
    let stats: serde_json::Value = serde_json::from_str(&stats.succeeds().stdout).expect("JSON");
    assert_eq!(stats["triangles"], lines(&obj, "f").len());
    assert_eq!(stats["vertices"], places.len());
    // Nothing is left, and there was nothing.
    folder.write("erase.burgeon", rules("  P(n) -> eps\n"));
    folder.write("none.bpt", "0\n");
    for args in [&["run", "erase.burgeon"][..], &["run", "quarters.burgeon", "--in", "none.bpt"]] {
        let more = ["--backend", "cpu", "--tolerance", "1", "--out", "e.obj"];
        let ran = folder.run(&[args, &more].concat());
        assert!(ran.succeeds().stdout.ends_with("0 modules, 0 vertices, 0 triangles\n"), "{ran:?}");
    }
}

#[cfg(feature = "gpu")]
mod on_a_device {
    use super::*;

    /// The same triangles, and positions that differ by rounding alone.
    #[test]
    fn cpu_and_gpu_write_the_same_mesh() {
        let Some(adapter) = gpu() else { return };
        let adapter: Vec<&str> = adapter.iter().map(String::as_str).collect();
        let folder = Folder::new();
        let (teapot, holes) = (example("data/teapot.bpt"), example("holes.burgeon"));
        let cases: [&[&str]; 3] = [
            &["tessellate", &teapot, "--tolerance", "0.005"],
            &["tessellate", &teapot, "--tolerance", "1px", "--eye", "0,4,9"],
            &["run", &holes, "--tolerance", "0.01"],
        ];
        for case in cases {
            let write = |backend: &str, out: &str| {
                let args = [case, &["--backend", backend, "--out", out], &adapter[..]].concat();
                folder.run(&args).succeeds().stdout.clone()
            };
            assert_eq!(write("cpu", "cpu.obj"), write("gpu", "gpu.obj"));
            let [cpu, gpu] = ["cpu.obj", "gpu.obj"].map(|name| folder.text(name));
            assert!(lines(&cpu, "f") == lines(&gpu, "f"), "{case:?}");
            let numbers = |text: &str| -> Vec<f64> {
                let numbers = lines(text, "v").into_iter().flat_map(|line| line.split(' ').skip(1));
                numbers.map(|x| x.parse().expect("a number")).collect()
            };
            let (a, b) = (numbers(&cpu), numbers(&gpu));
            assert!(a.len() > 300 && a.len() == b.len());
            for (a, b) in a.into_iter().zip(b) {
                assert!((a - b).abs() <= 1e-6 * b.abs().max(1.0), "{case:?}: {a} and {b}");
            }
        }
    }

    #[test]
    fn a_device_binds_so_much_and_no_more() {
        let Some(adapter) = gpu() else { return };
        let adapter: Vec<&str> = adapter.iter().map(String::as_str).collect();
        let folder = Folder::new();
        let deep = ["tessellate", "net.bpt", "--min-depth", "23", "--backend", "gpu", "--out", "a.obj"];
        let ran = folder.run_in_vain(&[&deep[..], &adapter].concat());
        ran.fails(3, &["a.obj: the buffer of ", "the device binds ", "help: take a lower --min-depth\n"]);
    }

    #[test]
    fn pictures_with_lines_and_colours() {
        let Some(adapter) = gpu() else { return };
        let adapter: Vec<&str> = adapter.iter().map(String::as_str).collect();
        let folder = Folder::new();
        folder.write("net.bpt", bump());
        let symbols = "  P(n) : n < 1 -> [ P(n+1) P(n+1) ; Q Q ]\n";
        folder.write("two.burgeon", rules(symbols).replace("module P(n: int)", "module P(n: int)\nmodule Q"));
        let picture = |args: &[&str]| {
            let args = [args, &["--backend", "cpu", "--out", "a.png"], &adapter[..]].concat();
            folder.run(&args).succeeds();
            let picture = folder.read("a.png");
            assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"));
            picture
        };
        let plain = picture(&["tessellate", "net.bpt", "--tolerance", "0.1"]);
        assert!(plain != picture(&["tessellate", "net.bpt", "--tolerance", "0.1", "--wireframe"]));
        for fineness in ["--grid=4", "--tolerance=0.1"] {
            let one = picture(&["run", "two.burgeon", fineness]);
            assert!(one != picture(&["run", "two.burgeon", fineness, "--by-symbol"]), "{fineness}");
            assert!(one != picture(&["run", "two.burgeon", fineness, "--wireframe"]), "{fineness}");
        }
    }
}

/// A placement acts where there is a tessellation, and is never passed over in silence.
#[test]
fn a_placement_displaces_what_a_tolerance_makes() {
    let folder = Folder::new();
    let text = rules("  P(n) -> [ P(n+1) P(n+1) ; P(n+1) eps ]\n") // with its own run:
        .replace(
            "rules:",
            "param high: float = 2 in 0 .. 9\nplace up = p + (0, 0, high) * sin(pi * uv.x)\nrules:",
        );
    folder.write("up.burgeon", format!("{text}run:\n  derive 1\n  place up\n"));
    let run = |more: &[&str]| folder.run(&[&["run", "up.burgeon", "--backend", "cpu"][..], more].concat());
    let note = "note: `place up` displaces the mesh that --tolerance makes; without it nothing is displaced";
    let plain = run(&["--out", "plain.obj"]);
    plain.succeeds();
    plain.says(&[note]);
    let heights = |file: &str| -> Vec<f32> {
        let text = folder.text(file);
        let height = |line: &&str| line.split(' ').nth(3).and_then(|z| z.parse().ok()).expect("a height");
        lines(&text, "v").iter().map(height).collect()
    };
    assert!(heights("plain.obj").iter().all(|&z| z == 0.0));
    // Each of the three leaves once more halved: the middle of the sheet is the top.
    let ran = run(&["--tolerance", "1", "--min-depth", "2", "--out", "up.obj"]);
    ran.succeeds();
    assert!(!ran.stderr.contains("place up"), "{ran:?}");
    let found = heights("up.obj");
    let highest = found.iter().copied().fold(0.0, f32::max);
    assert!((highest - 2.0).abs() < 1e-6 && found.contains(&0.0), "{found:?}");
    run(&["--tolerance", "1", "--min-depth", "2", "--set", "high=0.5", "--out", "low.obj"]).succeeds();
    let highest = heights("low.obj").iter().copied().fold(0.0, f32::max);
    assert!((highest - 0.5).abs() < 1e-6, "{highest}");
    run(&["--tolerance", "1", "--set", "high=10"]).fails(2, &["param high = 10 lies outside 0 .. 9"]);
    // The word says nothing of it, and the kernel all.
    run(&["--out", "word.json"]).succeeds();
    let wgsl = folder.run(&["wgsl", "up.burgeon"]);
    assert!(wgsl.succeeds().stdout.contains("vertices of quarters, place up"), "{wgsl:?}");
    folder.run(&["check", "up.burgeon"]).succeeds();
    // Anywhere else it is refused, once.
    folder.write("up.burgeon", format!("{text}run:\n  place up\n  derive 1\n"));
    let ran = run(&["--tolerance", "1"]);
    ran.fails(1, &["error[E0266]: in a patch system `place` stands last, and `up` does not"]);
    assert_eq!(ran.stderr.matches("error").count(), 1, "{ran:?}");
}
