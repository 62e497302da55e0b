//! Expressions as graphs of scalars.
//!
//! Both backends run what stands here: every node is one 4-byte word made by one row of the table
//! of operations, vectors are their components, and sums of products are spelled out from left to
//! right. So there is one place where a vector operation gets its order, and equal nodes are one.

mod around;
mod given;
mod random;
mod vector;

use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::ops::{self, Op};
use crate::plan::context::{Place, Search};
use crate::plan::measure::Row;
use crate::plan::placement;
use crate::plan::tables::Environment;
use std::collections::HashMap;

/// Index of a node.
pub type NodeId = usize;

/// What a scalar is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scalar {
    Bool,
    Int,
    Float,
}

impl Scalar {
    /// The components of a type.
    pub fn of(ty: &Type) -> Scalar {
        match ty {
            Type::Bool => Scalar::Bool,
            Type::Int => Scalar::Int,
            Type::Float | Type::Vec2 | Type::Vec3 | Type::Vec4 => Scalar::Float,
            Type::List(element, _) => Scalar::of(element),
        }
    }
}

/// One scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    Literal(Scalar, u32),
    /// A word of the predecessor's record.
    Field(Scalar, usize),
    /// A word of the record so many places to the right.
    Near(Scalar, i32, usize),
    /// The symbol that stands there.
    NearSymbol(i32),
    /// Modules from this one to the end of the word.
    Behind,
    /// Of linked words: the module itself.
    Index,
    /// The record before it.
    Previous,
    /// The one so many behind it, if no other stands between on their axis, else nowhere.
    Beside(u32),
    /// The module that contexts see before another, or nowhere.
    Up(NodeId),
    /// The one that goes on.
    Down(NodeId),
    /// What the first step of a search finds; the nodes behind it are what the others do.
    Search(usize),
    Found {
        search: NodeId,
        step: usize,
    },
    /// A word of the record there; 0 of nowhere.
    At(Scalar, NodeId, usize),
    /// The symbol there; of nowhere [`END`](crate::plan::layout::END).
    SymbolAt(NodeId),
    /// What a child hangs on: a child of the same module, or what the module comes to hang on.
    Link {
        cell: Option<u32>,
        lateral: bool,
    },
    /// A word of the environment.
    Uniform(Scalar, usize),
    /// A word of the module's row of measured attributes.
    Measured(Scalar, usize),
    /// A word of what the host gives; the index is clamped.
    Given(Scalar, NodeId),
    /// A float constant that is to be read from the environment: [`Graph::settle`] says where.
    Held(u32),
    /// The greater of the halvings along u and v.
    Level,
    /// The number in its new word of the child in this slot; only children may ask.
    Number(u32),
    /// Steps done in this derive.
    Step,
    /// Steps done in the whole run.
    RunStep,
    /// The seed of the run.
    Seed,
    /// An element of a list in the environment: its first word, words an element, elements; the
    /// index is clamped.
    Element {
        ty: Scalar,
        base: usize,
        stride: usize,
        length: usize,
        index: NodeId,
    },
    Call(Op, [NodeId; 3]),
}

/// A graph; a node's arguments stand before it.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    pub nodes: Vec<Node>,
    known: HashMap<Node, NodeId>,
}

/// Where the things that an expression names stand.
pub struct Names<'a> {
    /// For each field of the predecessor, then for those of modules around it: the place, and the word of the record
    /// where it begins.
    pub fields: Vec<(Place, usize)>,
    /// Places are found along links.
    pub linked: bool,
    /// The word of the record that says which of several words it is of.
    pub word: Option<usize>,
    pub searches: &'a [Search],
    /// The words of the record that say which module it is, for random numbers.
    pub path: Vec<usize>,
    /// Where the environment holds uniforms and what the host gives.
    pub environment: &'a Environment,
    pub subject: Subject<'a>,
    /// The components of the lets lowered so far.
    pub lets: Vec<Vec<NodeId>>,
    /// Identifies the rule, or the placement, for random numbers.
    pub site: u32,
    /// Words of constants in the environment, behind the uniforms.
    pub constants: &'a mut Constants,
}

/// What an expression speaks of: whose record it reads, and what random numbers are drawn for. Words 1 to 3 of
/// either record name it for good.
#[derive(Clone, Copy)]
pub enum Subject<'a> {
    /// A module; the attributes of its net stand as the row says.
    Module(&'a Row),
    /// A vertex of a tessellation ([`crate::plan::placement`]); the seed is this word of the environment.
    Vertex { seed: usize },
}

/// Constants that stand in the environment: lists, which are indexed at run time, and float
/// constants that no compiler shall know.
#[derive(Clone, Debug, Default)]
pub struct Constants {
    /// The word where they begin.
    pub base: usize,
    pub words: Vec<u32>,
}

impl Constants {
    /// The place of these words, shared with what is there already.
    fn place(&mut self, words: &[u32]) -> usize {
        let found = self.words.windows(words.len().max(1)).position(|w| w == words);
        let at = found.unwrap_or(self.words.len());
        if found.is_none() {
            self.words.extend(words);
        }
        self.base + at
    }
}

impl Graph {
    fn push(&mut self, node: Node) -> NodeId {
        let next = self.nodes.len();
        *self.known.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            next
        })
    }

    /// A call of the row that takes these scalars; the checker's table has all that are asked for.
    fn call(&mut self, name: &str, ty: &[Type], args: &[NodeId]) -> NodeId {
        match ops::find(name, ty) {
            Ok(op) => self.call_op(op, args),
            Err(_) => unreachable!("the table has a row {name} of {ty:?}"),
        }
    }

    fn call_op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        // Constants are folded: WGSL refuses constant expressions that overflow.
        let literals: Option<Vec<u32>> = args.iter().map(|&a| self.literal(a)).collect();
        if let Some(words) = literals
            && let Some(word) = op.row().cpu.and_then(|cpu| cpu.word(&words))
        {
            return self.push(Node::Literal(Scalar::of(&op.row().result), word));
        }
        let sum = matches!(op.row().symbol(), "+" | "-");
        let mut list = [0; 3];
        for (place, &arg) in list.iter_mut().zip(args) {
            *place = self.operand(arg, sum);
        }
        self.push(Node::Call(op, list))
    }

    fn literal(&self, id: NodeId) -> Option<u32> {
        match self.nodes[id] {
            Node::Literal(_, word) => Some(word),
            _ => None,
        }
    }

    /// What the node is.
    pub fn scalar(&self, id: NodeId) -> Scalar {
        match self.nodes[id] {
            Node::Literal(ty, _) | Node::Field(ty, _) | Node::Near(ty, ..) | Node::Uniform(ty, _) => ty,
            Node::Measured(ty, _) | Node::Given(ty, _) => ty,
            Node::Element { ty, .. } => ty,
            Node::Held(_) => Scalar::Float,
            Node::At(ty, ..) => ty,
            Node::NearSymbol(_) | Node::Behind | Node::Number(_) | Node::Level => Scalar::Int,
            Node::Step | Node::RunStep | Node::Seed => Scalar::Int,
            Node::Index | Node::Previous | Node::Beside(_) | Node::Up(_) | Node::Down(_) => Scalar::Int,
            Node::SymbolAt(_) | Node::Link { .. } => Scalar::Int,
            Node::Search(_) | Node::Found { .. } => Scalar::Int,
            Node::Call(op, _) => Scalar::of(&op.row().result),
        }
    }

    /// The nodes that a node reads.
    pub fn args(&self, id: NodeId) -> Vec<NodeId> {
        match self.nodes[id] {
            Node::Call(op, args) => args[..op.row().args.len()].to_vec(),
            Node::Element { index, .. } | Node::Given(_, index) => vec![index],
            Node::Up(n) | Node::Down(n) | Node::At(_, n, _) | Node::SymbolAt(n) => vec![n],
            Node::Found { search, .. } => vec![search],
            _ => Vec::new(),
        }
    }

    /// The components of an expression.
    pub fn lower(&mut self, e: &Expr, names: &mut Names) -> Vec<NodeId> {
        let ty = Scalar::of(&e.ty);
        let words = e.ty.words();
        match &e.kind {
            ExprKind::Literal(value) => {
                value.words().into_iter().map(|w| self.push(Node::Literal(ty, w))).collect()
            }
            ExprKind::Binder(n) => {
                let (place, at) = names.fields[*n];
                if place == Place::Strict(0) {
                    return (at..at + words).map(|w| self.push(Node::Field(ty, w))).collect();
                }
                if !names.linked {
                    let offset = place.offset();
                    return (at..at + words).map(|w| self.push(Node::Near(ty, offset, w))).collect();
                }
                let there = self.place(place, names.searches);
                (at..at + words).map(|w| self.push(Node::At(ty, there, w))).collect()
            }
            ExprKind::Uniform(n) => {
                let at = names.environment.uniforms[*n];
                (at..at + words).map(|w| self.uniform(ty, w, names)).collect()
            }
            ExprKind::Let(n) => names.lets[*n].clone(),
            ExprKind::Attribute(name) => match names.subject {
                Subject::Vertex { .. } => {
                    placement::words_of(name).iter().map(|&w| self.push(Node::Field(ty, w))).collect()
                }
                Subject::Module(_) if *name == "step" => vec![self.push(Node::Step)],
                Subject::Module(row) => match row.place(name) {
                    Some(at) => (at..at + words).map(|w| self.push(Node::Measured(ty, w))).collect(),
                    // `plan::supported` has refused what patches have not.
                    None => vec![self.push(Node::Level)],
                },
            },
            ExprKind::Component(v, n) => vec![self.lower(v, names)[*n]],
            ExprKind::Vector(parts) => parts.iter().flat_map(|p| self.lower(p, names)).collect(),
            ExprKind::Element(list, index) => self.element(list, index, names),
            ExprKind::Call(op, args) => {
                let lowered: Vec<Vec<NodeId>> = args.iter().map(|a| self.lower(a, names)).collect();
                self.expand(*op, &lowered)
            }
            ExprKind::Random { function, args, site } => {
                let hash = self.draw(names, *site as u32);
                let args: Vec<NodeId> = args.iter().map(|a| self.lower(a, names)[0]).collect();
                vec![self.random(function, hash, &args)]
            }
            ExprKind::OfRoot(query) => self.of_root(*query, ty, names),
            ExprKind::Sample(query, point) => {
                let point = self.lower(point, names);
                self.sample(*query, ty, &point, names)
            }
        }
    }

    fn int(&mut self, i: u32) -> NodeId {
        self.push(Node::Literal(Scalar::Int, i))
    }

    fn ints(&mut self, name: &str, args: &[NodeId]) -> NodeId {
        let types = vec![Type::Int; args.len()];
        self.call(name, &types, args)
    }

    /// A word of the uniforms; where several words are derived at once that of the module's.
    fn uniform(&mut self, ty: Scalar, word: usize, names: &Names) -> NodeId {
        match names.word {
            None => self.push(Node::Uniform(ty, word)),
            Some(field) => self.of_word(ty, field, word, names),
        }
    }

    fn seed(&mut self, names: &Names) -> NodeId {
        match names.word {
            None => self.push(Node::Seed),
            Some(field) => self.of_word(Scalar::Int, field, names.environment.uniform_words, names),
        }
    }

    /// What is given of the module's word: its uniforms, then its seed, one word after the other.
    fn of_word(&mut self, ty: Scalar, field: usize, word: usize, names: &Names) -> NodeId {
        let index = self.push(Node::Field(Scalar::Int, field));
        let stride = self.int(names.environment.uniform_words as u32 + 1);
        let start = self.ints("*", &[index, stride]);
        let word = self.int(word as u32);
        let at = self.ints("+", &[start, word]);
        self.push(Node::Given(ty, at))
    }

    fn element(&mut self, list: &[Value], index: &Expr, names: &mut Names) -> Vec<NodeId> {
        let index = self.lower(index, names)[0];
        let words: Vec<u32> = list.iter().flat_map(Value::words).collect();
        let stride = words.len() / list.len().max(1);
        let base = names.constants.place(&words);
        let ty = list.first().map_or(Scalar::Float, |v| Scalar::of(&v.ty()));
        let length = list.len();
        (0..stride).map(|n| self.push(Node::Element { ty, base: base + n, stride, length, index })).collect()
    }

    /// A float literal as an operand: a compiler that knows two constants of a sum, or of a product,
    /// may reassociate it, so all but one are held back. Powers of two scale exactly in any order. Infinities are
    /// held back since no constant of WGSL may be one.
    fn operand(&mut self, id: NodeId, sum: bool) -> NodeId {
        match self.nodes[id] {
            Node::Literal(Scalar::Float, word)
                if word << 1 != 0
                    && (sum || word & 0x007f_ffff != 0 || !f32::from_bits(word).is_finite()) =>
            {
                self.push(Node::Held(word))
            }
            _ => id,
        }
    }

    /// Gives the constants that were held back their places in the environment.
    pub fn settle(&mut self, constants: &mut Constants) {
        for node in &mut self.nodes {
            if let Node::Held(word) = *node {
                *node = Node::Uniform(Scalar::Float, constants.place(&[word]));
            }
        }
    }

    /// An operation as rows of scalars.
    fn expand(&mut self, op: Op, args: &[Vec<NodeId>]) -> Vec<NodeId> {
        let row = op.row();
        if row.cpu.is_some() {
            let operands: Vec<NodeId> = args.iter().map(|a| a[0]).collect();
            return vec![self.call_op(op, &operands)];
        }
        self.expand_vector(row.name, args)
    }

    /// An operation on floats that rules write, whatever they are.
    fn scalar_call(&mut self, name: &str, args: &[NodeId]) -> NodeId {
        let types = vec![Type::Float; args.len()];
        self.call(name, &types, args)
    }

    /// The same on components of vectors, which are finite: a point that is not ends the run. So sums and products of
    /// points, which rules are mostly made of, cost nothing more.
    fn float(&mut self, name: &str, args: &[NodeId]) -> NodeId {
        let by_number = || args.get(1).and_then(|&a| self.literal(a)).map(f32::from_bits);
        match name {
            "+" => self.scalar_call("+ #", args),
            "-" => self.scalar_call("- #", args),
            "*" => self.scalar_call("* #", args),
            "/" if by_number().is_some_and(|x| x != 0.0 && x.is_finite()) => self.scalar_call("/ #", args),
            _ => self.scalar_call(name, args),
        }
    }

    fn number(&mut self, x: f32) -> NodeId {
        self.push(Node::Literal(Scalar::Float, x.to_bits()))
    }
}
