//! What is wrong with a rule file comes before what is wrong with flags; then flags belong to kinds of systems.

use super::*;

const CURVE: &str =
    "system id : curve open\nmodule P(v: vec2)\naxiom: P((0,0)) P((1,0))\nrules:\n  P(v) -> P(2*v)\n";

const OF_CURVES: [&[&str]; 5] =
    [&["--sweep", "w=0..1/2"], &["--seeds", "3"], &["--each"], &["--points"], &["--control"]];

const OF_PATCHES: [&[&str]; 8] = [
    &["--grid", "4"],
    &["--tolerance", "0.1"],
    &["--min-depth", "1"],
    &["--max-depth", "1"],
    &["--wireframe"],
    &["--by-symbol"],
    &["--bspline"],
    &["--eye", "1,2,3"],
];

/// Other flags that are wrong for one kind or for both.
const OTHERS: [&[&str]; 6] = [
    &["--out", "x.svg"],
    &["--out", "x.csv"],
    &["--out", "x.glb"],
    &["--out", "x.nothing"],
    &["--out", "-"],
    &["--set", "no=1"],
];

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("c.burgeon", CURVE);
    folder
}

#[test]
fn a_mistake_in_the_file_comes_first() {
    let folder = folder();
    folder.write("type.burgeon", CURVE.replace("2*v", "2*vv"));
    folder.write("parse.burgeon", CURVE.replace("P(2*v)", "P(2*v"));
    folder.write("net.burgeon", QUARTERS.replace("P(n+1)", "P(m+1)"));
    folder.write("mesh.burgeon", "system m : mesh\naxiom: box(1, 1, 1)\nrun:\n  subdivide catmull_clark 1\n");
    folder.write("none.burgeon", "// nothing\n");
    folder.write("bytes.burgeon", b"system s : curve \xff\n");
    let until = "axiom: P((0,0))\nrules:\n  P(v) ->(0.5) P(v) P(v) ->(0.5) P(v)\nrun:\n  derive until terminal max 5\n";
    folder.write("later.burgeon", CURVE.split_once("axiom").expect("an axiom").0.to_string() + until);
    let files: [(&str, &str); 7] = [
        ("type.burgeon", "error[E0202]: there is no `vv` here"),
        ("parse.burgeon", "parse.burgeon:5:"),
        ("net.burgeon", "net.burgeon:5:"),
        ("mesh.burgeon", "this version does not derive mesh systems"),
        ("none.burgeon", "none.burgeon is no rule file: it holds comments only"),
        ("bytes.burgeon", "bytes.burgeon:1:"),
        ("gone.burgeon", "cannot read gone.burgeon: there is no such file"),
    ];
    let flags = OF_CURVES.iter().chain(&OF_PATCHES).chain(&OTHERS);
    for flags in flags.chain(&[&[][..]]) {
        for (file, says) in files {
            let ran = folder.run_in_vain(&[&["run", file], *flags].concat());
            ran.fails(1, &[says]);
        }
    }
    // Errors come before the name of a system, which comes before all other flags.
    for (file, status, says) in [
        ("type.burgeon", 1, "error[E0202]"),
        ("c.burgeon", 2, "c.burgeon has no system `ids`; it has id\nhelp: did you mean `id`?"),
        ("quarters.burgeon", 2, "quarters.burgeon has no system `ids`; it has quarters"),
        ("mesh.burgeon", 2, "mesh.burgeon has no system `ids`; it has m"),
    ] {
        for flags in OF_CURVES.iter().chain(&OF_PATCHES).chain(&OTHERS) {
            let ran = folder.run_in_vain(&[&["run", file, "--system", "ids"], *flags].concat());
            ran.fails(status, &[says]);
        }
    }
    // What a later version derives, too.
    folder
        .run_in_vain(&["run", "later.burgeon", "--seeds", "2", "--grid", "4"])
        .fails(1, &["E0401", "`until terminal` beside random numbers"]);
}

#[test]
fn flags_belong_to_kinds() {
    let folder = folder();
    for (file, flags, says) in [
        ("c.burgeon", &OF_PATCHES[..], "is for patches, and id is a system of curves"),
        ("quarters.burgeon", &OF_CURVES, "is for curves, and quarters is a system of patches"),
    ] {
        for flags in flags {
            let ran = folder.run_in_vain(&[&["run", file, "--backend", "cpu"], *flags].concat());
            ran.fails(2, &[&format!("error: {} {says}", flags[0])]);
        }
    }
    let all = ["run", "c.burgeon", "--wireframe", "--points", "--bspline", "--grid", "2"];
    folder.run_in_vain(&all).fails(2, &["error: --bspline, --grid and --wireframe are for patches"]);
    folder
        .run_in_vain(&["compare", "c.burgeon", "--bspline"])
        .fails(2, &["--bspline is for patches, and id is a system of curves"]);
    for (file, out, says) in [
        ("c.burgeon", "a.glb", "curves are written as .svg, .png, .obj, .csv or .json"),
        (
            "quarters.burgeon",
            "a.svg",
            "patches are written as .bpt, .bv, .json, .obj, .ply, .glb, .stl or .png",
        ),
    ] {
        folder.run_in_vain(&["run", file, "--out", out]).fails(2, &[says]);
    }
}
