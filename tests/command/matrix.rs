//! `matrix` and `infer`.

use super::*;

const CHAIKIN: &str = include_str!("../data/language/chaikin.burgeon");

#[test]
fn a_matrix_and_what_follows_from_it() {
    let folder = Folder::new();
    folder.write("chaikin.burgeon", CHAIKIN);
    let ran = folder.run(&["matrix", "chaikin.burgeon", "--n", "4"]);
    ran.succeeds();
    let lines = [
        "chaikin: 8 × 4, on a ring of 4 points",
        "  1  3/4    .    .  1/4",
        "mask          (1, 3, 3, 1)/4",
        "generates     polynomials of degree 2",
        "reproduces    lines, new point i at i/2 - 1/4",
        "eigenvalues   1, 1/2, 1/4, 1/4",
    ];
    for line in lines {
        assert!(ran.stdout.lines().any(|l| l == line), "no `{line}` in {ran:?}");
    }
    let ran = folder.run(&["matrix", "chaikin.burgeon", "--with", "left", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&ran.succeeds().stdout).expect("JSON");
    assert_eq!(json["fractions"][0].as_array().map(Vec::len), Some(6));
    assert_eq!((&json["generates"], &json["reproduces"]), (&2.into(), &1.into()));
    assert_eq!(json["shift"], -0.75);
    assert_eq!(json["mask"], serde_json::json!([0.25, 0.75, 0.75, 0.25]));
}

#[test]
fn what_has_no_matrix() {
    let folder = Folder::new();
    let rule = "system s : curve ring\nmodule P(v: vec2)\nparam w: float = 1 in 0 .. 1\naxiom: [(0,0), (1,0)]\nrules:\n  \
                P(v) : w*v.x > 0 -> P(v) P(v)\n";
    folder.write("s.burgeon", rule);
    folder
        .run_in_vain(&["matrix", "s.burgeon"])
        .fails(1, &["error[E0406]: not an affine subdivision rule", "s.burgeon:6:12"]);
    folder.run_in_vain(&["matrix", "s.burgeon", "--with", "x"]).fails(1, &["no rules `x`"]);
    folder
        .run_in_vain(&["matrix", "s.burgeon", "--set", "w=2"])
        .fails(2, &["param w = 2 lies outside 0 .. 1"]);
    folder.run_in_vain(&["matrix", "s.burgeon", "--n", "0"]).fails(2, &["1..=1000"]);
    folder.run_in_vain(&["matrix", "quarters.burgeon"]).fails(1, &["quarters is no curve system"]);
}

#[test]
fn an_inferred_rule_checks_and_runs() {
    let folder = Folder::new();
    folder.write(
        "4point.csv",
        "1,0,0,0,0\n9/16,9/16,-1/16,0,-1/16\n0,1,0,0,0\n-0.0625,0.5625,0.5625,-0.0625,0\n\
                                0,0,1,0,0\n0,-1/16,9/16,9/16,-1/16\n0,0,0,1,0\n-1/16,0,-1/16,9/16,9/16\n\
                                0,0,0,0,1\n9/16,-1/16,0,-1/16,9/16\n",
    );
    let ran = folder.run(&["infer", "4point.csv"]);
    assert!(ran.succeeds().stdout.contains("system scheme : curve ring"), "{ran:?}");
    let ran = folder.run(&["infer", "4point.csv", "--name", "dlg", "--shift", "-1"]);
    assert!(ran.succeeds().stdout.contains("\n  P(vll) P(vl) < P(v) > P(vr) -> "), "{ran:?}");
    folder.write("dlg.burgeon", &ran.stdout);
    let check = folder.run(&["check", "dlg.burgeon"]);
    assert_eq!(check.succeeds().stdout, "dlg: checked and compiled, 5 roots\n");
    let run = folder.run(&["run", "dlg.burgeon", "--backend", "cpu"]);
    assert_eq!(run.succeeds().stdout, "dlg: 1 step, 10 modules\n");
    folder.write("bad.csv", "1,0\n0,1\n0,1\n");
    folder.run_in_vain(&["infer", "bad.csv"]).fails(1, &["bad.csv: 3 rows and 2 columns"]);
    folder.run_in_vain(&["infer", "none.csv"]).fails(1, &["none.csv", "no such file"]);
    folder.run_in_vain(&["infer", "4point.csv", "--name", "a-b"]).fails(2, &["`a-b` cannot be the name"]);
}
