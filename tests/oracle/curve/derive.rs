//! A curve system, ready to be derived, and its axiom.

use super::super::expression::{Constants, Scope, evaluate};
use super::super::lots::{self, Path};
use super::super::value::Value;
use super::super::word::Param;
use super::super::written::Written;
use super::step::Derivation;
use super::turtle;
use super::word::{Module, Token, Topology, Word};
use burgeon::language::syntax::{
    AttributeKind, AxiomKind, Element, Expr, ExprKind, FileItem, Item, Kind, ModuleDecl, ModuleUse, Rule,
    RuleFile, Source, SourceKind, Start,
};
use std::collections::BTreeSet;

/// The points of a file, of its curve of that index.
pub type Points<'a> = dyn Fn(&str, Option<u32>) -> Vec<Vec<f64>> + 'a;

/// A curve system with all that stands around it, ready to be derived.
pub struct Oracle<'a> {
    file: &'a RuleFile,
    pub(super) written: Written<'a>,
    pub(super) topology: Topology,
    pub(super) ignored: Vec<&'a str>,
    points: &'a Points<'a>,
    overrides: Vec<(String, Value)>,
    seed: Option<u32>,
    pub(super) steps: Option<usize>,
    pub(super) bound: usize,
}

impl<'a> Oracle<'a> {
    /// The system of that name, or the last one.
    pub fn new(file: &'a RuleFile, name: Option<&str>, points: &'a Points<'a>) -> Oracle<'a> {
        let written = Written::new(file, name);
        assert_eq!(written.system.kind, Kind::Curve, "the kind of `{}`", written.system.name.text);
        let topology = written.system.attributes.iter().find_map(|a| match a.kind {
            AttributeKind::Ring => Some(Topology::Ring),
            AttributeKind::Open => Some(Topology::Open),
            AttributeKind::Tree => Some(Topology::Tree),
            _ => None,
        });
        let ignored = written.system.items.iter().flat_map(|item| match item {
            Item::Ignore(symbols) => symbols.as_slice(),
            _ => &[],
        });
        Oracle {
            file,
            topology: topology.unwrap_or(Topology::Open),
            ignored: ignored.map(|name| name.text.as_str()).collect(),
            written,
            points,
            overrides: Vec::new(),
            seed: None,
            steps: None,
            bound: usize::MAX,
        }
    }

    /// Gives a param another value.
    pub fn set(mut self, name: &str, value: Param) -> Self {
        self.overrides.push((name.to_string(), value.value()));
        self
    }

    pub fn seed(mut self, seed: Option<u32>) -> Self {
        self.seed = seed;
        self
    }

    /// Stops after so many steps in all, as `--steps` does.
    pub fn steps(mut self, limit: Option<usize>) -> Self {
        self.steps = limit;
        self
    }

    /// Gives up when a word has more modules.
    pub fn bound(mut self, modules: usize) -> Self {
        self.bound = modules;
        self
    }

    /// The word after every step, index 0 the axiom; `None` if the bound was passed.
    pub fn derive_within(&self) -> Option<Vec<Word>> {
        Some(self.run()?.0)
    }

    /// The rules that fire at all.
    pub fn fired(&self) -> Vec<Rule> {
        let (_, fired) = self.run().expect("a derivation within its bound");
        let groups = self.written.system.items.iter().filter_map(|item| match item {
            Item::Rules(rules) => Some(&rules.rules),
            _ => None,
        });
        groups.flatten().filter(|rule| fired.contains(&rule.span.start)).cloned().collect()
    }

    fn run(&self) -> Option<(Vec<Word>, BTreeSet<u32>)> {
        let constants = self.written.constants(&self.overrides);
        let given = self.seed.or_else(|| constants.get("seed").map(|seed| seed.clone().int() as u32));
        let words = vec![Word::new(self.topology, self.axiom(&constants)?)];
        let (seed, fired) = (given.unwrap_or(0), Default::default());
        Derivation { oracle: self, constants: &constants, seed, words, fired }.run()
    }

    /// All that `module` lines declare.
    pub(super) fn declarations(&self) -> impl Iterator<Item = &'a ModuleDecl> + use<'a> {
        self.written.system.items.iter().flat_map(|item| match item {
            Item::Modules(declarations) => declarations.as_slice(),
            _ => &[],
        })
    }

    /// The types of a symbol's fields; those of the turtle are declared by nobody.
    fn fields(&self, symbol: &str) -> Vec<&'a str> {
        match self.written.declared(symbol) {
            Some(fields) => fields,
            None if turtle::SYMBOLS.contains(&symbol) => vec!["float"],
            None => panic!("`{symbol}` is not declared"),
        }
    }

    // --- the axiom -----------------------------------------------------------------------------

    /// Every module of the axiom is one root.
    fn axiom(&self, constants: &Constants) -> Option<Vec<Token>> {
        let scope = Scope { bound: Vec::new(), constants, attributes: &|_| None, random: None };
        let mut tokens = match self.written.axiom() {
            None => Vec::new(),
            Some(AxiomKind::Word(word)) => match self.system_word(word) {
                Some(name) => self.earlier(name)?,
                None => self.word(word, &scope, &mut 0, &|_| [0; 2]),
            },
            Some(AxiomKind::Source(source)) => match &source.kind {
                SourceKind::Named(name, None) => {
                    let mut tokens = self.earlier(&name.text)?;
                    let count = tokens.len();
                    tokens.rotate_left(self.shift(source, &scope, count));
                    tokens
                }
                _ => {
                    let symbol = self.symbol_of_points();
                    let module = |point: &[f64]| {
                        let field = self.fields(&symbol)[0];
                        Module { symbol: symbol.clone(), params: vec![in_field(point, field)], path: [0; 2] }
                    };
                    self.source(source, &scope).iter().map(|p| Token::Module(module(p))).collect()
                }
            },
            Some(AxiomKind::Starts(starts)) => starts.iter().flat_map(|s| self.start(s, &scope)).collect(),
            Some(other) => panic!("no axiom of a curve system: {other:?}"),
        };
        number_roots(&mut tokens);
        Some(tokens)
    }

    /// The name of an earlier system, if that is all that the word is.
    fn system_word<'w>(&self, word: &'w [Element]) -> Option<&'w str> {
        let [Element::Module(used)] = word else { return None };
        let name = used.symbol.text.as_str();
        let is_system = |item: &FileItem| matches!(item, FileItem::System(s) if s.name.text == name);
        let declared = self.written.declared(name).is_some() || turtle::SYMBOLS.contains(&name);
        (!declared && self.file.items.iter().any(is_system)).then_some(name)
    }

    /// The final word of an earlier system, which runs with the same params and seed.
    fn earlier(&self, name: &str) -> Option<Vec<Token>> {
        let mut other = Oracle::new(self.file, Some(name), self.points).seed(self.seed).bound(self.bound);
        other.overrides = self.overrides.clone();
        other.derive_within()?.pop().map(|word| word.tokens)
    }

    /// A word as written, its slots counted on from `slot`: each module and each `eps` takes one.
    pub(super) fn word(
        &self,
        elements: &[Element],
        scope: &Scope,
        slot: &mut u32,
        path: &dyn Fn(u32) -> Path,
    ) -> Vec<Token> {
        let mut tokens = Vec::new();
        for element in elements {
            match element {
                Element::Eps(_) => *slot += 1,
                Element::Module(used) => {
                    let (symbol, params) = (used.symbol.text.clone(), self.params(used, scope));
                    tokens.push(Token::Module(Module { symbol, params, path: path(*slot) }));
                    *slot += 1;
                }
                Element::Branch(branch, _) => {
                    tokens.push(Token::Open);
                    tokens.extend(self.word(branch, scope, slot, path));
                    tokens.push(Token::Close);
                }
                Element::Block(block) => panic!("a block in a curve system: {block:?}"),
            }
        }
        tokens
    }

    /// `P(_, false) = file "c.csv"`: `_` is the point read.
    fn start(&self, start: &Start, scope: &Scope) -> Vec<Token> {
        let used = &start.module;
        let types = self.fields(&used.symbol.text);
        let args = used.args.as_deref().expect("`_` must stand where the point goes");
        let param = |point: &[f64], arg: &Expr, ty: &str| match &arg.kind {
            ExprKind::Name(name) if name == "_" => in_field(point, ty),
            _ => Param::new(evaluate(arg, scope).coerce(ty)),
        };
        let module = |point: &Vec<f64>| {
            let params = types.iter().zip(args).map(|(ty, arg)| param(point, arg, ty)).collect();
            Token::Module(Module { symbol: used.symbol.text.clone(), params, path: [0; 2] })
        };
        self.source(&start.source, scope).iter().map(module).collect()
    }

    /// The one module that holds a vector and nothing else.
    fn symbol_of_points(&self) -> String {
        let is_point = |fields: &[&str]| matches!(fields, [ty] if ty.starts_with("vec"));
        let mut points = self.declarations().filter(|d| is_point(&self.fields(&d.symbol.text)));
        let only = points.next().expect("a module that holds a point").symbol.text.clone();
        assert!(points.next().is_none(), "the points may become several modules");
        only
    }

    fn source(&self, source: &Source, scope: &Scope) -> Vec<Vec<f64>> {
        let mut points = match &source.kind {
            SourceKind::File(path, index) => {
                let index = index.as_ref().map(|i| i.text.parse().expect("an index"));
                (self.points)(&path.text, index)
            }
            SourceKind::List(list) => match evaluate(list, scope) {
                Value::List(points) => points.into_iter().map(Value::vector).collect(),
                other => panic!("{other:?} is no list of points"),
            },
            SourceKind::Named(name, _) => panic!("`{}` is no source of points", name.text),
        };
        let count = points.len();
        points.rotate_left(self.shift(source, scope, count));
        points
    }

    /// The point that comes first, for `shift`.
    fn shift(&self, source: &Source, scope: &Scope, count: usize) -> usize {
        let shift = source.shift.as_ref().map_or(0, |shift| evaluate(shift, scope).int());
        assert!(source.shift.is_none() || self.topology == Topology::Ring, "only a ring can be shifted");
        if count == 0 { 0 } else { shift.rem_euclid(count as i32) as usize }
    }

    /// The parameters of a module of a successor or of the axiom, in the types of its fields.
    fn params(&self, module: &ModuleUse, scope: &Scope) -> Vec<Param> {
        let symbol = module.symbol.text.as_str();
        let types = self.fields(symbol);
        if module.args.is_none() && self.written.declared(symbol).is_none() {
            return vec![Param::Float(turtle::omitted(symbol, scope.constants))];
        }
        let args = module.args.as_deref().unwrap_or(&[]);
        assert_eq!(args.len(), types.len(), "arguments of `{symbol}`");
        types.iter().zip(args).map(|(ty, arg)| Param::new(evaluate(arg, scope).coerce(ty))).collect()
    }
}

/// Gives each module the path of a root.
pub(super) fn number_roots(tokens: &mut [Token]) {
    let modules = tokens.iter_mut().filter_map(|token| match token {
        Token::Module(module) => Some(module),
        _ => None,
    });
    for (index, module) in modules.enumerate() {
        module.path = lots::root(index);
    }
}

/// A point as a vector of the type; what it has not is 0.
pub(super) fn in_field(point: &[f64], ty: &str) -> Param {
    let at = |axis: usize| point.get(axis).copied().unwrap_or(0.0);
    match ty {
        "vec2" => Param::Vec2([0, 1].map(at)),
        "vec3" => Param::Vec3([0, 1, 2].map(at)),
        "vec4" => Param::Vec4([0, 1, 2, 3].map(at)),
        _ => panic!("a point is a vector, not {ty}"),
    }
}
