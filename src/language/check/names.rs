//! Consts and params: declared in any order, each computed once.

use super::Checker;
use super::code;
use crate::language::diagnostic::Diagnostic;
use crate::language::expr::Value;
use crate::language::syntax::{Const, Expr, ExprKind, Item, Name, Param};
use crate::language::{Type, syntax};
use std::collections::HashMap;

/// A const or param as declared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declaration<'a> {
    pub name: &'a Name,
    pub ty: Option<&'a Name>,
    pub value: &'a Expr,
    pub range: Option<&'a (Expr, Expr)>,
    pub is_param: bool,
    /// Declared in the system itself, not above it.
    pub own: bool,
}

impl<'a> Declaration<'a> {
    pub fn of_const(c: &'a Const, own: bool) -> Declaration<'a> {
        Declaration { name: &c.name, ty: c.ty.as_ref(), value: &c.value, range: None, is_param: false, own }
    }

    pub fn of_param(p: &'a Param, own: bool) -> Declaration<'a> {
        let (ty, range) = (p.ty.as_ref(), p.range.as_ref());
        Declaration { name: &p.name, ty, value: &p.value, range, is_param: true, own }
    }

    pub fn word(&self) -> &'static str {
        if self.is_param { "param" } else { "const" }
    }
}

/// What a declared name stands for.
#[derive(Clone, Debug)]
pub(super) enum Known {
    Value(Value),
    Uniform(usize, Type),
    /// It was reported.
    Broken,
}

#[derive(Clone, Debug)]
pub(super) enum State {
    Waiting,
    /// On the way to it: meeting it again is a cycle.
    Working,
    Done(Known),
}

#[derive(Debug)]
struct Entry<'a> {
    declaration: Declaration<'a>,
    state: State,
    used: bool,
}

/// The consts and params that a system sees.
#[derive(Debug, Default)]
pub(super) struct Names<'a> {
    entries: Vec<Entry<'a>>,
    index: HashMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    pub fn find(&self, name: &str) -> Option<usize> {
        self.index.get(name).copied()
    }

    pub fn declaration(&self, index: usize) -> Declaration<'a> {
        self.entries[index].declaration
    }

    pub fn state(&self, index: usize) -> &State {
        &self.entries[index].state
    }

    pub fn set(&mut self, index: usize, state: State) {
        self.entries[index].state = state;
    }

    pub fn mark_used(&mut self, index: usize) {
        self.entries[index].used = true;
    }

    pub fn len(&self) -> usize {
        self.entries.len()
    }

    pub fn all(&self) -> impl Iterator<Item = &'a str> {
        self.index.keys().copied()
    }

    /// The declarations that an expression names.
    pub fn named_in(&self, expr: &Expr) -> Vec<usize> {
        let mut found = Vec::new();
        each_name(expr, &mut |name| found.extend(self.find(name)));
        found
    }

    pub fn used_shared(&self) -> Vec<&'a str> {
        let shared = self.entries.iter().filter(|e| !e.declaration.own && e.used);
        shared.map(|e| e.declaration.name.text.as_str()).collect()
    }

    pub fn unused_own(&self) -> Vec<Diagnostic> {
        let own: Vec<Declaration> =
            self.entries.iter().filter(|e| e.declaration.own).map(|e| e.declaration).collect();
        unused(&own, |d| self.index.get(d.name.text.as_str()).is_some_and(|i| self.entries[*i].used))
    }
}

/// A warning for each declaration that nothing reads. The engine itself reads a few.
pub(super) fn unused(
    declarations: &[Declaration],
    is_used: impl Fn(&Declaration) -> bool,
) -> Vec<Diagnostic> {
    let read_by_engine = |d: &Declaration| {
        d.name.text == "angle" || d.is_param && matches!(d.name.text.as_str(), "seed" | "detail")
    };
    let unused = declarations.iter().filter(|d| !read_by_engine(d) && !is_used(d));
    unused
        .map(|d| {
            let message = format!("{} `{}` is never used", d.word(), d.name.text);
            Diagnostic::warning(code::UNUSED, d.name.span, message)
        })
        .collect()
}

/// Calls `visit` on every name in an expression. A loop, not a recursion: the depth of a chain of
/// operators is the user's.
pub(super) fn each_name<'e>(expr: &'e Expr, visit: &mut impl FnMut(&'e str)) {
    let mut waiting = vec![expr];
    while let Some(expr) = waiting.pop() {
        match &expr.kind {
            ExprKind::Name(name) => visit(name),
            ExprKind::Call(_, args) | ExprKind::Vector(args) | ExprKind::List(args) => waiting.extend(args),
            ExprKind::Field(base, _) | ExprKind::Unary(_, base) => waiting.push(base),
            ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) => waiting.extend([&**a, &**b]),
            ExprKind::Number(_) | ExprKind::Bool(_) => {}
        }
    }
}

impl<'a> Checker<'a> {
    /// Enters the declarations above the system, then its own.
    pub(super) fn declare_names(&mut self, shared: &[Declaration<'a>]) {
        for declaration in shared {
            self.declare_name(*declaration);
        }
        let system: &'a syntax::System = self.system;
        for item in &system.items {
            match item {
                Item::Const(c) => self.declare_name(Declaration::of_const(c, true)),
                Item::Param(p) => self.declare_name(Declaration::of_param(p, true)),
                _ => {}
            }
        }
    }

    fn declare_name(&mut self, declaration: Declaration<'a>) {
        let name = declaration.name;
        self.reserved(name);
        if let Some(first) = self.names.find(&name.text).map(|i| self.names.declaration(i)) {
            if first.own == declaration.own {
                self.duplicate("declarations of", &name.text, name.span, first.name.span);
                return;
            }
            self.hides(name);
        }
        let index = self.names.entries.len();
        self.names.index.insert(&name.text, index);
        self.names.entries.push(Entry { declaration, state: State::Waiting, used: false });
    }

    /// Warns if a name that is being bound hides a const or param.
    pub(super) fn hides(&mut self, name: &Name) {
        let Some(hidden) = self.names.find(&name.text).map(|i| self.names.declaration(i)) else { return };
        let message = format!("`{}` hides the {} of that name", name.text, hidden.word());
        let warning = Diagnostic::warning(code::HIDDEN, name.span, message);
        self.report(warning.label(hidden.name.span, "it is declared here"));
    }

    /// Refuses words of the language as names.
    pub(super) fn reserved(&mut self, name: &Name) {
        const WORDS: [&str; 19] = [
            "system", "module", "const", "param", "query", "volume", "ignore", "template", "axiom", "rules",
            "place", "run", "eps", "let", "at", "on", "file", "with", "_",
        ];
        if WORDS.contains(&name.text.as_str()) || matches!(name.text.as_str(), "true" | "false") {
            let message = format!("`{}` is a word of the language and cannot be a name", name.text);
            self.report(Diagnostic::error(code::RESERVED, name.span, message));
        }
    }
}
