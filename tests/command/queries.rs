//! `--bind` and the flags of the view.

use super::*;

const BOUND: &str = "system bound : patch bezier 3\nmodule P(n: int)\nquery Heat(t: float)\n\
    axiom: P(0) = file \"net.bpt\"\nrules:\n  ?Heat(t) P(n) : t > 0.5 -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]\n";

const FIELD: &str = "system field : patch bezier 3\nmodule P(n: int)\nquery Heat(t: float)\n\
    axiom: P(0) = file \"net.bpt\"\nrules:\n  P(n) : Heat(centroid) > 0.5 -> [ P(n+1) | P(n+1) ]\n";

const GRID: &str = r#"{"size": [1, 1, 1], "from": [0, 0, 0], "to": [0, 0, 0], "values": [0.75]}"#;

#[test]
fn values_are_bound_by_file() {
    let folder = Folder::new();
    folder.write("bound.burgeon", BOUND);
    folder.write("hot.csv", "0.75\n");
    folder.write("cold.csv", "0.25\r\n\r\n");
    for (file, said) in [("hot.csv", "bound: 1 step, 4 modules\n"), ("cold.csv", "bound: 1 step, 1 module\n")]
    {
        let bind = format!("Heat={file}");
        let ran = folder.run_in_vain(&["run", "bound.burgeon", "--backend", "cpu", "--bind", &bind]);
        assert_eq!(ran.succeeds().stdout, said);
    }
    folder.write("field.burgeon", FIELD);
    folder.write("grid.json", GRID);
    let ran = folder.run_in_vain(&["run", "field.burgeon", "--backend", "cpu", "--bind", "Heat=grid.json"]);
    assert_eq!(ran.succeeds().stdout, "field: 1 step, 2 modules\n");
}

#[test]
fn values_that_are_wrong_are_named() {
    let folder = Folder::new();
    folder.write("bound.burgeon", BOUND);
    folder.write("field.burgeon", FIELD);
    let text = |file: &str, text: &str, status: i32, said: &[&str]| {
        folder.write(file, text);
        let bind = format!("Heat={file}");
        let rules = if file.ends_with(".json") { "field.burgeon" } else { "bound.burgeon" };
        folder.run_in_vain(&["run", rules, "--backend", "cpu", "--bind", &bind]).fails(status, said);
    };
    text("a.csv", "warm\n", 1, &["a.csv:1:1: `warm` stands where a number, true or false should"]);
    // What stands in quotes is a number, too: this one is too many.
    text(
        "quoted.csv",
        "\"0.5\"\n \"1\" , \"2\"\n",
        1,
        &["quoted.csv:2:1: this line is no float: write one number"],
    );
    text("b.csv", "0.5\n1, 2\n", 1, &["b.csv:2:1: this line is no float: write one number"]);
    text("c.csv", "1e39\n", 1, &["c.csv:1:1", "within the range of 32-bit floats"]);
    text(
        "d.csv",
        "1\n2\n",
        2,
        &["Heat wants a value for each patch of the axiom, 1, and is bound to 2", "--bind QUERY=FILE"],
    );
    text("e.txt", "1\n", 1, &["e.txt", ".csv", ".json"]);
    text("a.json", "{\"size\": [1, 1]}", 1, &["a.json:1:", "a grid is {\"size\""]);
    text("b.json", &GRID.replace("0.75", "true"), 1, &["b.json: value 0 is no float"]);
    text(
        "c.json",
        &GRID.replace("0.75", "1, 2"),
        2,
        &["the grid of Heat has 1×1×1 points, and values for 2"],
    );
    let run =
        |more: &[&str]| folder.run_in_vain(&[&["run", "bound.burgeon", "--backend", "cpu"], more].concat());
    run(&[]).fails(2, &["nothing is bound to the query Heat; it wants one value a patch"]);
    run(&["--bind", "Heat"]).fails(2, &["QUERY=FILE", "heat=heat.csv"]);
    run(&["--bind", "Heat=none.csv"]).fails(1, &["cannot read none.csv"]);
    folder.write("hot.csv", "0.75\n");
    run(&["--bind", "Cold=hot.csv"]).fails(2, &["`Cold` is no query of bound; it has Heat"]);
}

#[test]
fn a_view_is_given_by_flags() {
    let folder = Folder::new();
    folder.write(
        "seen.burgeon",
        "system seen : patch bezier 3\nmodule P(n: int)\naxiom: P(0) = file \"net.bpt\"\n\
         rules:\n  P(n) : bbox_px > 200 && n < 5 -> [ P(n+1) P(n+1) ; P(n+1) P(n+1) ]\nrun:\n  derive 5\n",
    );
    let run =
        |more: &[&str]| folder.run_in_vain(&[&["run", "seen.burgeon", "--backend", "cpu"], more].concat());
    run(&[]).fails(2, &["the rules read `bbox_px`, which is seen through a view", "--eye X,Y,Z"]);
    let modules = |more: &[&str]| {
        let ran = run(more);
        let stdout = ran.succeeds().stdout.clone();
        let words: Vec<&str> = stdout.split_whitespace().collect();
        words[words.len() - 2].parse::<u32>().expect("a number of modules")
    };
    let near = modules(&["--eye", "1.5,1.5,4"]);
    let far = modules(&["--eye", "1.5,1.5,400"]);
    assert!(near > far && far == 1, "{near} and {far}");
    assert!(modules(&["--eye", "1.5,1.5,4", "--pixels", "128x72"]) < near);
    assert_eq!(modules(&["--eye", "1.5,1.5,4", "--look-at", "1.5,1.5,8"]), 1, "all of it lies behind");
    run(&["--look-at", "0,0,0"]).fails(2, &["--eye"]);
    run(&["--eye", "1,2"]).fails(2, &["`1,2` is no point"]);
    run(&["--eye", "1,2,3", "--angle", "180"]).fails(2, &["between 0 and 180"]);
    run(&["--eye", "1,2,3", "--pixels", "0x0"]).fails(2, &["write 1280x720"]);
}
