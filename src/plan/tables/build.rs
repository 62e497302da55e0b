//! Rules of a checked system as matching rules and productions, block by block.

use super::{MatchRule, Production, RuleSet, RulesOf, Stage, Successor, Symbol, fnv};
use crate::language::Span;
use crate::language::expr::{Expr, ExprKind, Type};
use crate::language::system::{self, BinderPlace, Field, Hang, Rule, System};
use crate::plan::context::{self, Search};
use crate::plan::layout::Layout;
use crate::plan::supported::{self, Unsupported};
use crate::plan::turtle;

/// A block that waits for the next stage, under its hidden symbol.
pub(super) struct Pending {
    symbol: usize,
    block: system::Block,
}

pub(super) struct Builder<'a> {
    pub(super) system: &'a System,
    /// Where parameters begin.
    pub(super) layout: Layout,
    pub(super) symbols: Vec<Symbol>,
    pub(super) pending: Vec<Pending>,
    pub(super) searches: Vec<Search>,
}

impl Builder<'_> {
    pub(super) fn add_symbol(&mut self, name: String, fields: Vec<Field>, hidden: bool) -> usize {
        let mut at = self.layout.header_words;
        let words = fields
            .iter()
            .map(|f| {
                at += f.ty.words();
                at - f.ty.words()
            })
            .collect();
        self.symbols.push(Symbol { name, fields, words, hidden });
        self.symbols.len() - 1
    }

    pub(super) fn rule_set(&mut self, of: RulesOf) -> Result<RuleSet, Unsupported> {
        let groups = match &of {
            RulesOf::Groups(groups) => groups,
            RulesOf::Trace(into) => {
                let rules = turtle::rules(self.system, &self.symbols, *into);
                let stage = Stage { roots: true, ..Stage::new(rules, true, true) };
                return Ok(RuleSet { of, stages: vec![stage] });
            }
        };
        let mut rules = Vec::new();
        for &g in groups {
            for rule in &self.system.groups[g].rules {
                supported::rule(rule, self.system)?;
                rules.push(self.rule(rule)?);
            }
        }
        let curve = self.layout.is_curve();
        let mut stages = vec![Stage::new(rules, true, curve)];
        while !self.pending.is_empty() {
            let waiting = std::mem::take(&mut self.pending);
            let rules = waiting.into_iter().map(|p| self.split_pending(p)).collect();
            stages.push(Stage::new(rules, false, curve));
        }
        Ok(RuleSet { of, stages })
    }

    fn rule(&mut self, rule: &Rule) -> Result<(MatchRule, Vec<Production>), Unsupported> {
        let predecessor = rule.strict[0];
        let around = context::surroundings(rule, self.system, &self.symbols, &mut self.searches);
        let own = self.symbols[predecessor].fields.len();
        let places: Vec<Option<usize>> =
            around.binders.iter().map(|read| read.map(|read| own + read)).collect();
        let resolve = |e: &Expr| by_field(e, rule, self.system, &places);

        let mut productions = Vec::new();
        for alternative in &rule.alternatives {
            let (mut exit, mut relabels) = (None, false);
            let (halves, cells) = match &alternative.successor {
                system::Successor::Erase => (0, vec![None; 4]),
                system::Successor::Relabel(m) => (0, vec![Some(successor(m, &resolve)), None, None, None]),
                system::Successor::Split(b) => self.block(predecessor, b, &resolve),
                system::Successor::Word(word) => {
                    exit = word.exit();
                    relabels = matches!(word.hangs[..], [Hang { lateral: false, .. }]) && word.slots == 1;
                    let modules = word.modules.iter().zip(&word.hangs);
                    (
                        0,
                        modules
                            .map(|(m, &hang)| Some(Successor { hang, ..successor(m, &resolve) }))
                            .collect(),
                    )
                }
                // They are refused.
                system::Successor::Surface(_) | system::Successor::Face(_) => (0, Vec::new()),
            };
            let length = rule.strict.len() as u32;
            let span = rule.span;
            productions.push(Production {
                rule: 0,
                predecessor,
                length,
                halves,
                cells,
                exit,
                relabels,
                span,
            });
        }
        let matching = MatchRule {
            predecessor,
            others: rule.strict[1..].to_vec(),
            context: around.context,
            reads: around.reads,
            lets: rule.lets.iter().map(|l| resolve(&l.value)).collect(),
            guards: rule.tests.iter().chain(&rule.condition).map(resolve).collect(),
            weights: rule.alternatives.iter().filter_map(|a| a.weight.as_ref()).map(resolve).collect(),
            productions: 0..0,
            site: site(rule),
            span: rule.span,
        };
        Ok((matching, productions))
    }

    /// The cells of a block. A block inside it becomes a pending module with the predecessor's
    /// parameters, since its expressions read these; what they read besides, and a pending module
    /// has not (attributes, lets, random numbers), is worked out now and carried along.
    fn block(
        &mut self,
        predecessor: usize,
        block: &system::Block,
        resolve: &dyn Fn(&Expr) -> Expr,
    ) -> (u32, Vec<Option<Successor>>) {
        let halves = (block.rows == 2) as u32 | ((block.columns == 2) as u32) << 1;
        let mut cells: Vec<Option<Successor>> = vec![None; 4];
        for (n, cell) in block.cells.iter().enumerate() {
            let (row, column) = (n / block.columns, n % block.columns);
            cells[2 * row + column] = match cell {
                system::Cell::Eps => None,
                system::Cell::Module(m) => Some(successor(m, resolve)),
                system::Cell::Block(inner) => {
                    let inner = map_block(inner, &mut |e| resolve(e));
                    let mut fields = self.symbols[predecessor].fields.clone();
                    let mut args: Vec<Expr> =
                        (0..fields.len()).map(|f| field(f, &fields[f].ty, inner.span)).collect();
                    let own = fields.len();
                    let inner = map_block(&inner, &mut |e| carried(e, own, &mut fields, &mut args));
                    let name = format!("{}'{}", self.symbols[predecessor].name, self.symbols.len());
                    let symbol = self.add_symbol(name, fields, true);
                    self.pending.push(Pending { symbol, block: inner });
                    Some(Successor { symbol, args, hang: Hang::default() })
                }
            };
        }
        (halves, cells)
    }

    fn split_pending(&mut self, pending: Pending) -> (MatchRule, Vec<Production>) {
        let Pending { symbol, block } = pending;
        let span = block.span;
        let (halves, cells) = self.block(symbol, &block, &|e| e.clone());
        let rule = MatchRule {
            predecessor: symbol,
            others: Vec::new(),
            context: Vec::new(),
            reads: Vec::new(),
            lets: Vec::new(),
            guards: Vec::new(),
            weights: Vec::new(),
            productions: 0..0,
            site: 0,
            span,
        };
        let production = Production {
            rule: 0,
            predecessor: symbol,
            length: 1,
            halves,
            cells,
            exit: None,
            relabels: false,
            span,
        };
        (rule, vec![production])
    }
}

/// An argument of a cell inside a nested block: itself, if a pending module can work it out, else
/// a field that carries it.
fn carried(e: &Expr, own: usize, fields: &mut Vec<Field>, args: &mut Vec<Expr>) -> Expr {
    let mut stays = true;
    e.walk(&mut |e| {
        stays &= match &e.kind {
            ExprKind::Attribute(name) => *name == "step",
            ExprKind::Let(_) | ExprKind::Random { .. } => false,
            _ => true,
        }
    });
    if stays {
        return e.clone();
    }
    let known = args[own..].iter().position(|a| a == e);
    let at = known.map_or(fields.len(), |n| own + n);
    if known.is_none() {
        fields.push(Field { name: "carried".to_string(), ty: e.ty.clone() });
        args.push(e.clone());
    }
    field(at, &e.ty, e.span)
}

/// Identifies the rule for random numbers: its label, or its index in the group, hashed.
fn site(rule: &Rule) -> u32 {
    let index = (rule.index as u32).to_le_bytes();
    fnv(rule.label.as_ref().map_or(&index[..], |label| label.as_bytes()))
}

fn successor(module: &system::Module, resolve: &dyn Fn(&Expr) -> Expr) -> Successor {
    let args = module.args.iter().map(resolve).collect();
    Successor { symbol: module.symbol, args, hang: Hang::default() }
}

/// In the tables, binder n is field n of the predecessor.
fn field(n: usize, ty: &Type, span: Span) -> Expr {
    Expr { ty: ty.clone(), kind: ExprKind::Binder(n), span }
}

/// Binders as the fields that they stand for: `places` says which of those behind the predecessor's own.
fn by_field(e: &Expr, rule: &Rule, system: &System, places: &[Option<usize>]) -> Expr {
    map_expr(e, &|e| match e.kind {
        ExprKind::Binder(b) => match rule.binders[b].place {
            BinderPlace::Strict { module: 0, field: f } => Some(field(f, &e.ty, e.span)),
            // Its value is measured or given before anything is matched, so every place where it is
            // read sees the same.
            BinderPlace::Query(n) => {
                let query = rule.queries[n].query;
                let free = ExprKind::OfRoot(query);
                Some(match &system.queries[query].value {
                    Some(value) => value.clone(),
                    None => Expr { ty: e.ty.clone(), kind: free, span: e.span },
                })
            }
            BinderPlace::Strict { .. } | BinderPlace::Left { .. } | BinderPlace::Right { .. } => {
                places[b].map(|place| field(place, &e.ty, e.span))
            }
            // Only meshes have tags.
            BinderPlace::Tag { .. } => None,
        },
        _ => None,
    })
}

/// Rebuilds an expression, `replace` first.
fn map_expr(e: &Expr, replace: &dyn Fn(&Expr) -> Option<Expr>) -> Expr {
    if let Some(new) = replace(e) {
        return new;
    }
    let one = |e: &Expr| Box::new(map_expr(e, replace));
    let all = |list: &[Expr]| list.iter().map(|e| map_expr(e, replace)).collect();
    let kind = match &e.kind {
        ExprKind::Call(op, args) => ExprKind::Call(*op, all(args)),
        ExprKind::Vector(parts) => ExprKind::Vector(all(parts)),
        ExprKind::Component(v, n) => ExprKind::Component(one(v), *n),
        ExprKind::Element(list, index) => ExprKind::Element(list.clone(), one(index)),
        ExprKind::Sample(query, point) => ExprKind::Sample(*query, one(point)),
        ExprKind::Random { function, args, site } => {
            ExprKind::Random { function, args: all(args), site: *site }
        }
        leaf => leaf.clone(),
    };
    Expr { ty: e.ty.clone(), kind, span: e.span }
}

fn map_block(block: &system::Block, map: &mut dyn FnMut(&Expr) -> Expr) -> system::Block {
    let mut cells = Vec::with_capacity(block.cells.len());
    for cell in &block.cells {
        cells.push(match cell {
            system::Cell::Eps => system::Cell::Eps,
            system::Cell::Module(m) => {
                let args = m.args.iter().map(&mut *map).collect();
                system::Cell::Module(system::Module { args, ..m.clone() })
            }
            system::Cell::Block(b) => system::Cell::Block(map_block(b, map)),
        });
    }
    system::Block { cells, ..*block }
}
