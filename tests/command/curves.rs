//! Curves by the command: what is read, what is drawn, and how bad files of points are told of.

use super::*;

const CURVE: &str = "system c : curve ring\nmodule P(v: vec2)\naxiom: file \"points.csv\"\nrules:\n  \
                     P(vl) < P(v) > P(vr) -> P(1/4*vl + 3/4*v) P(3/4*v + 1/4*vr)\nrun:\n  derive 2\n";

fn with_points() -> Folder {
    let folder = Folder::new();
    folder.write("c.burgeon", CURVE);
    folder.write("points.csv", "x,y\n0,0\n4,0\n4,3\n");
    folder
}

#[test]
fn every_format_of_curves_is_written() {
    let folder = with_points();
    let run = ["run", "c.burgeon", "--backend", "cpu", "--points", "--control"];
    let outs = ["--out", "a.svg", "--out", "a.png", "--out", "a.csv", "--out", "a.obj", "--out", "a.json"];
    let ran = folder.run(&[&run[..], &outs].concat());
    assert_eq!(ran.succeeds().stdout, "c: 2 steps, 12 modules\n");
    assert!(outs.iter().filter(|out| out.starts_with('a')).all(|out| folder.holds(out)));
    // The control polygon is the first curve of the picture, the word the second.
    folder.write(
        "again.burgeon",
        CURVE.replace("file \"points.csv\"", "file \"a.svg\"[1]").replace("derive 2", "derive 0"),
    );
    for (out, from) in [("b.csv", "again.burgeon"), ("c.csv", "c.burgeon")] {
        let more = if from == "c.burgeon" {
            ["--in", "a.csv", "--steps", "0"]
        } else {
            ["--steps", "0", "--out", "b.obj"]
        };
        folder.run(&[&["run", from, "--backend", "cpu", "--out", out][..], &more].concat()).succeeds();
    }
    assert_eq!(folder.read("b.csv"), folder.read("c.csv"));
    assert_eq!(folder.read("b.csv"), folder.read("a.csv"));
}

#[test]
fn bad_files_of_points_are_shown_with_their_place() {
    let folder = with_points();
    let cases = [
        ("none.csv", "", "none.csv:1:1: the file ends where point 0 should stand"),
        ("short.csv", "0,0\n1\n", "short.csv:2:1: columns of this row: 1, of the first: 2"),
        ("nan.csv", "0,0\n1,nan\n", "nan.csv:2:3: y of point 1 is `nan`; coordinates must be finite"),
        ("none.obj", "# nothing\n", "none.obj:1:10: the file ends where vertex 1 should stand"),
        ("none.svg", "", "none.svg:1:1: the file is empty"),
        ("text.svg", "<svg><text>a</text></svg>", "are read (skipped 1 × text)"),
        ("comma.csv", "0,5,1,5\n", "comma.csv:1:1: 4 columns where a point is x,y, with commas"),
        (
            "id.csv",
            "id,x,y\n1,0,0\n",
            "id.csv:1:1: the columns are id,x,y; they should be x,y, in this order",
        ),
        ("points.txt", "0 0\n", "the points of curves are read from .obj, .csv and .svg"),
    ];
    for (file, text, says) in cases {
        folder.write(file, text);
        let ran =
            folder.run_in_vain(&["run", "c.burgeon", "--backend", "cpu", "--in", file, "--out", "a.svg"]);
        ran.fails(1, &[says]);
    }
    folder.write("long.csv", format!("0,0\n1,{}\n", "9".repeat(5_000_000)));
    let ran = folder.run_in_vain(&["run", "c.burgeon", "--backend", "cpu", "--in", "long.csv"]);
    ran.fails(1, &["long.csv:2:3:", "beyond the range"]);
    assert!(ran.stderr.lines().all(|line| line.chars().count() <= 200), "{ran:?}");
}

#[test]
fn flags_of_patches_are_refused() {
    let folder = with_points();
    for flag in ["--wireframe", "--by-symbol"] {
        let ran = folder.run_in_vain(&["run", "c.burgeon", "--backend", "cpu", flag, "--out", "a.png"]);
        ran.fails(2, &["--wireframe and --by-symbol are for patches"]);
    }
    folder.run_in_vain(&["run", "points.csv"]).fails(2, &["points.csv holds points, not rules"]);
}

/// What is read is said where it is not all that the file holds, or not as it holds it.
#[test]
fn notes_say_what_became_of_a_file() {
    let folder = with_points();
    let run = |file: &str, more: &[&str]| {
        folder.run(
            &[&["run", "c.burgeon", "--backend", "cpu", "--steps", "0", "--in", file][..], more].concat(),
        )
    };
    folder.write("all.svg", "<svg><text>a</text><circle/><path d='M0 0h4v3'/><path d='M0 0h1v1z'/></svg>");
    let ran = run("all.svg", &[]);
    assert_eq!(ran.succeeds().stdout, "c: 0 steps, 6 modules\n");
    assert_eq!(
        ran.stderr,
        "note: all.svg: skipped 1 × text, 1 × circle without a size\n\
         note: all.svg: 2 curves are joined to one, each from the end of the one before \
         (`run --each` derives each by itself)\n"
    );
    let ran = run("all.svg", &["--each"]);
    assert_eq!(ran.succeeds().stdout, "c: 0 steps, 2 curves, 6 modules\n");
    assert_eq!(
        ran.stderr,
        "note: all.svg: skipped 1 × text, 1 × circle without a size\n\
         note: all.svg: 1 of 2 curves is open; a ring joins the last point of each to its first\n"
    );
    folder.write("line.obj", "v 0 0 1\nv 1 0 2\nv 1 1 0\nl 1 2\nl 2 3\n");
    let ran = run("line.obj", &[]);
    assert_eq!(
        ran.succeeds().stderr,
        "note: line.obj: the curve is open; a ring joins its last point to its first\n\
         note: line.obj: z of 2 points is left out: P holds a vec2\n"
    );
    // A table does not say whether it closes.
    assert_eq!(run("points.csv", &[]).succeeds().stderr, "");
}

/// The last side of what is closed is in an open word, too.
#[test]
fn closed_shapes_in_open_words() {
    let folder = with_points();
    folder.write("open.burgeon", CURVE.replace("curve ring", "curve open"));
    folder.write("two.svg", "<svg><path d='M0 0L1 0L1 1Z'/><path d='M5 5L6 5L6 6'/></svg>");
    let args = [
        "run",
        "open.burgeon",
        "--backend",
        "cpu",
        "--steps",
        "0",
        "--in",
        "two.svg",
        "--each",
        "--out",
        "a.csv",
    ];
    let ran = folder.run(&args);
    assert_eq!(
        (ran.succeeds().stderr.as_str(), folder.text("a.csv").as_str()),
        ("", "v.x,v.y\n0.0,0.0\n1.0,0.0\n1.0,-1.0\n0.0,0.0\n\n5.0,-5.0\n6.0,-5.0\n6.0,-6.0\n")
    );
}
