//! A system whose erased cells stay in the word, as modules of a symbol of their own.
//!
//! A tessellation wants to know where a surface ends: the leaves of a word with its holes cover
//! each root once. No rule names the symbol, so such a module is never rewritten, and all others are what
//! they are without it, to the bit and the random number.

use crate::language::system::{Block, Cell, Module, Rule, Successor, Symbol, System};
use crate::patch::Word;

/// The name of the symbol.
pub const HOLE: &str = "ε";

/// The system with its holes kept, and their symbol.
pub fn kept(system: &System) -> (System, usize) {
    let mut system = system.clone();
    let hole = system.symbols.len();
    let span = system.source.name.span;
    system.symbols.push(Symbol { name: HOLE.to_string(), fields: Vec::new(), span });
    for rule in system.groups.iter_mut().flat_map(|group| &mut group.rules) {
        keep(rule, hole);
    }
    (system, hole)
}

/// A word without its holes: what the system derives that does not keep them. `hole` is their symbol, the last.
pub fn dropped(word: &Word, hole: usize) -> Word {
    let left = |n: &usize| word.modules[*n].symbol != hole;
    let there: Vec<usize> = (0..word.modules.len()).filter(left).collect();
    let mut params = word.params.clone();
    params.truncate(hole);
    Word {
        system: word.system.clone(),
        symbols: word.symbols.iter().take(hole).cloned().collect(),
        modules: there.iter().map(|&n| word.modules[n]).collect(),
        params,
        nets: there.iter().flat_map(|&n| word.net(n)).copied().collect(),
        ..*word
    }
}

fn keep(rule: &mut Rule, hole: usize) {
    for alternative in &mut rule.alternatives {
        let module = || Module { symbol: hole, args: Vec::new(), span: alternative.span };
        match &mut alternative.successor {
            erased @ Successor::Erase => *erased = Successor::Relabel(module()),
            Successor::Split(block) => keep_in(block, hole),
            Successor::Relabel(_) | Successor::Word(_) | Successor::Surface(_) | Successor::Face(_) => {}
        }
    }
}

fn keep_in(block: &mut Block, hole: usize) {
    let span = block.span;
    for cell in &mut block.cells {
        match cell {
            erased @ Cell::Eps => {
                *erased = Cell::Module(Module { symbol: hole, args: Vec::new(), span });
            }
            Cell::Block(inner) => keep_in(inner, hole),
            Cell::Module(_) => {}
        }
    }
}
