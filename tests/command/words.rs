//! Several curves in one run of the command.

use super::*;
use serde_json::Value;

const CURVE: &str = "param w: float = 1/4 in 0 .. 1/2\nparam levels: int = 2\nsystem c : curve ring\nmodule P(v: vec2)\n\
                     axiom: file \"points.csv\"\nrules:\n  \
                     P(a) < P(v) > P(b) -> P(w*a + (1 - w)*v) P((1 - w)*v + w*b)\nrun:\n  derive levels\n";

const GROWS: &str = "system g : curve tree\nparam seed: int = 3\nmodule P(v: vec2)\naxiom: F\nrules:\n  \
                     F ->(0.5) F [ +(rand(20, 60)) F ] F ->(0.5) F\nrun:\n  derive 4\n  trace into P\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("c.burgeon", CURVE);
    folder.write("g.burgeon", GROWS);
    folder.write("points.csv", "x,y\n0,0\n4,0\n4,3\n");
    folder
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).expect("UTF-8")
}

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).expect("json")
}

#[test]
fn a_sweep_is_a_curve_for_each_value() {
    let folder = folder();
    let run = ["run", "c.burgeon", "--backend", "cpu"];
    let sweep = ["--sweep", "w=0..0.5/3", "--out", "all.json", "--out", "one_{}.json", "--out", "all.svg"];
    let ran = folder.run(&[&run[..], &sweep].concat());
    assert_eq!(ran.succeeds().stdout, "c: 2 steps, 3 curves, 36 modules\n");
    let all = json(&folder, "all.json");
    for (n, w) in ["0", "0.25", "0.5"].into_iter().enumerate() {
        let set = format!("w={w}");
        folder.run(&[&run[..], &["--set", &set, "--out", "alone.json"]].concat()).succeeds();
        let alone = json(&folder, "alone.json");
        assert_eq!(all["words"][n]["word"], alone, "{w}");
        assert_eq!(json(&folder, &format!("one_{n}.json")), alone, "{w}");
        assert_eq!(all["words"][n]["set"]["w"].as_f64(), w.parse().ok());
    }
    assert_eq!(text(&folder, "all.svg").matches("<path").count(), 3);
    // Ints, downwards, beside another sweep, in runs of their own schedules.
    let sweeps = ["--sweep", "levels=3..1", "--sweep", "w=0.1..0.2/2", "--out", "all.json", "--stats"];
    let ran = folder.run(&[&run[..], &sweeps].concat());
    let stats: Value = serde_json::from_str(&ran.succeeds().stdout).expect("json");
    assert_eq!(stats["words"], 6);
    let modules: Vec<u64> =
        stats["steps"].as_array().expect("steps").iter().filter_map(|s| s["modules"].as_u64()).collect();
    assert_eq!(modules, [36, 60, 84]);
    let all = json(&folder, "all.json");
    let of = |n: usize| {
        let word = &all["words"][n];
        let count = word["word"]["modules"].as_array().map(Vec::len);
        (word["set"]["levels"].as_i64(), word["set"]["w"].as_f64(), count)
    };
    let expected = [(3, 0.1, 24), (3, 0.2, 24), (2, 0.1, 12), (2, 0.2, 12), (1, 0.1, 6), (1, 0.2, 6)];
    let expected = expected.map(|(levels, w, count)| (Some(levels), Some(w), Some(count)));
    assert_eq!(std::array::from_fn(of), expected);
}

#[test]
fn seeds_are_curves_of_their_own() {
    let folder = folder();
    let run = ["run", "g.burgeon", "--backend", "cpu"];
    let outs = ["--out", "all.json", "--out", "all.png", "--out", "all.csv", "--out", "all.obj"];
    folder.run(&[&run[..], &["--seeds", "11"], &outs].concat()).succeeds();
    let all = json(&folder, "all.json");
    for n in [0, 1, 10] {
        folder.run(&[&run[..], &["--seed", &(3 + n).to_string(), "--out", "alone.json"]].concat()).succeeds();
        assert_eq!(all["words"][n]["word"], json(&folder, "alone.json"), "{n}");
        assert_eq!(all["words"][n]["seed"], 3 + n);
    }
    folder.run(&[&run[..], &["--seeds", "11", "--seed", "7", "--out", "tree_{}.svg"]].concat()).succeeds();
    // Below 0 they are two's complement, and after the last comes the first.
    let around = ["--seeds", "2", "--seed", "-1", "--out", "around.json"];
    folder.run(&[&run[..], &around].concat()).succeeds();
    let around = json(&folder, "around.json");
    let seeds = [0, 1].map(|n| around["words"][n]["seed"].as_u64());
    assert_eq!(seeds, [Some(u32::MAX.into()), Some(0)]);
    for seed in ["-1", "4294967295", "0xFFFFFFFF"] {
        for given in [&["--seed", seed][..], &[&format!("--seed={seed}")]] {
            folder.run(&[&run[..], given, &["--out", "alone.json"]].concat()).succeeds();
            assert_eq!(around["words"][0]["word"], json(&folder, "alone.json"), "{given:?}");
        }
    }
    folder.run(&[&run[..], &["--set", "seed=-1", "--out", "alone.json"]].concat()).succeeds();
    assert_eq!(around["words"][0]["word"], json(&folder, "alone.json"));
    for (seed, says) in
        [("-2147483649", "-2147483648 to 4294967295"), ("1.5", "a whole number"), ("-x", "0x")]
    {
        folder.run_in_vain(&[&run[..], &["--seed", seed]].concat()).fails(2, &["--seed", says]);
    }
    assert!(folder.holds("tree_00.svg") && folder.holds("tree_10.svg") && !folder.holds("tree_11.svg"));
}

#[test]
fn each_curve_of_a_file_is_one() {
    let folder = folder();
    folder.write("two.csv", "0,0\n4,0\n4,3\n\n9,9\n8,8\n7,9\n6,2\n");
    let run = ["run", "c.burgeon", "--backend", "cpu", "--in", "two.csv"];
    let ran = folder.run(&[&run[..], &["--each", "--out", "each.csv"]].concat());
    assert_eq!(ran.succeeds().stdout, "c: 2 steps, 2 curves, 28 modules\n");
    folder.write("second.csv", "9,9\n8,8\n7,9\n6,2\n");
    folder.run(&["run", "c.burgeon", "--backend", "cpu", "--in", "second.csv", "--out", "2.csv"]).succeeds();
    let second = text(&folder, "2.csv");
    assert!(text(&folder, "each.csv").ends_with(second.split_once('\n').expect("a row of names").1));
    assert_eq!(folder.run(&run).succeeds().stdout, "c: 2 steps, 28 modules\n");
    // In a picture they stay where they are to each other; sweeps stand side by side.
    folder.run(&[&run[..], &["--each", "--steps", "0", "--out", "each.svg"]].concat()).succeeds();
    let svg = text(&folder, "each.svg");
    assert!(svg.contains("M 0.0 0.0 4.0 0.0 4.0 -3.0 Z") && svg.contains("M 9.0 -9.0 8.0 -8.0"), "{svg}");
    folder.run(&[&run[..], &["--each", "--sweep", "w=0..0.5/3", "--out", "each.svg"]].concat()).succeeds();
    let width = |svg: &str| svg.split("viewBox=\"").nth(1)?.split(' ').nth(2)?.parse::<f64>().ok();
    let (one, three) = (width(&svg), width(&text(&folder, "each.svg")));
    assert!(three > one.map(|one| 2.0 * one), "{one:?} {three:?}");
}

#[test]
fn what_is_wrong_with_several_curves_is_said() {
    let folder = folder();
    folder.write(
        "p.burgeon",
        "system p : patch bezier 3\nmodule P\naxiom: P = file \"p.bpt\"\nrules:\n  P -> [ P | P ]\nrun:\n  derive 1\n",
    );
    folder.write("one.burgeon", CURVE.replace("points.csv\"", "points.csv\"[0]"));
    folder.write(
        "until.burgeon",
        "system u : curve open\nmodule A, B\naxiom: A\nrules:\n  A ->(0.5) A A ->(0.5) B\nrun:\n  derive until terminal max 5\n",
    );
    let cases: [(&[&str], i32, &str); 16] = [
        (&["c.burgeon", "--sweep", "w"], 2, "write NAME=FROM..TO/N, as in w=0..0.125/6"),
        (&["c.burgeon", "--sweep", "w=1/4"], 2, "write NAME=FROM..TO/N"),
        (&["c.burgeon", "--sweep", "w=0..1/1"], 2, "`1` is no number of values"),
        (
            &["c.burgeon", "--sweep", "w=0..1"],
            2,
            "--sweep w: w is of type float; say how many values: FROM..TO/N",
        ),
        (&["c.burgeon", "--sweep", "w=0..true/3"], 2, "w is of type float; both ends must be of it"),
        (&["c.burgeon", "--sweep", "w=0..1/3"], 2, "param w = 1 lies outside 0 .. 0.5"),
        (&["c.burgeon", "--sweep", "levels=0..3/3"], 2, "3 ints do not stand evenly from 0 to 3"),
        (
            &["c.burgeon", "--sweep", "v=0..1/3"],
            2,
            "--sweep v: no such param of c; it has\n  param w: float = 0.25 in 0 .. 0.5\n  param levels: int = 2\n",
        ),
        (&["c.burgeon", "--sweep", "w=0..0.5/2", "--set", "w=0"], 2, "--sweep w: the param is given twice"),
        (&["c.burgeon", "--sweep", "w=0..0.5/9000000"], 2, "w takes more than 1048576 values"),
        (&["c.burgeon", "--sweep", "w=0..0.5/90000", "--seeds", "90"], 2, "these are 8,100,000 curves"),
        (&["c.burgeon", "--seeds", "0"], 2, "--seeds"),
        (
            &["c.burgeon", "--seeds", "900000", "--max-memory", "50M"],
            3,
            "the axiom alone needs at least 82.40 MiB for 2,700,000 modules",
        ),
        (&["p.burgeon", "--seeds", "2"], 2, "--seeds is for curves"),
        (&["one.burgeon", "--each"], 2, "--each: the axiom of c takes curve 0 of points.csv alone"),
        (&["until.burgeon", "--seeds", "2"], 1, "`until terminal` beside random numbers or `step`"),
    ];
    for (flags, status, says) in cases {
        let ran = folder.run_in_vain(&[&["run"], flags, &["--backend", "cpu", "--out", "a.json"]].concat());
        ran.fails(status, &[says]);
    }
}
