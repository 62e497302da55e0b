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

/// What a quotient by 0, and what is not a number, come to is stated, and both backends keep to it.
#[cfg(feature = "gpu")]
#[test]
fn infinities_and_nan_are_alike_on_both_backends() {
    let folder = Folder::new();
    let head = "system s : curve open\nmodule A(x: float), Q(k: int)\naxiom: A(-1) A(4) A(0)\nrules:\n  A(x)";
    let rules = [
        ("-> Q(int(sqrt(x)))", "0 2 0"),
        (": x/0.0 > 1 -> Q(1)", "A 1 A"),
        (": x/0 < 0 -> Q(int(x/0))", "-2147483648 A A"),
        ("-> Q(int(min(0/x, 3)))", "0 0 0"),
        ("-> Q(int(max(3, sqrt(x))))", "3 3 3"),
        ("-> Q(if(sqrt(x) == sqrt(x), 1, 2))", "2 1 1"),
        ("-> Q(if(!(sqrt(x) > 0), 1, 2))", "1 2 1"),
        ("-> Q(int(clamp(1/x, -5, 5)))", "-1 0 5"),
        ("-> Q(int(sign(x - x/0*0)))", "0 0 0"),
        ("-> Q(int(x*1e38*1e38))", "-2147483648 2147483520 0"),
        // The sign of a zero.
        ("-> Q(if(1/(0 - x*0) < 0, 1, 2))", "2 2 2"),
        ("-> Q(if(1/(0 - (x - x)) < 0, 1, 2))", "2 2 2"),
        ("-> Q(if(1/(0*(0 - x)) < 0, 1, 2))", "2 1 2"),
        ("-> Q(if(1/(0 + -(x*0)) < 0, 1, 2))", "2 2 2"),
        ("-> Q(if(rand(x/0, x/0) == x/0, 1, 2))", "2 2 2"),
    ];
    for (rule, expected) in rules {
        folder.write("s.burgeon", format!("{head} {rule}\n"));
        for backend in ["cpu", "gpu"] {
            folder.run(&["run", "s.burgeon", "--backend", backend, "--out", "s.json"]).succeeds();
            let word: serde_json::Value = serde_json::from_slice(&folder.read("s.json")).expect("json");
            let value = |m: &serde_json::Value| match m["symbol"].as_str() {
                Some("Q") => m["params"][0].to_string(),
                _ => "A".to_string(),
            };
            let found: Vec<String> = word["modules"].as_array().expect("modules").iter().map(value).collect();
            assert_eq!(found.join(" "), expected, "{rule} by {backend}");
        }
        folder.run(&["compare", "s.burgeon"]).succeeds();
    }
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
fn points_are_no_rules() {
    let folder = with_points();
    folder.run_in_vain(&["run", "points.csv"]).fails(2, &["points.csv holds points, not rules"]);
}

/// A word of symbols shows nothing: that is told, and no file is written.
#[test]
fn a_turtle_that_was_never_traced_is_not_drawn() {
    let folder = Folder::new();
    let turtle = |modules: &str, run: &str| {
        format!("system t : curve\nmodule {modules}\naxiom: F - X\nrules:\n  X -> F + X\nrun:\n  {run}\n")
    };
    let draw = |out: &str, more: &[&str]| {
        let before = folder.files();
        let ran = folder.run(&[&["run", "t.burgeon", "--backend", "cpu", "--out", out], more].concat());
        assert!(ran.status == Some(0) || before == folder.files(), "{ran:?}");
        ran
    };
    folder.write("t.burgeon", turtle("X", "derive 3"));
    let expected = "error[E0408]: the word has no point that a.svg could show: it was never traced
 --> t.burgeon:7:3
  |
7 |   derive 3
  |   ^^^^^^^^
  |
  = help: write `trace into P` as the last step of `run:`, and declare the point: `module P(v: vec2)`
";
    assert_eq!(draw("a.svg", &[]).fails(1, &[]).stderr, expected);
    for (out, more) in [("a.png", &[][..]), ("a.obj", &["--control"]), ("a_{}.svg", &["--seeds", "2"])] {
        draw(out, more).fails(1, &["E0408", "`trace into P`"]);
    }
    // These write symbols, too.
    for out in ["a.json", "a.csv"] {
        draw(out, &[]).succeeds();
    }
    folder.write("t.burgeon", turtle("X, Dot(v: vec3)", "derive 3"));
    draw("b.svg", &[]).fails(1, &["help: write `trace into Dot` as the last step of `run:`\n"]);
    folder.write("t.burgeon", turtle("X, Dot(v: vec3)", "derive 3\n  trace into Dot"));
    draw("b.svg", &["--steps", "2"]).fails(1, &["t.burgeon:8:3", "the run did not come to this step"]);
    draw("b.svg", &[]).succeeds();
    folder.write("t.burgeon", turtle("X", "derive 3"));
    draw("-", &["--format", "svg"]).fails(1, &["no point that the standard output could show"]);
}

/// Where all is erased an empty picture may be meant; that it never could show anything is said.
#[test]
fn an_empty_word_that_was_never_traced_is_told_of() {
    let folder = Folder::new();
    let note = "the word is empty, and was never traced";
    for (modules, run, told) in [
        ("A", "derive 1", true),
        ("A, P(v: vec2)", "derive 1", false),
        ("A, P(v: vec2)", "derive 1\n  trace into P", false),
    ] {
        let text =
            format!("system t : curve\nmodule {modules}\naxiom: A\nrules:\n  A -> eps\nrun:\n  {run}\n");
        folder.write("t.burgeon", text);
        let ran = folder.run(&["run", "t.burgeon", "--backend", "cpu", "--out", "a.svg"]);
        assert_eq!(ran.succeeds().stderr.contains(note), told, "{modules}, {run}: {ran:?}");
        let ran = folder.run(&["run", "t.burgeon", "--backend", "cpu", "--out", "a.json"]);
        assert!(!ran.succeeds().stderr.contains(note), "{ran:?}");
    }
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
