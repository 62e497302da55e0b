//! Brackets of a word as links between its modules.

use crate::language::syntax::Element;
use crate::language::system::{CurveWord, Hang, Module};

/// A word of these modules, which stand in the order in which they are written. A branch that begins with a branch
/// is two of them.
pub(super) fn curve_word(word: &[Element], modules: Vec<Module>) -> CurveWord {
    let (mut hangs, mut slots) = (Vec::new(), 0);
    axis(word, Hang::default(), &mut slots, &mut hangs);
    CurveWord { modules, hangs, slots }
}

/// The modules of an axis that begins with `first`, and of the branches at it.
fn axis(word: &[Element], first: Hang, slot: &mut u32, found: &mut Vec<Hang>) {
    let mut next = first;
    for element in word {
        match element {
            Element::Module(_) => {
                found.push(Hang { slot: *slot, ..next });
                next = Hang { on: Some(found.len() - 1), ..Hang::default() };
                *slot += 1;
            }
            Element::Branch(branch, _) => axis(branch, Hang { lateral: true, ..next }, slot, found),
            Element::Eps(_) => *slot += 1,
            // The checker has refused it.
            Element::Block(_) => {}
        }
    }
}
