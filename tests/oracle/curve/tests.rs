//! The oracle's own tests: small systems whose words are worked out by hand.

use super::*;

/// Every word of the last system, as it is written.
fn history(text: &str) -> Vec<String> {
    Job::new(text).derive().iter().map(Word::to_string).collect()
}

#[test]
fn contexts_of_a_short_word() {
    let text = "system s : curve open\nmodule A(x: float), B(x: float, y: float)\naxiom: A(1.5) B(2, 3) A(4.5)\n\
                rules:\n  A(x) -> A(2*x + 1)\n  A(w) < B(x, y) > A(z) -> A(w + x) A(y + z)\n";
    assert_eq!(history(text)[1], "A(4) A(3.5) A(7.5) A(10)");
}
