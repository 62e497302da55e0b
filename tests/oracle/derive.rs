//! The derivation: the axiom, the schedule and one step, as the requirement words them.

use super::attributes::attribute;
use super::expression::{Constants, Scope, evaluate};
use super::halving::Net;
use super::pattern::{bind, match_args};
use super::value::Value;
use super::word::{Module, Param, Shape, Turn, Word};
use super::written::Written;
use burgeon::language::syntax::{
    AttributeKind, AxiomKind, Block, Cell, DeriveCount, Element, Expr, ModuleUse, Name, Rule, RuleFile,
    Source, SourceKind, Start, Step, StepKind, Successor,
};
use std::rc::Rc;

/// A patch system with all that stands around it, ready to be derived.
pub struct Oracle<'a> {
    written: Written<'a>,
    /// The nets of a file, in homogeneous coordinates.
    nets: &'a dyn Fn(&str) -> Vec<Net>,
    overrides: Vec<(String, Value)>,
    steps: Option<usize>,
    modules: Option<usize>,
    halvings: Option<u32>,
}

/// Why a derivation ends before its schedule does.
enum Stop {
    /// The limit of steps is reached.
    Steps,
    /// A word would have outgrown the bounds.
    Growth,
}

impl<'a> Oracle<'a> {
    /// The system of that name, or the last one.
    pub fn new(file: &'a RuleFile, name: Option<&str>, nets: &'a dyn Fn(&str) -> Vec<Net>) -> Oracle<'a> {
        let written = Written::new(file, name);
        Oracle { written, nets, overrides: Vec::new(), steps: None, modules: None, halvings: None }
    }

    /// Gives a param another value.
    pub fn set(mut self, name: &str, value: Param) -> Self {
        self.overrides.push((name.to_string(), value.value()));
        self
    }

    /// Stops after so many steps in all, as `--steps` does.
    pub fn steps(mut self, limit: Option<usize>) -> Self {
        self.steps = limit;
        self
    }

    /// Gives up when a word has more modules, or a module more halvings along u or v.
    pub fn bounds(mut self, modules: usize, halvings: u32) -> Self {
        self.modules = Some(modules);
        self.halvings = Some(halvings);
        self
    }

    /// The word after every step; index 0 is the axiom.
    pub fn derive(&self) -> Vec<Word> {
        self.derive_within().expect("a derivation within its bounds")
    }

    /// As [`derive`](Self::derive); `None` if a bound was passed.
    pub fn derive_within(&self) -> Option<Vec<Word>> {
        let constants = self.written.constants(&self.overrides);
        let mut run = Derivation { oracle: self, constants: &constants, words: vec![self.axiom(&constants)] };
        match run.schedule() {
            Ok(()) | Err(Stop::Steps) => Some(run.words),
            Err(Stop::Growth) => None,
        }
    }

    /// Degrees along u and v, from `bezier m [n]`.
    fn degree(&self) -> [usize; 2] {
        let written = self.written.system.attributes.iter().find_map(|a| match &a.kind {
            AttributeKind::Bezier(u, v) => Some((u, v.as_ref().unwrap_or(u))),
            _ => None,
        });
        let (u, v) = written.expect("`bezier` is needed");
        [u, v].map(|n| n.text.parse().expect("a degree"))
    }

    fn rational(&self) -> bool {
        self.written.system.attributes.iter().any(|a| a.kind == AttributeKind::Rational)
    }

    /// Every net of every source is one root.
    fn axiom(&self, constants: &Constants) -> Word {
        let starts: &[Start] = match self.written.axiom() {
            None => &[],
            Some(AxiomKind::Starts(starts)) => starts,
            Some(other) => panic!("no axiom of a patch system: {other:?}"),
        };
        let scope = Scope { bound: Vec::new(), constants, attributes: &|_| None, random: None };
        let mut modules: Vec<Module> = Vec::new();
        for start in starts {
            let params = self.params(&start.module, &scope);
            for net in self.source(&start.source, &scope) {
                assert_eq!(net.degree, self.degree(), "the degree of a net of the axiom");
                modules.push(Module {
                    symbol: start.module.symbol.text.clone(),
                    params: params.clone(),
                    root: modules.len(),
                    path: Vec::new(),
                    net: Rc::new(net),
                });
            }
        }
        let roots = Rc::new(modules.iter().map(|m| m.net.clone()).collect());
        Word { modules, roots }
    }

    fn source(&self, source: &Source, scope: &Scope) -> Vec<Net> {
        match &source.kind {
            SourceKind::File(path, None) => (self.nets)(&path.text),
            SourceKind::File(path, Some(index)) => {
                let index: usize = index.text.parse().expect("an index");
                vec![(self.nets)(&path.text).swap_remove(index)]
            }
            SourceKind::List(list) => vec![self.inline(list, scope)],
            SourceKind::Named(name, _) => panic!("the oracle does not know the source `{}`", name.text),
        }
    }

    /// A list of rows of points: (x, y), (x, y, z) or, with a weight, (x, y, z, w).
    fn inline(&self, list: &Expr, scope: &Scope) -> Net {
        let Value::List(rows) = evaluate(list, scope) else { panic!("a list of rows") };
        let point = |value: Value| match *value.vector().as_slice() {
            [x, y] => [x, y, 0.0, 1.0],
            [x, y, z] => [x, y, z, 1.0],
            // Like a file, a rule file holds Euclidean points and a weight.
            [x, y, z, w] => [x * w, y * w, z * w, w],
            _ => unreachable!(),
        };
        let row = |value: Value| match value {
            Value::List(points) => points.into_iter().map(point).collect::<Vec<_>>(),
            other => panic!("{other:?} is no row of points"),
        };
        Net::new(self.degree(), rows.into_iter().flat_map(row).collect())
    }

    /// The parameters of a module of a successor or of the axiom, in the types of its fields.
    fn params(&self, module: &ModuleUse, scope: &Scope) -> Vec<Param> {
        let types = self.written.fields(&module.symbol.text);
        let args = module.args.as_deref().unwrap_or(&[]);
        assert_eq!(args.len(), types.len(), "arguments of `{}`", module.symbol.text);
        types.iter().zip(args).map(|(ty, arg)| Param::new(evaluate(arg, scope).coerce(ty))).collect()
    }
}

/// A derivation under way.
struct Derivation<'a> {
    oracle: &'a Oracle<'a>,
    constants: &'a Constants,
    /// The axiom and the word after every step so far.
    words: Vec<Word>,
}

impl Derivation<'_> {
    fn schedule(&mut self) -> Result<(), Stop> {
        match self.oracle.written.run() {
            Some(steps) => self.steps(steps),
            None => self.derive(1, false, &[]),
        }
    }

    fn steps(&mut self, steps: &[Step]) -> Result<(), Stop> {
        steps.iter().try_for_each(|step| self.step(&step.kind))
    }

    fn step(&mut self, step: &StepKind) -> Result<(), Stop> {
        match step {
            StepKind::Derive { count: DeriveCount::Steps(count), groups } => {
                let count = self.host(count).int();
                self.derive(count, false, groups)
            }
            StepKind::Derive { count: DeriveCount::UntilTerminal { max }, groups } => {
                let max = self.host(max.as_ref().expect("`until terminal` needs `max`")).int();
                self.derive(max, true, groups)
            }
            StepKind::Repeat { count, body } => {
                let count = self.host(count).int();
                (0..count).try_for_each(|_| self.steps(body))
            }
            StepKind::If { condition, body } => {
                if self.host(condition).bool() {
                    self.steps(body)
                } else {
                    Ok(())
                }
            }
            other => panic!("no step of a patch system: {other:?}"),
        }
    }

    /// An expression over consts and params.
    fn host(&self, expr: &Expr) -> Value {
        evaluate(
            expr,
            &Scope { bound: Vec::new(), constants: self.constants, attributes: &|_| None, random: None },
        )
    }

    fn derive(&mut self, count: i32, until_terminal: bool, groups: &[Name]) -> Result<(), Stop> {
        let rules: Vec<&Rule> = self.oracle.written.rules(groups).into_iter().map(|(_, rule)| rule).collect();
        for step in 0..count {
            if self.oracle.steps.is_some_and(|limit| self.words.len() > limit) {
                return Err(Stop::Steps);
            }
            let (word, fired) = self.rewrite(&rules, step as usize)?;
            if until_terminal && !fired {
                // The idle step that ends it is neither counted nor listed.
                break;
            }
            self.words.push(word);
        }
        Ok(())
    }

    /// One parallel rewriting of the last word; and whether anything fired.
    fn rewrite(&self, rules: &[&Rule], step: usize) -> Result<(Word, bool), Stop> {
        let old = self.words.last().expect("the axiom");
        let mut modules = Vec::new();
        let mut fired = false;
        for module in &old.modules {
            let before = modules.len();
            self.rewrite_module(module, rules, step, &mut modules);
            self.check_growth(modules.len(), &modules[before..])?;
            // A successor that is the module itself, bit by bit, does not count as fired.
            fired |= !matches!(&modules[before..], [only] if is_kept(module, only));
        }
        Ok((Word { modules, roots: old.roots.clone() }, fired))
    }

    fn check_growth(&self, count: usize, new: &[Module]) -> Result<(), Stop> {
        let too_many = self.oracle.modules.is_some_and(|bound| count > bound);
        let too_deep = |module: &Module| self.oracle.halvings.is_some_and(|bound| module.level() > bound);
        if too_many || new.iter().any(too_deep) { Err(Stop::Growth) } else { Ok(()) }
    }

    /// Appends what stands for `module` after the step.
    fn rewrite_module(&self, module: &Module, rules: &[&Rule], step: usize, out: &mut Vec<Module>) {
        let rational = self.oracle.rational();
        let attributes = |name: &str| attribute(name, module, step, rational);
        for rule in rules {
            let mut scope =
                Scope { bound: Vec::new(), constants: self.constants, attributes: &attributes, random: None };
            if self.matches(rule, module, &mut scope) {
                return self.succeed(rule, module, &scope, out);
            }
        }
        out.push(module.clone());
    }

    /// Whether the rule fires on the module; then `scope` holds the names that it binds.
    fn matches(&self, rule: &Rule, module: &Module, scope: &mut Scope) -> bool {
        let predecessor = &rule.predecessor;
        assert!(predecessor.left.is_none() && predecessor.right.is_none(), "contexts are reserved");
        let [pattern] = predecessor.strict.as_slice() else { panic!("one strict predecessor") };
        assert!(pattern.tag.is_none(), "tags are of mesh systems");
        if pattern.symbol.text != module.symbol {
            return false;
        }
        for used in &predecessor.queries {
            let query = self.oracle.written.query(&used.query.text);
            let expr = query.value.as_ref().expect("host-bound queries are not the oracle's");
            // A query reads consts and attributes, never what the rule binds.
            let free = Scope { bound: Vec::new(), ..*scope };
            let value = evaluate(expr, &free).coerce(&query.field.ty.text);
            if !bind(&used.binder.text, value, scope) {
                return false;
            }
        }
        if !match_args(pattern, &module.params, scope) {
            return false;
        }
        for (name, expr) in &rule.lets {
            let value = evaluate(expr, scope).settle();
            scope.bound.push((name.text.clone(), value));
        }
        rule.condition.as_ref().is_none_or(|condition| evaluate(condition, scope).bool())
    }

    fn succeed(&self, rule: &Rule, module: &Module, scope: &Scope, out: &mut Vec<Module>) {
        let [alternative] = rule.alternatives.as_slice() else { panic!("the oracle draws no lots") };
        assert!(alternative.weight.is_none(), "the oracle draws no lots");
        let Successor::Word(elements) = &alternative.successor else { panic!("a template") };
        match elements.as_slice() {
            [Element::Eps(_)] => {}
            [Element::Module(successor)] => out.push(self.relabelled(module, successor, scope)),
            [Element::Block(block)] => self.split(block, module, scope, out),
            other => panic!("one block, one module or eps: {other:?}"),
        }
    }

    fn relabelled(&self, module: &Module, successor: &ModuleUse, scope: &Scope) -> Module {
        let params = self.oracle.params(successor, scope);
        Module { symbol: successor.symbol.text.clone(), params, ..module.clone() }
    }

    /// The cells of a block, row by row; a nested block splits the part where it stands.
    fn split(&self, block: &Block, whole: &Module, scope: &Scope, out: &mut Vec<Module>) {
        let shape = match (block.rows.len(), block.rows[0].len()) {
            (2, 2) => Shape::Both,
            (1, 2) => Shape::Columns,
            (2, 1) => Shape::Rows,
            other => panic!("a block of {other:?}"),
        };
        for (row, cells) in block.rows.iter().enumerate() {
            for (column, cell) in cells.iter().enumerate() {
                let part = || part_of(whole, Turn { shape, row, column });
                match cell {
                    Cell::Eps(_) => {}
                    Cell::Module(successor) => out.push(self.relabelled(&part(), successor, scope)),
                    Cell::Block(inner) => self.split(inner, &part(), scope, out),
                }
            }
        }
    }
}

/// Whether the one successor of a module is the module itself. Its net is, if its path is.
fn is_kept(old: &Module, new: &Module) -> bool {
    old.symbol == new.symbol && old.params == new.params && old.path == new.path
}

/// The same module on one cell of a block.
fn part_of(whole: &Module, turn: Turn) -> Module {
    let (u, v) = turn.parts();
    let mut path = whole.path.clone();
    path.push(turn);
    Module { path, net: Rc::new(whole.net.child(u, v)), ..whole.clone() }
}
