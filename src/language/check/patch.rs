//! The words of patch systems: blocks, relabelling, erasure.

use super::declare::is_turtle;
use super::scope::Scope;
use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{self, Element, Span};
use crate::language::system::{Block, Cell, Successor, SurfaceElement};

impl<'a> Checker<'a> {
    pub(super) fn patch_successor(
        &mut self,
        scope: &mut Scope<'a>,
        word: &'a [Element],
        span: Span,
    ) -> Option<Successor> {
        match word {
            [] => {
                let error = Diagnostic::error(code::PATCH_SUCCESSOR, span, "the successor is empty");
                self.report(error.hint("write `eps` to erase"));
                None
            }
            [Element::Eps(_)] => Some(Successor::Erase),
            [Element::Module(used)] => self.module_use(scope, used).map(Successor::Relabel),
            [Element::Block(block)] => self.block(scope, block).map(Successor::Split),
            several => self.surface_word(scope, several),
        }
    }

    fn block(&mut self, scope: &mut Scope<'a>, block: &'a syntax::Block) -> Option<Block> {
        let rows = block.rows.len();
        let columns = block.rows.first().map_or(0, Vec::len);
        let ragged = block.rows.iter().any(|row| row.len() != columns);
        if ragged || !matches!((rows, columns), (1, 2) | (2, 1) | (2, 2)) {
            let message = format!("a block is 1×2, 2×1 or 2×2, not {rows}×{columns}");
            let error = Diagnostic::error(code::PATCH_SUCCESSOR, block.span, message);
            self.report(error.hint("nest blocks for more cells"));
            return None;
        }
        let mut cells = Vec::with_capacity(rows * columns);
        let mut whole = true;
        for cell in block.rows.iter().flatten() {
            let cell = match cell {
                syntax::Cell::Eps(_) => Some(Cell::Eps),
                syntax::Cell::Module(used) => self.module_use(scope, used).map(Cell::Module),
                syntax::Cell::Block(inner) => self.block(scope, inner).map(Cell::Block),
            };
            match cell {
                Some(cell) => cells.push(cell),
                None => whole = false,
            }
        }
        whole.then_some(Block { rows, columns, cells, span: block.span })
    }

    /// Several elements, or a branch: the bracketed surfaces, which are reserved but may be written.
    fn surface_word(&mut self, scope: &mut Scope<'a>, word: &'a [Element]) -> Option<Successor> {
        let mut whole = true;
        let mut branches = false;
        for element in word {
            match element {
                Element::Branch(branch, span) if !begins_with_turtle(branch) => {
                    let message = "this bracket is neither a block nor a branch";
                    let error = Diagnostic::error(code::BRANCH, *span, message);
                    self.report(error.hint(
                        "write `[ A | B ]` or `[ A ; B ]` for a block; a branch begins with a turtle symbol",
                    ));
                    whole = false;
                }
                Element::Branch(..) => branches = true,
                Element::Block(block) => {
                    self.many(block.span);
                    whole = false;
                }
                Element::Eps(_) | Element::Module(_) => {}
            }
        }
        if whole && !branches {
            let span = word.iter().skip(1).fold(span_of(&word[0]), |s, e| s.to(span_of(e)));
            self.many(span);
            whole = false;
        }
        let elements = self.surface_elements(scope, word);
        elements.filter(|_| whole).map(Successor::Surface)
    }

    fn surface_elements(
        &mut self,
        scope: &mut Scope<'a>,
        word: &'a [Element],
    ) -> Option<Vec<SurfaceElement>> {
        let elements: Vec<Option<SurfaceElement>> =
            word.iter().map(|element| self.surface_element(scope, element)).collect();
        elements.into_iter().collect()
    }

    fn surface_element(&mut self, scope: &mut Scope<'a>, element: &'a Element) -> Option<SurfaceElement> {
        Some(match element {
            Element::Eps(_) => SurfaceElement::Eps,
            Element::Module(used) => {
                let module = self.module_use(scope, used)?;
                match self.is_turtles(module.symbol) {
                    true => SurfaceElement::Turtle(module),
                    false => SurfaceElement::Net(module),
                }
            }
            Element::Branch(branch, _) => SurfaceElement::Branch(self.surface_elements(scope, branch)?),
            Element::Block(block) => SurfaceElement::Block(self.block(scope, block)?),
        })
    }

    fn many(&mut self, span: Span) {
        let message = "a successor of a patch system is one block, one module or `eps`";
        let error = Diagnostic::error(code::PATCH_SUCCESSOR, span, message);
        self.report(
            error.hint("several modules stand in a block: `[ A | B ]`, `[ A ; B ]` or `[ A B ; C D ]`"),
        );
    }
}

fn begins_with_turtle(branch: &[Element]) -> bool {
    match branch.first() {
        Some(Element::Module(used)) => is_turtle(&used.symbol.text),
        _ => false,
    }
}

fn span_of(element: &Element) -> Span {
    match element {
        Element::Eps(span) | Element::Branch(_, span) => *span,
        Element::Module(used) => used.span,
        Element::Block(block) => block.span,
    }
}
