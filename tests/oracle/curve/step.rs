//! The schedule and one step, as the requirement words them.

use super::super::expression::{Constants, Scope, evaluate, random_calls};
use super::super::lots;
use super::super::pattern::bind;
use super::super::value::Value;
use super::super::word::Param;
use super::context::Surroundings;
use super::derive::{Oracle, in_field, number_roots};
use super::turtle;
use super::word::{Module, Token, Topology, Word};
use burgeon::language::syntax::{DeriveCount, Element, Expr, Field, Name, Rule, Step, StepKind, Successor};
use std::cell::RefCell;
use std::collections::BTreeSet;

/// A derivation under way.
pub struct Derivation<'a> {
    pub oracle: &'a Oracle<'a>,
    pub constants: &'a Constants,
    pub seed: u32,
    /// The axiom and the word after every step so far.
    pub words: Vec<Word>,
    /// The rules that have fired, by their place in the text.
    pub fired: RefCell<BTreeSet<u32>>,
}

/// Why a derivation ends before its schedule does.
enum Stop {
    /// The limit of steps is reached.
    Steps,
    /// A word has outgrown the bound.
    Growth,
}

/// A rule and its index in its group.
type Numbered<'r> = (usize, &'r Rule);

impl Derivation<'_> {
    /// All words, and the rules that fired; `None` if a word outgrew the bound.
    pub fn run(mut self) -> Option<(Vec<Word>, BTreeSet<u32>)> {
        let done = match self.oracle.written.run() {
            Some(steps) => self.steps(steps),
            None => self.derive(1, false, &[]),
        };
        match done {
            Ok(()) | Err(Stop::Steps) => Some((self.words, self.fired.into_inner())),
            Err(Stop::Growth) => None,
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
            StepKind::Trace { into } => self.trace(&into.text),
            other => panic!("no step of a curve system: {other:?}"),
        }
    }

    /// An expression over consts and params.
    fn host(&self, expr: &Expr) -> Value {
        let constants = self.constants;
        evaluate(expr, &Scope { bound: Vec::new(), constants, attributes: &|_| None, random: None })
    }

    fn derive(&mut self, count: i32, until_terminal: bool, groups: &[Name]) -> Result<(), Stop> {
        let rules = self.oracle.written.rules(groups);
        for step in 0..count {
            self.may_step()?;
            let (word, fired) = self.rewrite(&rules, step)?;
            if until_terminal && !fired {
                // The idle step that ends it is neither counted nor listed.
                break;
            }
            self.words.push(word);
        }
        Ok(())
    }

    fn may_step(&self) -> Result<(), Stop> {
        match self.oracle.steps {
            Some(limit) if self.words.len() > limit => Err(Stop::Steps),
            _ => Ok(()),
        }
    }

    fn last(&self) -> &Word {
        self.words.last().expect("the axiom")
    }

    /// The turtle's points, in place of the word; it counts as a step.
    fn trace(&mut self, into: &str) -> Result<(), Stop> {
        self.may_step()?;
        let declaration = self.oracle.declarations().find(|d| d.symbol.text == into);
        let fields = &declaration.expect("a module to trace into").fields;
        let is_vector = |field: &Field| field.ty.text.starts_with("vec");
        let position = fields.iter().position(is_vector).expect("a field for the position");
        let param = |index: usize, point: &turtle::Point| match fields[index].name.text.as_str() {
            _ if index == position => in_field(&point.position, &fields[index].ty.text),
            "r" => Param::Float(point.width),
            other => panic!("the turtle knows no `{other}`"),
        };
        let module = |point: turtle::Point| {
            let params = (0..fields.len()).map(|index| param(index, &point)).collect();
            Module { symbol: into.to_string(), params, path: [0; 2] }
        };
        let mut word = Word::new(self.oracle.topology, turtle::trace(self.last(), &module));
        number_roots(&mut word.tokens);
        self.words.push(word);
        Ok(())
    }

    /// One parallel rewriting of the last word; and whether anything fired.
    fn rewrite(&self, rules: &[Numbered], step: i32) -> Result<(Word, bool), Stop> {
        let old = self.last();
        let around = Surroundings::new(old, &self.oracle.ignored);
        let mut new = Vec::new();
        let mut fired = false;
        // The place in the string, and how many modules stand before it.
        let (mut at, mut index) = (0, 0);
        while let Some(token) = old.tokens.get(at) {
            let Token::Module(module) = token else {
                new.push(token.clone());
                at += 1;
                continue;
            };
            let fire = |(number, rule): &Numbered| {
                let length = rule.predecessor.strict.len();
                // Strict predecessors follow one another without a bracket, and not around a ring.
                let strict = old.tokens.get(at..at + length)?;
                let together = strict.iter().all(|token| matches!(token, Token::Module(_)));
                let new = together.then(|| self.fire(*number, rule, &around, index, step))??;
                Some((rule.span.start, length, new))
            };
            // At a position the first listed rule that matches wins; a leftover keeps itself.
            let (length, successor) = match rules.iter().find_map(fire) {
                // A successor that is the module itself, bit by bit, does not count as fired.
                Some((_, 1, successor)) if is_itself(&successor, module) => (1, vec![token.clone()]),
                Some((rule, length, successor)) => {
                    fired = true;
                    self.fired.borrow_mut().insert(rule);
                    (length, successor)
                }
                None => (1, vec![token.clone()]),
            };
            new.extend(successor);
            at += length;
            index += length;
            // Brackets and breaks are fewer than modules, but for those that vanish.
            if new.len() > self.oracle.bound.saturating_mul(8) {
                return Err(Stop::Growth);
            }
        }
        let word = Word::new(old.topology, new);
        if word.len() > self.oracle.bound { Err(Stop::Growth) } else { Ok((word, fired)) }
    }

    /// What the rule makes of the modules from `index` on, if it matches them.
    fn fire(
        &self,
        number: usize,
        rule: &Rule,
        around: &Surroundings,
        index: usize,
        step: i32,
    ) -> Option<Vec<Token>> {
        let path = around.modules[index].path;
        let site = lots::rule_site(rule.label.as_ref().map(|l| l.text.as_str()), number);
        let run_step = self.words.len() as u32 - 1;
        let draw = |call: u32| lots::draw(self.seed, run_step, path, site, call);
        let calls = calls(rule);
        // The index of a call is its place among all calls of the rule, in the order of the text.
        let random = |place: u32| draw(calls.iter().filter(|c| **c < place).count() as u32);
        let attributes = |name: &str| (name == "step").then_some(Value::Int(step));
        let constants = self.constants;
        let mut scope =
            Scope { bound: Vec::new(), constants, attributes: &attributes, random: Some(&random) };
        if !self.matches(rule, around, index, &mut scope) {
            return None;
        }
        let weights = rule.alternatives.iter().filter_map(|a| a.weight.as_ref());
        let weights: Vec<f64> = weights.map(|weight| evaluate(weight, &scope).float()).collect();
        let drawn = match weights.as_slice() {
            [] => 0,
            weights => lots::choice(weights, draw(lots::CHOICE))?,
        };
        let Successor::Word(word) = &rule.alternatives[drawn].successor else { panic!("a template") };
        Some(match word.as_slice() {
            // A relabelling changes nothing of the path.
            [Element::Module(_)] => self.oracle.word(word, &scope, &mut 0, &|_| path),
            _ => self.oracle.word(word, &scope, &mut 0, &|slot| lots::child(path, slot)),
        })
    }

    /// Whether the rule matches the modules from `index` on; then `scope` holds the names that it binds.
    fn matches(&self, rule: &Rule, around: &Surroundings, index: usize, scope: &mut Scope) -> bool {
        let predecessor = &rule.predecessor;
        // Cheap first: the symbols decide nearly always.
        let symbols = predecessor.strict.iter().zip(&around.modules[index..]);
        if symbols.into_iter().any(|(pattern, module)| pattern.symbol.text != module.symbol) {
            return false;
        }
        for used in &predecessor.queries {
            let query = self.oracle.written.query(&used.query.text);
            let expr = query.value.as_ref().expect("host-bound queries are not the oracle's");
            // A query reads consts and attributes, never what the rule binds, and draws nothing.
            let value = evaluate(expr, &Scope { bound: Vec::new(), random: None, ..*scope });
            if !bind(&used.binder.text, value.coerce(&query.field.ty.text), scope) {
                return false;
            }
        }
        let last = index + predecessor.strict.len() - 1;
        let left = predecessor.left.as_ref().is_none_or(|context| around.left(context, index, scope));
        if !left {
            return false;
        }
        let mut strict = predecessor.strict.iter().enumerate();
        if !strict.all(|(k, pattern)| around.fits(pattern, index + k, scope)) {
            return false;
        }
        let right = predecessor.right.as_ref().is_none_or(|context| around.right(context, last, scope));
        if !right {
            return false;
        }
        for (name, expr) in &rule.lets {
            let value = evaluate(expr, scope).settle();
            scope.bound.push((name.text.clone(), value));
        }
        rule.condition.as_ref().is_none_or(|condition| evaluate(condition, scope).bool())
    }
}

fn is_itself(successor: &[Token], module: &Module) -> bool {
    let same = |new: &Module| new.symbol == module.symbol && new.params == module.params;
    // Branches of nothing are nothing.
    let word = Word::new(Topology::Tree, successor.to_vec());
    matches!(&word.tokens[..], [Token::Module(new)] if same(new))
}

/// Where the calls of `rand` and `randn` stand that a rule makes.
fn calls(rule: &Rule) -> Vec<u32> {
    fn in_word(word: &[Element]) -> Vec<u32> {
        let in_element = |element: &Element| match element {
            Element::Module(used) => used.args.iter().flatten().flat_map(random_calls).collect(),
            Element::Branch(branch, _) => in_word(branch),
            Element::Eps(_) | Element::Block(_) => Vec::new(),
        };
        word.iter().flat_map(in_element).collect()
    }
    let mut calls: Vec<u32> = rule.lets.iter().flat_map(|(_, expr)| random_calls(expr)).collect();
    calls.extend(rule.condition.iter().flat_map(random_calls));
    for alternative in &rule.alternatives {
        calls.extend(alternative.weight.iter().flat_map(random_calls));
        if let Successor::Word(word) = &alternative.successor {
            calls.extend(in_word(word));
        }
    }
    calls
}
