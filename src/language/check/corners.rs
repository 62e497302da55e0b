//! How many corners the faces of a symbol may have, and which a template's base needs.

use super::{Checker, code};
use crate::language::diagnostic::Diagnostic;
use crate::language::syntax::{self, Span, StepKind};
use crate::language::system::SymbolId;
use std::collections::{BTreeSet, HashMap};

/// Which numbers of corners the faces of each symbol may have, and which templates need.
#[derive(Debug, Default)]
pub(super) struct Corners {
    /// A symbol with a number of corners; none if it may be any.
    pub given: Vec<(SymbolId, Option<usize>)>,
    /// A face of the first symbol becomes one of the second.
    pub relabelled: Vec<(SymbolId, SymbolId)>,
    /// A template that replaces faces of a symbol.
    pub needed: Vec<(SymbolId, usize, Span)>,
}

impl<'a> Checker<'a> {
    /// Templates whose base has other corners than any face that their rule can meet.
    pub(super) fn base_sizes(&mut self) {
        // New faces from elsewhere may have any number of corners.
        if changes_faces(self.system) {
            return;
        }
        let corners = std::mem::take(&mut self.corners);
        let mut sizes: HashMap<SymbolId, Option<BTreeSet<usize>>> = HashMap::new();
        for (symbol, n) in &corners.given {
            let known = sizes.entry(*symbol).or_insert_with(|| Some(BTreeSet::new()));
            match (n, known.as_mut()) {
                (Some(n), Some(set)) => _ = set.insert(*n),
                _ => *known = None,
            }
        }
        // Each round carries sizes along one relabelling.
        for _ in 0..=self.symbols.len() {
            for (from, to) in &corners.relabelled {
                let given = sizes.get(from).cloned().unwrap_or_else(|| Some(BTreeSet::new()));
                let known = sizes.entry(*to).or_insert_with(|| Some(BTreeSet::new()));
                match (given, known.as_mut()) {
                    (Some(given), Some(set)) => set.extend(given),
                    _ => *known = None,
                }
            }
        }
        for (symbol, needed, span) in corners.needed {
            let Some(Some(known)) = sizes.get(&symbol) else { continue };
            if known.is_empty() || known.contains(&needed) {
                continue;
            }
            let known: Vec<String> = known.iter().map(usize::to_string).collect();
            let name = &self.symbols[symbol].name;
            let message = format!(
                "the base of this template has {needed} corners, and faces `{name}` have {}",
                known.join(" or ")
            );
            self.report(Diagnostic::error(code::BASE_SIZE, span, message));
        }
    }
}

/// Whether the run makes faces with other numbers of corners, or symbols from elsewhere.
fn changes_faces(system: &syntax::System) -> bool {
    fn changes(steps: &[syntax::Step]) -> bool {
        steps.iter().any(|step| match &step.kind {
            StepKind::Subdivide { .. } | StepKind::Mark { .. } => true,
            StepKind::Repeat { body, .. } | StepKind::If { body, .. } => changes(body),
            _ => false,
        })
    }
    system.items.iter().any(|item| match item {
        syntax::Item::Run(run) => changes(&run.steps),
        _ => false,
    })
}
