//! A system as it is written in its file, and what it sees of what stands around it.

use super::expression::{Constants, Declaration};
use super::value::Value;
use burgeon::language::syntax::{
    AxiomKind, FileItem, Item, Name, Query, Rule, RuleFile, Rules, Step, System,
};

pub struct Written<'a> {
    pub system: &'a System,
    /// Consts and params above the system.
    outer: Vec<Declaration<'a>>,
}

impl<'a> Written<'a> {
    /// The system of that name, or the last one.
    pub fn new(file: &'a RuleFile, name: Option<&str>) -> Written<'a> {
        let wanted = |item: &FileItem| match item {
            FileItem::System(system) => name.is_none_or(|n| n == system.name.text),
            _ => false,
        };
        let index = file.items.iter().rposition(wanted).expect("a system of that name");
        let FileItem::System(system) = &file.items[index] else { unreachable!() };
        let outer = file.items[..index]
            .iter()
            .filter_map(|item| match item {
                FileItem::Const(c) => Some(Declaration::Const(c)),
                FileItem::Param(p) => Some(Declaration::Param(p)),
                FileItem::System(_) => None,
            })
            .collect();
        Written { system, outer }
    }

    /// The values of consts and params, these with what the host sets.
    pub fn constants(&self, overrides: &[(String, Value)]) -> Constants {
        let inner: Vec<Declaration> = self
            .system
            .items
            .iter()
            .filter_map(|item| match item {
                Item::Const(c) => Some(Declaration::Const(c)),
                Item::Param(p) => Some(Declaration::Param(p)),
                _ => None,
            })
            .collect();
        Constants::default().extended(&self.outer, overrides).extended(&inner, overrides)
    }

    /// The types of a symbol's fields, if a `module` line declares it.
    pub fn declared(&self, symbol: &str) -> Option<Vec<&'a str>> {
        let declarations = self.system.items.iter().flat_map(|item| match item {
            Item::Modules(declarations) => declarations.as_slice(),
            _ => &[],
        });
        let mut found = declarations.filter(|d| d.symbol.text == symbol);
        Some(found.next()?.fields.iter().map(|f| f.ty.text.as_str()).collect())
    }

    /// The types of a declared symbol's fields.
    pub fn fields(&self, symbol: &str) -> Vec<&'a str> {
        self.declared(symbol).unwrap_or_else(|| panic!("`{symbol}` is not declared"))
    }

    pub fn query(&self, name: &str) -> &'a Query {
        let mut queries = self.system.items.iter().filter_map(|item| match item {
            Item::Query(query) => Some(query),
            _ => None,
        });
        queries.find(|q| q.name.text == name).expect("a query of that name")
    }

    /// The rules that run under `with a, b`, each with its index in its group: a's, then b's; the
    /// unnamed group's without names.
    pub fn rules(&self, groups: &[Name]) -> Vec<(usize, &'a Rule)> {
        let all = self.system.items.iter().filter_map(|item| match item {
            Item::Rules(rules) => Some(rules),
            _ => None,
        });
        let all: Vec<&Rules> = all.collect();
        let named = |name: Option<&str>| {
            let group = |rules: &&&Rules| rules.group.as_ref().map(|g| g.text.as_str()) == name;
            all.iter().filter(group).copied().collect::<Vec<_>>()
        };
        let chosen = if groups.is_empty() {
            named(None)
        } else {
            groups.iter().flat_map(|g| named(Some(&g.text))).collect()
        };
        chosen.into_iter().flat_map(|rules| rules.rules.iter().enumerate()).collect()
    }

    pub fn axiom(&self) -> Option<&'a AxiomKind> {
        self.system.items.iter().find_map(|item| match item {
            Item::Axiom(axiom) => Some(&axiom.kind),
            _ => None,
        })
    }

    /// The steps of `run:`, if there is one.
    pub fn run(&self) -> Option<&'a [Step]> {
        self.system.items.iter().find_map(|item| match item {
            Item::Run(run) => Some(run.steps.as_slice()),
            _ => None,
        })
    }
}
