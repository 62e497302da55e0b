//! What stands around a module: contexts, as the requirement words them.

use super::super::expression::Scope;
use super::super::pattern::match_args;
use super::word::{Link, Module, Topology, Word};
use burgeon::language::syntax::{ContextPart, LeftContext, Pattern, RightContext};

/// A word with its links, without the symbols that contexts ignore.
pub struct Surroundings<'a> {
    topology: Topology,
    pub modules: Vec<&'a Module>,
    links: Vec<Link>,
    /// In the order of the word: branches first, then the one that goes on.
    children: Vec<Vec<usize>>,
    ignored: &'a [&'a str],
}

/// A right context in the form of a word's links: a bracket that begins with a bracket is two of them.
enum Part<'a> {
    Module(&'a Pattern),
    Branch(Vec<Part<'a>>),
    End,
}

/// Names with their values.
type Bound = Vec<(String, super::super::value::Value)>;

impl<'a> Surroundings<'a> {
    pub fn new(word: &'a Word, ignored: &'a [&'a str]) -> Surroundings<'a> {
        let links = word.links();
        let mut children = vec![Vec::new(); links.len()];
        for (index, link) in links.iter().enumerate() {
            if let Some(parent) = link.parent {
                children[parent].push(index);
            }
        }
        Surroundings { topology: word.topology, modules: word.modules().collect(), links, children, ignored }
    }

    fn is_ignored(&self, at: usize) -> bool {
        self.ignored.contains(&self.modules[at].symbol.as_str())
    }

    /// The module before, in a branch its parent; `None` at the beginning.
    fn before(&self, at: usize) -> Option<usize> {
        if self.topology == Topology::Ring {
            let n = self.modules.len();
            return (1..=n).map(|d| (at + n - d) % n).find(|i| !self.is_ignored(*i));
        }
        let parent = self.links[at].parent?;
        if self.is_ignored(parent) { self.before(parent) } else { Some(parent) }
    }

    /// The first modules of the branches at a module, and the module that goes on its axis.
    fn behind(&self, at: usize) -> (Vec<usize>, Option<usize>) {
        if self.topology == Topology::Ring {
            let n = self.modules.len();
            return (Vec::new(), (1..=n).map(|d| (at + d) % n).find(|i| !self.is_ignored(*i)));
        }
        let (mut branches, mut next) = (Vec::new(), None);
        for &child in &self.children[at] {
            if !self.is_ignored(child) {
                match self.links[child].lateral {
                    true => branches.push(child),
                    false => next = Some(child),
                }
                continue;
            }
            // As if it had been erased: what hangs on it hangs on what it hangs on.
            let (further, beyond) = self.behind(child);
            branches.extend(further);
            match self.links[child].lateral {
                true => branches.extend(beyond),
                false => next = beyond,
            }
        }
        (branches, next)
    }

    pub fn left(&self, context: &LeftContext, at: usize, scope: &mut Scope) -> bool {
        if context.end && self.topology == Topology::Ring {
            return false;
        }
        let mut at = at;
        let mut found = Vec::new();
        for _ in &context.patterns {
            let Some(before) = self.before(at) else { return false };
            found.insert(0, before);
            at = before;
        }
        let ended = !context.end || self.before(at).is_none();
        ended && context.patterns.iter().zip(found).all(|(pattern, at)| self.fits(pattern, at, scope))
    }

    /// Whether symbol and parameters fit; then the names are bound.
    pub fn fits(&self, pattern: &Pattern, at: usize, scope: &mut Scope) -> bool {
        assert!(pattern.tag.is_none(), "tags are of mesh systems");
        let module = self.modules[at];
        pattern.symbol.text == module.symbol && match_args(pattern, &module.params, scope)
    }

    pub fn right(&self, context: &RightContext, at: usize, scope: &mut Scope) -> bool {
        match self.parts(&parts(context), at, 0, scope.bound.clone(), scope, &|bound| Some(bound)) {
            Some(bound) => {
                scope.bound = bound;
                true
            }
            None => false,
        }
    }

    /// Matches `parts` behind the module `at`, whose first `used` branches are behind us, then what
    /// `then` has to match; the names bound by the first way that is found.
    fn parts(
        &self,
        parts: &[Part],
        at: usize,
        used: usize,
        bound: Bound,
        scope: &Scope,
        then: &dyn Fn(Bound) -> Option<Bound>,
    ) -> Option<Bound> {
        let Some((part, rest)) = parts.split_first() else { return then(bound) };
        let (branches, next) = self.behind(at);
        match part {
            Part::End if self.topology == Topology::Ring || next.is_some() => None,
            Part::End => self.parts(rest, at, used, bound, scope, then),
            Part::Module(pattern) => {
                let next = next?;
                let bound = self.bound(pattern, next, bound, scope)?;
                self.parts(rest, next, 0, bound, scope, then)
            }
            // k brackets, k different branches, in order; of several ways the first.
            Part::Branch(inner) => (used..branches.len()).find_map(|branch| {
                let [Part::Module(first), within @ ..] = inner.as_slice() else { return None };
                let bound = self.bound(first, branches[branch], bound.clone(), scope)?;
                self.parts(within, branches[branch], 0, bound, scope, &|bound| {
                    self.parts(rest, at, branch + 1, bound, scope, then)
                })
            }),
        }
    }

    fn bound(&self, pattern: &Pattern, at: usize, bound: Bound, scope: &Scope) -> Option<Bound> {
        let mut scope = Scope { bound, ..*scope };
        self.fits(pattern, at, &mut scope).then_some(scope.bound)
    }
}

fn parts(context: &RightContext) -> Vec<Part<'_>> {
    let mut list = Vec::new();
    for part in &context.parts {
        match part {
            ContextPart::Pattern(pattern) => list.push(Part::Module(pattern)),
            ContextPart::Branch(inner) => {
                let mut inner = parts(inner);
                let leading = inner.iter().take_while(|p| matches!(p, Part::Branch(_))).count();
                let rest = inner.split_off(leading);
                list.extend(inner);
                if !rest.is_empty() {
                    list.push(Part::Branch(rest));
                }
            }
        }
    }
    if context.end {
        list.push(Part::End);
    }
    list
}
