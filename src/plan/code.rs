//! The rules' expressions as graphs, ready for either backend.

use super::context::{Near, Place, Search};
use super::graph::{Constants, Graph, Names, NodeId, Subject};
use super::layout::Layout;
use super::tables::{Becomes, Environment, MatchRule, Production, Stage, Symbol};
use crate::language::expr::Expr;

/// When a rule fires, and on which of its productions.
#[derive(Clone, Debug, Default)]
pub struct RuleCode {
    pub graph: Graph,
    /// All must be true.
    pub guards: Vec<NodeId>,
    /// Which of its productions is drawn, counted from 0; absent where it has one.
    pub choice: Option<NodeId>,
    /// For each production that rewrites a symbol to itself: (node, word of the record); where all
    /// are equal, bit by bit, nothing fires.
    pub unchanged: Vec<Option<Vec<(NodeId, usize)>>>,
}

/// The parameters of a production's children.
#[derive(Clone, Debug, Default)]
pub struct ChildCode {
    pub graph: Graph,
    /// For each cell: (node, word of the child's record). Of curves the path is among them.
    pub args: Vec<Vec<(NodeId, usize)>>,
}

/// The code of a stage.
#[derive(Clone, Debug, Default)]
pub struct StageCode {
    /// For each rule.
    pub rules: Vec<RuleCode>,
    /// For each production.
    pub children: Vec<ChildCode>,
    /// What stands in the environment behind the uniforms.
    pub constants: Constants,
}

impl StageCode {
    /// The code of a stage whose row of attributes is known.
    pub fn new(
        stage: &Stage,
        symbols: &[Symbol],
        searches: &[Search],
        environment: &Environment,
        layout: &Layout,
    ) -> StageCode {
        let base = environment.given.end(environment.queries.len());
        let mut constants = Constants { base, words: Vec::new() };
        let mut code = StageCode::default();
        for rule in &stage.rules {
            let mut lower = Lower::new(stage, rule, (symbols, searches), environment, layout, &mut constants);
            let linked = layout.link.is_some();
            let mut guards: Vec<NodeId> = rule.context.iter().map(|near| lower.near(near)).collect();
            if !rule.others.is_empty() && !linked {
                // Never across the start of a ring.
                guards.push(lower.graph.has_behind(rule.others.len() as u32 + 1));
            }
            guards.extend(rule.guards.iter().map(|g| lower.expr(g)[0]));
            let choice = lower.choice(rule).map(|(any, index)| {
                guards.push(any);
                index
            });
            let productions = &stage.productions[rule.productions.clone()];
            let unchanged = productions.iter().map(|p| lower.unchanged(p, symbols)).collect();
            code.rules.push(RuleCode { graph: lower.graph, guards, choice, unchanged });
        }
        for production in &stage.productions {
            let rule = &stage.rules[production.rule];
            let mut lower = Lower::new(stage, rule, (symbols, searches), environment, layout, &mut constants);
            let mut args = Vec::with_capacity(production.cells());
            for cell in 0..production.cells() {
                let Some(cell) = production.successor(cell) else {
                    args.push(Vec::new());
                    continue;
                };
                let mut words = lower.path(stage, production, cell.hang.slot, layout);
                words.extend(layout.word.map(|word| (lower.graph.word_of(word), word)));
                words.extend(layout.link.map(|word| (lower.graph.link(&cell.hang), word)));
                words.extend(lower.args(&cell.args, &symbols[cell.symbol]));
                args.push(words);
            }
            code.children.push(ChildCode { graph: lower.graph, args });
        }
        let rules = code.rules.iter_mut().map(|r| &mut r.graph);
        rules.chain(code.children.iter_mut().map(|c| &mut c.graph)).for_each(|g| g.settle(&mut constants));
        code.constants = constants;
        code
    }
}

struct Lower<'a> {
    graph: Graph,
    names: Names<'a>,
}

impl<'a> Lower<'a> {
    fn new(
        stage: &'a Stage,
        rule: &'a MatchRule,
        (symbols, searches): (&'a [Symbol], &'a [Search]),
        environment: &'a Environment,
        layout: &Layout,
        constants: &'a mut Constants,
    ) -> Self {
        let own = symbols[rule.predecessor].words.iter().map(|&at| (Place::Strict(0), at));
        let fields = own.chain(rule.reads.iter().copied()).collect();
        let mut lower = Lower {
            graph: Graph::default(),
            names: Names {
                fields,
                linked: layout.link.is_some(),
                word: layout.word,
                searches,
                environment,
                subject: Subject::Module(&stage.row),
                path: layout.identity.to_vec(),
                lets: Vec::new(),
                site: rule.site,
                constants,
            },
        };
        for value in &rule.lets {
            let value = lower.expr(value);
            lower.names.lets.push(value);
        }
        lower
    }

    /// The words of a child's path, where curves have one: a module that replaces its predecessor keeps it.
    fn path(
        &mut self,
        stage: &Stage,
        production: &Production,
        slot: u32,
        layout: &Layout,
    ) -> Vec<(NodeId, usize)> {
        if !layout.paths {
            return Vec::new();
        }
        let path = match production.becomes {
            _ if stage.roots => self.graph.root_path(slot),
            Becomes::Word { relabels: true, .. } => self.graph.path(),
            _ => self.graph.child_path(slot),
        };
        path.into_iter().zip(1..).collect()
    }

    /// Whether the symbol that a context asks for stands in its place.
    fn near(&mut self, near: &Near) -> NodeId {
        self.graph.near(near, &self.names)
    }

    fn expr(&mut self, e: &Expr) -> Vec<NodeId> {
        self.graph.lower(e, &mut self.names)
    }

    /// Whether any weight is positive, and the index drawn.
    fn choice(&mut self, rule: &MatchRule) -> Option<(NodeId, NodeId)> {
        if rule.weights.is_empty() {
            return None;
        }
        let weights: Vec<NodeId> = rule.weights.iter().map(|w| self.expr(w)[0]).collect();
        Some(self.graph.choice(&weights, &self.names))
    }

    /// (node, word of the record) of a module's arguments.
    fn args(&mut self, args: &[Expr], symbol: &Symbol) -> Vec<(NodeId, usize)> {
        let mut list = Vec::new();
        for (arg, &at) in args.iter().zip(&symbol.words) {
            list.extend(self.expr(arg).into_iter().enumerate().map(|(n, node)| (node, at + n)));
        }
        list
    }

    fn unchanged(&mut self, production: &Production, symbols: &[Symbol]) -> Option<Vec<(NodeId, usize)>> {
        let cell = production.successor(0).filter(|_| production.relabels_itself())?;
        Some(self.args(&cell.args, &symbols[cell.symbol]))
    }
}
