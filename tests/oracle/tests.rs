//! The oracle's own tests: small systems whose words are worked out by hand.

use super::*;
use crate::tier;

/// A bilinear net over the square: its points tell which part of the root it is.
fn square() -> Net {
    let corner = |r: f64, c: f64| [r, c, 0.0, 1.0];
    Net::new([1, 1], vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)])
}

fn words(body: &str) -> Vec<Word> {
    derive(&format!("system s : patch bezier 1\n{body}"), &[square()])
}

/// `A(1, true)` for each module.
fn modules(word: &Word) -> Vec<String> {
    let param = |p: &Param| match p {
        Param::Int(i) => i.to_string(),
        Param::Bool(b) => b.to_string(),
        Param::Float(x) => format!("{x:?}"),
        other => format!("{:?}", other.floats()),
    };
    let module = |m: &Module| match m.params.as_slice() {
        [] => m.symbol.clone(),
        params => format!("{}({})", m.symbol, params.iter().map(param).collect::<Vec<_>>().join(", ")),
    };
    word.modules.iter().map(module).collect()
}

/// The modules of every word, each word as one string.
fn history(body: &str) -> Vec<String> {
    words(body).iter().map(|word| modules(word).join(" ")).collect()
}

/// The parameters that one rule `A(n) -> B(…)` gives for the argument.
fn value(declarations: &str, start: &str, expr: &str) -> String {
    let body = format!(
        "module A(n: int), B(x: int), C(x: float), D(x: bool)\n{declarations}\n\
         axiom: A({start}) = file \"square\"\nrules:\n  A(n) -> {expr}\n"
    );
    history(&body).last().unwrap().clone()
}

#[test]
fn first_rule_that_matches_fires_and_others_keep() {
    let body = "module A(n: int), B\naxiom: A(0) = file \"x\" B = file \"x\"\nrules:\n  A(n) : n < 2 -> A(n + 1)\n  \
                A(n) -> A(n + 10)\nrun:\n  derive 4\n";
    assert_eq!(history(body), ["A(0) B", "A(1) B", "A(2) B", "A(12) B", "A(22) B"]);
}

#[test]
fn literals_wildcards_and_names_bound_twice() {
    let rules = "module A(a: int, b: int, c: bool), B(k: int)\naxiom: A(1, 2, true) = file \"x\" A(3, 3, true) = file \"x\" \
                 A(3, 3, false) = file \"x\" A(-1, 0, false) = file \"x\"\nrules:\n  A(k, k, true) -> B(1)\n  A(-1, _, _) -> B(2)\n  \
                 A(_, k, false) -> B(k)\n  A -> B(9)\n";
    assert_eq!(history(rules)[1], "B(9) B(1) B(3) B(2)");
}

#[test]
fn blocks_and_their_order_keys() {
    let body = "module A, B, C, D\naxiom: A = file \"x\"\nrules:\n  \
                A -> [ A B ; [ C | eps ] [ eps ; [ D | A ] ] ]\n";
    let word = words(body).pop().unwrap();
    assert_eq!(modules(&word).join(" "), "A B C D A");
    let keys: Vec<u64> = word.modules.iter().map(|m| m.key() >> 60).collect();
    assert_eq!(keys, [0b0000, 0b0100, 0b1000, 0b1110, 0b1111]);
    let cells: Vec<Cell> = word.modules.iter().map(Module::cell).collect();
    let cell = |du, dv, i, j| Cell { du, dv, i, j };
    assert_eq!(
        cells,
        [cell(1, 1, 0, 0), cell(1, 1, 0, 1), cell(1, 2, 1, 0), cell(2, 2, 3, 2), cell(2, 2, 3, 3)]
    );
    assert!(word.modules.is_sorted_by_key(Module::key));
}

/// Of a bilinear net over the unit square the corners are the corners of the cell.
#[test]
fn nets_lie_where_cells_say() {
    let body = "module A\naxiom: A = file \"x\"\nrules:\n  A : (step + level) % 2 == 0 -> [ A [ A | A ] ; eps A ]\n  \
                A -> [ A ; [ [ A | eps ] | A ] ]\nrun:\n  derive 4\n";
    for word in words(body) {
        for module in &word.modules {
            let cell = module.cell();
            let corner = |r: u64, c: u64| {
                [
                    (cell.i + r) as f64 / 2f64.powi(cell.du as i32),
                    (cell.j + c) as f64 / 2f64.powi(cell.dv as i32),
                    0.0,
                    1.0,
                ]
            };
            assert_eq!(module.net.points, [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)]);
        }
    }
}

#[test]
fn a_relabel_keeps_net_and_path() {
    let words = words(
        "module A, B\naxiom: A = file \"x\"\nrules:\n  A -> [ A | A ]\nrules name:\n  A -> B\nrun:\n  derive 2\n  derive 1 with name\n",
    );
    let (split, named) = (&words[2].modules, &words[3].modules);
    assert!(named.iter().all(|m| m.symbol == "B"));
    assert!(split.iter().zip(named).all(|(a, b)| a.path == b.path && a.net == b.net));
}

#[test]
fn keep_does_not_count_as_fired() {
    let body = "module A(k: int)\naxiom: A(2) = file \"x\"\nrules:\n  A(k) -> A(max(k - 1, 0))\nrun:\n  derive until terminal max 9\n";
    assert_eq!(history(body), ["A(2)", "A(1)", "A(0)"]);
    // A kept module is still the predecessor of the rule that kept it: the second rule never runs.
    let body = "module A(k: int)\naxiom: A(2) = file \"x\"\nrules:\n  A(k) -> A(k)\n  A(k) -> A(k + 1)\nrun:\n  derive until terminal max 9\n  derive 2\n";
    assert_eq!(history(body), ["A(2)"; 3]);
}

#[test]
fn terminal_at_max() {
    let body =
        "module A\naxiom: A = file \"x\"\nrules:\n  A -> [ A | eps ]\nrun:\n  derive until terminal max 3\n";
    assert_eq!(words(body).len(), 4);
}

#[test]
fn schedules() {
    let head = "const two = 2\nparam flag: bool = false\nmodule A(k: int)\naxiom: A(0) = file \"x\"\nrules:\n  A(k) : step == 1 -> A(k + 10)\n  A(k) -> A(k + 1)\n\
                rules a:\n  A(5) -> A(100)\nrules b:\n  A(5) -> A(200)\n  A(k) -> A(k - 1)\nrun:\n";
    let run = |steps: &str| history(&format!("{head}{steps}")).join(" ");
    assert_eq!(run("  derive two + 1\n"), "A(0) A(1) A(11) A(12)");
    assert_eq!(run("  repeat two {\n    derive 2\n  }\n"), "A(0) A(1) A(11) A(12) A(22)");
    assert_eq!(run("  if flag {\n    derive 2\n  }\n  if !flag {\n    derive 1\n  }\n"), "A(0) A(1)");
    assert_eq!(run("  derive 1 with a\n  derive 1 with b, a\n"), "A(0) A(0) A(-1)");
    assert_eq!(run("  derive 0\n  derive -3\n"), "A(0)");
}

#[test]
fn no_run_is_one_step_and_a_limit_counts_listed_steps() {
    let text = "param n: int = 1\nsystem s : patch bezier 1\nmodule A(k: int)\naxiom: A(n) = file \"x\"\nrules:\n  A(k) : k < 3 -> A(k + 1)\n\
                run:\n  derive until terminal max 9\n  derive 2\n";
    let file = parse(text);
    let square = |_: &str| vec![square()];
    let oracle = |limit| Oracle::new(&file, Some("s"), &square).steps(limit);
    assert_eq!(oracle(None).derive().len(), 5);
    assert_eq!(oracle(Some(0)).derive().len(), 1);
    assert_eq!(oracle(Some(3)).derive().len(), 4);
    assert_eq!(oracle(None).set("n", Param::Int(3)).derive().len(), 3);
    assert_eq!(words("module A\naxiom: A = file \"x\"\n").len(), 2);
}

#[test]
fn roots_are_counted_over_all_sources() {
    let body = "module A, B\naxiom: A = file \"x\"\n  B = [[(0, 0, 0), (1, 2, 3)], [(4, 5, 6), (7, 8, 9)]] A = file \"x\" [0]\nrules:\n  A -> eps\n";
    let words = words(body);
    assert_eq!(words[0].modules.iter().map(|m| m.root).collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(words[1].modules.len(), 1);
    assert_eq!(words[1].modules[0].net.point(1, 0), [4.0, 5.0, 6.0, 1.0]);
}

#[test]
fn integers_wrap_and_nothing_divides_by_zero() {
    let of = |start: &str, expr: &str| value("", start, &format!("B({expr})"));
    assert_eq!(of("2147483647", "n + 1"), "B(-2147483648)");
    assert_eq!(of("-2147483648", "-n"), "B(-2147483648)");
    assert_eq!(of("-2147483648", "abs(n)"), "B(-2147483648)");
    assert_eq!(of("-2147483648", "n / -1"), "B(-2147483648)");
    assert_eq!(of("-2147483648", "n % -1"), "B(0)");
    assert_eq!(of("46341", "n * n"), "B(-2147479015)");
    assert_eq!(of("7", "n / (n - n)"), "B(7)");
    assert_eq!(of("7", "n % (n - n)"), "B(0)");
    assert_eq!(of("-7", "n % 3"), "B(-1)");
    assert_eq!(of("-7", "n / 2"), "B(-3)");
}

#[test]
fn numerals_are_exact_and_names_are_not() {
    let of = |expr: &str| value("const half = 1/2\nconst three = 3", "3", expr);
    assert_eq!(of("B(3/2*2)"), "B(3)");
    assert_eq!(of("B(n/2*2)"), "B(2)");
    assert_eq!(of("B(three/2)"), "B(1)");
    assert_eq!(of("C(3/2)"), "C(1.5)");
    assert_eq!(of("C(n/2)"), "C(1.0)");
    assert_eq!(of("C(n*half)"), "C(1.5)");
    assert_eq!(of("D(1/3 + 1/3 + 1/3 == 1)"), "D(true)");
    assert_eq!(of("D(n > 5/2 && n < 7/2)"), "D(true)");
    assert_eq!(of("C(if(n > 0, 1, 1/2)/2)"), "C(0.5)");
}

#[test]
fn lists_are_clamped_and_lets_are_read() {
    let of =
        |expr: &str| value("const table = [5, 7, 9]\nparam shift: int = 1\nconst far = 3*shift", "-1", expr);
    assert_eq!(of("B(table[n])"), "B(5)");
    assert_eq!(of("B(table[n + 2])"), "B(7)");
    assert_eq!(of("B(table[far])"), "B(9)");
    let body = "module A(k: int)\naxiom: A(3) = file \"x\"\nrules:\n  A(k) let x = k * k, y = x > 8 : y -> A(x + 1)\n";
    assert_eq!(history(body)[1], "A(10)");
}

#[test]
fn attributes_and_queries() {
    let body = "module A(x: float), B(l: int)\nquery Deep(d: int) = level\naxiom: A(0) = file \"x\"\nrules:\n  \
                ?Deep(d) A(x) : d == 0 -> [ A(uv.x) | [ A(uv.y) ; A(centroid.x) ] ]\n  ?Deep(d) A(x) : uv.y > 1/2 -> B(d + level)\n\
                run:\n  derive 2\n";
    assert_eq!(history(body)[1..], ["A(0.5) A(0.5) A(0.5)", "A(0.5) B(2) B(2)"]);
}

#[test]
fn two_ways_to_a_net() {
    for seed in 0..20 {
        let case = case(seed);
        let words = case.derive();
        for module in &words.last().unwrap().modules {
            // Products of the halving matrices along the path first, the root last.
            let cell = module.cell();
            let product = |degree: usize, halvings: u32, index: u64| {
                (0..halvings).rev().fold(None::<halving::Matrix>, |product, bit| {
                    let half = if index >> bit & 1 == 0 { left(degree) } else { right(degree) };
                    Some(product.map_or(half.clone(), |p| times(&half, &p)))
                })
            };
            let [m, n] = module.net.degree;
            let whole = |degree| halving::matrix(degree, halving::Part::Whole);
            let rows = product(m, cell.du, cell.i).unwrap_or(whole(m));
            let columns = product(n, cell.dv, cell.j).unwrap_or(whole(n));
            let net = words[0].roots[module.root].product(&rows, &columns);
            let bound = words[0].magnitude(module);
            for ((a, b), size) in net.points.iter().zip(&module.net.points).zip(&bound.points) {
                for axis in 0..4 {
                    assert!((a[axis] - b[axis]).abs() <= 1e-13 * size[axis], "{case}");
                }
            }
        }
    }
}

fn times(a: &halving::Matrix, b: &halving::Matrix) -> halving::Matrix {
    let entry = |row: &Vec<f64>, c: usize| row.iter().zip(b).map(|(x, other)| x * other[c]).sum();
    a.iter().map(|row| (0..b[0].len()).map(|c| entry(row, c)).collect()).collect()
}

// --- the generator ---------------------------------------------------------------------------

#[test]
fn a_seed_is_a_case() {
    for seed in 0..30 {
        let (a, b) = (case(seed), case(seed));
        assert_eq!((a.text, a.nets, a.steps), (b.text, b.nets, b.steps));
    }
}

/// Every construct occurs, the words live, and they stay bounded.
#[test]
fn cases_are_varied_and_bounded() {
    let count: u64 = tier::cases(100, 300);
    let (mut grown, mut exact, mut erased, mut idle) = (0, 0, 0, 0);
    let mut text = String::new();
    for seed in 0..count {
        let case = case(seed);
        let words = case.derive();
        let (first, last) = (&words[0], words.last().unwrap());
        assert!(words.iter().all(|w| w.modules.len() <= 3000), "{case}");
        assert!(last.modules.iter().all(|m| lattice_bits(m, 0) < 500 && m.key_bits() <= 60), "{case}");
        grown += u32::from(last.modules.len() >= 4 * first.modules.len());
        erased += u32::from(last.modules.is_empty());
        exact += u32::from(last.modules.iter().any(|m| lattice_bits(m, case.bits) <= 24));
        idle += u32::from(words.windows(2).any(|w| w[0] == w[1]));
        text += &case.text;
    }
    let part = |of_300: u64| (of_300 * count / 300) as u32;
    let enough = grown > part(80) && exact > part(150) && idle > part(20) && erased < part(60);
    assert!(enough, "{grown} {exact} {idle} {erased}");
    for construct in CONSTRUCTS {
        assert!(text.contains(construct), "no case has `{construct}`");
    }
}

#[test]
fn a_case_shrinks_to_what_fails() {
    let parses = |text: &str| burgeon::language::parse::parse(text).diagnostics.is_empty();
    let large = (0..).map(case).find(|c| c.text.matches("derive").count() > 2).unwrap();
    let small = minimise(&large, |c| parses(&c.text) && c.text.contains("derive"));
    assert!(small.text.lines().count() <= 4, "{}", small.text);
    assert_eq!((small.nets.len(), small.set.len()), (1, 0));
}

// --- the comparison --------------------------------------------------------------------------

#[test]
fn a_rounded_word_passes() {
    for seed in 0..60 {
        let case = case(seed);
        for (step, word) in case.derive().iter().enumerate() {
            let engine = engine_word(word, step);
            assert_same(step, word, &engine, Tolerance::Lattice { bits: case.bits, c: 1.0 });
            assert_same(step, word, &engine, Tolerance::Carried { c: 1.0 });
        }
    }
}

#[test]
fn every_difference_is_found_and_named() {
    let body = "module A(k: int, b: bool), B(x: float)\naxiom: A(1, true) = file \"x\"\nrules:\n  A(k, b) -> [ A(k + 1, b) | B(k/3) ]\nrun:\n  derive 2\n";
    let word = words(body).pop().unwrap();
    let good = engine_word(&word, 2);
    let error = |break_it: &dyn Fn(&mut burgeon::patch::Word)| {
        let mut bad = good.clone();
        break_it(&mut bad);
        compare(&word, &bad, Tolerance::Exact).unwrap_err()
    };
    use burgeon::word::Column;
    assert_eq!(compare(&word, &good, Tolerance::Exact), Ok(()));
    assert!(error(&|w| w.modules[1].symbol = 0).contains("module 1: the symbols differ"));
    let a = good.modules[0].symbol;
    let column = |column: Column| error(&|w| *w.params.column_mut(a, 0).expect("a column") = column.clone());
    assert!(column(Column::Int(vec![0])).contains("parameter 0 is Int(3) and Int(0)"));
    assert!(column(Column::Float(vec![3.0])).contains("parameter 0"));
    assert!(error(&|w| w.modules[2].root = 1).contains("module 2: the roots differ"));
    assert!(error(&|w| w.modules[2].key += 1).contains("order keys"));
    assert!(error(&|w| w.modules[0].cell.j = 1).contains("cells"));
    assert!(error(&|w| w.nets[5][1] = 0.3).contains("module 1: yw of point (0, 1) is 0.5"));
    assert!(error(&|w| w.nets[5][2] = f32::NAN).contains("NaN"));
    assert!(
        error(&|w| w.modules.truncate(2))
            .contains("the oracle has 3 modules, the engine 2; the oracle's next is B")
    );
    // One ulp is too much when equality is asked for, and within the bound when it is not.
    let mut near = good.clone();
    near.nets[5][1] = f32::from_bits(near.nets[5][1].to_bits() + 1);
    assert!(compare(&word, &near, Tolerance::Exact).is_err());
    assert!(compare(&word, &near, Tolerance::Lattice { bits: 1, c: 1.0 }).is_err());
    assert!(compare(&word, &near, Tolerance::Lattice { bits: 24, c: 1.0 }).is_ok());
    assert!(compare(&word, &near, Tolerance::Carried { c: 1.0 }).is_ok());
}

#[test]
#[should_panic(expected = "after step 2 of `s`: the oracle has 1 modules, the engine 0")]
fn a_missing_module_stops_the_test() {
    let word = words("module A\naxiom: A = file \"x\"\n").pop().unwrap();
    let mut engine = engine_word(&word, 2);
    engine.modules.clear();
    assert_same(2, &word, &engine, Tolerance::Exact);
}
