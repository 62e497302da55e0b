//! Expressions as graphs of scalars.
//!
//! Both backends run what stands here: every node is one 4-byte word made by one row of the table
//! of operations, vectors are their components, and sums of products are spelled out from left to
//! right. So there is one place where a vector operation gets its order, and equal nodes are one.

use super::context::{Near, Place, Search};
use super::layout::NONE;
use super::measure::Row;
use super::placement;
use super::tables::Environment;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::ops::{self, Op};
use crate::language::system::Hang;
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
    /// The symbol there; of nowhere [`END`](super::layout::END).
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
    /// The number in the new word of the child in this slot; only children may ask.
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
    /// A vertex of a tessellation ([`super::placement`]); the seed is this word of the environment.
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

/// A coordinate among the points of a grid's axis.
struct Axis {
    /// Points.
    size: NodeId,
    /// The points on either side, and the nearest.
    low: NodeId,
    high: NodeId,
    near: NodeId,
    /// From 0 at `low` to 1 at `high`.
    between: NodeId,
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
        let sum = matches!(op.row().name, "+" | "-");
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

    /// The words of the value that the host gives the module's root.
    fn of_root(&mut self, query: usize, ty: Scalar, names: &Names) -> Vec<NodeId> {
        let root = self.push(Node::Field(Scalar::Int, 1));
        self.given(query, ty, root, names)
    }

    /// The words of value `n` of a query.
    fn given(&mut self, query: usize, ty: Scalar, n: NodeId, names: &Names) -> Vec<NodeId> {
        let words = names.environment.queries[query];
        let base = self.push(Node::Uniform(Scalar::Int, names.environment.given.values(query)));
        let stride = self.int(words as u32);
        let offset = self.ints("*", &[n, stride]);
        let first = self.ints("+", &[base, offset]);
        let place = |graph: &mut Graph, word: usize| {
            let word = graph.int(word as u32);
            graph.ints("+", &[first, word])
        };
        let places: Vec<NodeId> = (0..words).map(|w| place(self, w)).collect();
        places.into_iter().map(|at| self.push(Node::Given(ty, at))).collect()
    }

    /// The value of a grid at a point: along each axis the two points of the grid next to it, and
    /// how far it lies between them; then z first, since x is fastest.
    fn sample(&mut self, query: usize, ty: Scalar, point: &[NodeId], names: &Names) -> Vec<NodeId> {
        let axes: Vec<Axis> = (0..3).map(|axis| self.axis(query, axis, point[axis], names)).collect();
        let [x, y, z] = [&axes[0], &axes[1], &axes[2]];
        if ty != Scalar::Float {
            let n = self.grid_point(x, y, [x.near, y.near, z.near]);
            return self.given(query, ty, n, names);
        }
        let mut corners = Vec::with_capacity(8);
        for n in 0..8 {
            let side = |axis: &Axis, bit: usize| if n >> bit & 1 == 0 { axis.low } else { axis.high };
            let at = self.grid_point(x, y, [side(x, 0), side(y, 1), side(z, 2)]);
            corners.push(self.given(query, ty, at, names));
        }
        for axis in [x, y, z] {
            let pairs: Vec<Vec<NodeId>> = corners
                .chunks_exact(2)
                .map(|pair| {
                    let words = pair[0].iter().zip(&pair[1]);
                    words.map(|(&a, &b)| self.mix(a, b, axis.between)).collect()
                })
                .collect();
            corners = pairs;
        }
        corners.swap_remove(0)
    }

    /// Where a coordinate lies among the points of an axis.
    fn axis(&mut self, query: usize, axis: usize, coordinate: NodeId, names: &Names) -> Axis {
        let given = names.environment.given;
        let [size, from, density] = [
            Node::Uniform(Scalar::Int, given.size(query, axis)),
            Node::Uniform(Scalar::Float, given.from(query, axis)),
            Node::Uniform(Scalar::Float, given.density(query, axis)),
        ]
        .map(|node| self.push(node));
        let one = self.int(1);
        let last = self.ints("-", &[size, one]);
        let end = self.call("float", &[Type::Int], &[last]);
        let above = self.float("-", &[coordinate, from]);
        let place = self.float("*", &[above, density]);
        let zero = self.number(0.0);
        let place = self.float("clamp", &[place, zero, end]);
        let floor = self.float("floor", &[place]);
        let low = self.call("int", &[Type::Float], &[floor]);
        let next = self.ints("+", &[low, one]);
        let high = self.ints("min", &[next, last]);
        let between = self.float("-", &[place, floor]);
        let round = self.float("round", &[place]);
        let near = self.call("int", &[Type::Float], &[round]);
        Axis { size, low, high, near, between }
    }

    /// The number of a grid's point.
    fn grid_point(&mut self, x: &Axis, y: &Axis, [i, j, k]: [NodeId; 3]) -> NodeId {
        let slice = self.ints("*", &[k, y.size]);
        let row = self.ints("+", &[slice, j]);
        let start = self.ints("*", &[row, x.size]);
        self.ints("+", &[start, i])
    }

    fn int(&mut self, i: u32) -> NodeId {
        self.push(Node::Literal(Scalar::Int, i))
    }

    fn ints(&mut self, name: &str, args: &[NodeId]) -> NodeId {
        let types = vec![Type::Int; args.len()];
        self.call(name, &types, args)
    }

    /// Where a place of a linked word is.
    fn place(&mut self, place: Place, searches: &[Search]) -> NodeId {
        let node = match place {
            Place::Strict(0) | Place::Before(0) => Node::Index,
            Place::Strict(n) => Node::Beside(n),
            Place::Before(n) => Node::Up(self.place(Place::Before(n - 1), searches)),
            Place::Behind { last, steps: 0 } => return self.place(Place::Strict(last), searches),
            Place::Behind { last, steps } => {
                Node::Down(self.place(Place::Behind { last, steps: steps - 1 }, searches))
            }
            Place::Previous => Node::Previous,
            Place::Found { search, step } => {
                // All at once: a backend fills these nodes in one go.
                let first = self.push(Node::Search(search));
                let steps = 1..searches[search].steps.len();
                steps.for_each(|step| _ = self.push(Node::Found { search: first, step }));
                return first + step;
            }
        };
        self.push(node)
    }

    /// What a child hangs on.
    pub fn link(&mut self, hang: &Hang) -> NodeId {
        if hang.root {
            return self.int(NONE);
        }
        self.push(Node::Link { cell: hang.on.map(|cell| cell as u32), lateral: hang.lateral })
    }

    /// Whether the symbol that a context asks for stands in its place.
    pub fn near(&mut self, near: &Near, names: &Names) -> NodeId {
        let found = match names.linked {
            true => {
                let there = self.place(near.place, names.searches);
                self.push(Node::SymbolAt(there))
            }
            false => self.push(Node::NearSymbol(near.place.offset())),
        };
        let wanted = self.int(near.symbol);
        self.ints("==", &[found, wanted])
    }

    /// Whether so many modules, this one the first, stand before the end of the word.
    pub fn has_behind(&mut self, modules: u32) -> NodeId {
        let behind = self.push(Node::Behind);
        let wanted = self.int(modules);
        self.ints(">=", &[behind, wanted])
    }

    /// The words of a curve module's path.
    pub fn path(&mut self) -> [NodeId; 2] {
        [1, 2].map(|word| self.push(Node::Field(Scalar::Int, word)))
    }

    /// Those of its child in this slot: 64 bits, since paths are as many as modules.
    pub fn child_path(&mut self, slot: u32) -> [NodeId; 2] {
        let [high, low] = self.path();
        let slot = self.int(slot);
        let high = self.ints("hash #", &[high, slot]);
        [high, self.ints("hash #", &[low, high])]
    }

    /// That of a child in this slot which is a root: what stands for it is its number in the word.
    pub fn root_path(&mut self, slot: u32) -> [NodeId; 2] {
        [self.int(0), self.push(Node::Number(slot))]
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

    /// The word of the record that says which of several words it is of.
    pub fn word_of(&mut self, field: usize) -> NodeId {
        self.push(Node::Field(Scalar::Int, field))
    }

    /// The hash behind one random number: of the seed, for a module the step of the whole run, what names
    /// it (of a patch module root and order key), the rule, and the call in it.
    fn draw(&mut self, names: &Names, call: u32) -> NodeId {
        let (mut hash, step) = match names.subject {
            Subject::Module(_) => (self.seed(names), Some(self.push(Node::RunStep))),
            Subject::Vertex { seed } => (self.push(Node::Uniform(Scalar::Int, seed)), None),
        };
        let path: Vec<NodeId> =
            names.path.iter().map(|&word| self.push(Node::Field(Scalar::Int, word))).collect();
        let site = names.site;
        let place = [self.int(site), self.int(call)];
        for word in step.into_iter().chain(path).chain(place) {
            hash = self.ints("hash #", &[hash, word]);
        }
        hash
    }

    fn random(&mut self, function: &str, hash: NodeId, args: &[NodeId]) -> NodeId {
        if function == "randn" {
            return self.normal(hash);
        }
        let unit = self.call("unit #", &[Type::Int], &[hash]);
        match *args {
            [low, high] => {
                let width = self.float("-", &[high, low]);
                let above = self.float("*", &[width, unit]);
                self.float("+", &[low, above])
            }
            _ => unit,
        }
    }

    /// Twelve 16-bit slices, summed as integers, less their mean: standard deviation 1.
    fn normal(&mut self, hash: NodeId) -> NodeId {
        let mut sum = self.int((-6i32 * 65_535) as u32);
        for n in 0..6 {
            let number = self.int(n);
            let word = self.ints("hash #", &[hash, number]);
            let slices = self.ints("slices #", &[word]);
            sum = self.ints("+", &[sum, slices]);
        }
        let sum = self.call("float", &[Type::Int], &[sum]);
        let scale = self.number(1.0 / 65_536.0);
        self.float("*", &[sum, scale])
    }

    /// The draw among alternatives: whether any weight is positive, and the index drawn. Weights
    /// count in 65,536ths, as integers, up to 32,767 over their number.
    pub fn choice(&mut self, weights: &[NodeId], names: &Names) -> (NodeId, NodeId) {
        let most = 32_767.0 / weights.len() as f32;
        let (zero, most) = (self.number(0.0), self.number(most));
        let unit = self.number(65_536.0);
        let mut total = self.int(0);
        let mut ends = Vec::with_capacity(weights.len());
        for &weight in weights {
            let weight = self.float("clamp", &[weight, zero, most]);
            let scaled = self.float("*", &[weight, unit]);
            let whole = self.float("round", &[scaled]);
            let fixed = self.call("int", &[Type::Float], &[whole]);
            total = self.ints("+", &[total, fixed]);
            ends.push(total);
        }
        // A site of its own, so that a call of `rand` in the rule does not move it.
        let hash = self.draw(names, u32::MAX);
        let drawn = self.ints("scale #", &[hash, total]);
        let mut index = self.int(weights.len() as u32 - 1);
        for (n, &end) in ends.iter().enumerate().rev().skip(1) {
            let below = self.ints("<", &[drawn, end]);
            let here = self.int(n as u32);
            index = self.call("if", &[Type::Bool, Type::Int, Type::Int], &[below, here, index]);
        }
        let none = self.int(0);
        (self.ints(">", &[total, none]), index)
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
    /// may reassociate it, so all but one are held back. Powers of two scale exactly in any order.
    fn operand(&mut self, id: NodeId, sum: bool) -> NodeId {
        match self.nodes[id] {
            Node::Literal(Scalar::Float, word) if word << 1 != 0 && (sum || word & 0x007f_ffff != 0) => {
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

    fn expand_vector(&mut self, name: &str, args: &[Vec<NodeId>]) -> Vec<NodeId> {
        match (name, args) {
            ("fract", [v]) => v.iter().map(|&x| self.fract(x)).collect(),
            ("%", [a, b]) => vec![self.remainder(a[0], b[0])],
            ("mix", [a, b, t]) => (0..a.len()).map(|i| self.mix(a[i], b[i], t[0])).collect(),
            ("smoothstep", [low, high, x]) => vec![self.smoothstep(low[0], high[0], x[0])],
            ("dot", [a, b]) => vec![self.dot(a, b)],
            ("length", [v]) => vec![self.length(v)],
            ("distance", [a, b]) => {
                let difference = self.each("-", &[a.clone(), b.clone()]);
                vec![self.length(&difference)]
            }
            ("normalize", [v]) => {
                let length = self.length(v);
                v.iter().map(|&x| self.float("/", &[x, length])).collect()
            }
            ("noise", [p]) => vec![self.float("noise #", &[p[0], p[1], p[2]])],
            ("frame *", [frame, v]) => self.in_frame(frame, v),
            ("cross", [a, b]) if a.len() == 2 => vec![self.minor(a, b, 0, 1)],
            ("cross", [a, b]) => [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minor(a, b, i, j)).to_vec(),
            ("rotate", [v, angle]) => self.rotate_plane(v, angle[0]),
            ("rotate", [v, axis, angle]) => self.rotate_about(v, axis, angle[0]),
            ("if", [condition, a, b]) => {
                let types = [Type::Bool, Type::Float, Type::Float];
                (0..a.len()).map(|i| self.call("if", &types, &[condition[0], a[i], b[i]])).collect()
            }
            _ => self.each(name, args),
        }
    }

    /// The scalar row for each component; a single number goes with every component.
    fn each(&mut self, name: &str, args: &[Vec<NodeId>]) -> Vec<NodeId> {
        let length = args.iter().map(Vec::len).max().unwrap_or(0);
        let pick = |i: usize| -> Vec<NodeId> { args.iter().map(|a| a[i.min(a.len() - 1)]).collect() };
        (0..length).map(|i| self.float(name, &pick(i))).collect()
    }

    fn float(&mut self, name: &str, args: &[NodeId]) -> NodeId {
        let types = vec![Type::Float; args.len()];
        self.call(name, &types, args)
    }

    fn number(&mut self, x: f32) -> NodeId {
        self.push(Node::Literal(Scalar::Float, x.to_bits()))
    }

    fn fract(&mut self, x: NodeId) -> NodeId {
        let floor = self.float("floor", &[x]);
        self.float("-", &[x, floor])
    }

    /// a − b·trunc(a / b)
    fn remainder(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let quotient = self.float("/", &[a, b]);
        let whole = self.float("trunc", &[quotient]);
        let product = self.float("*", &[b, whole]);
        self.float("-", &[a, product])
    }

    /// (a − a·t) + b·t: drivers take a·(1 − t) + b·t for an interpolation and compute another.
    fn mix(&mut self, a: NodeId, b: NodeId, t: NodeId) -> NodeId {
        let (part, second) = (self.float("*", &[a, t]), self.float("*", &[b, t]));
        let first = self.float("-", &[a, part]);
        self.float("+", &[first, second])
    }

    /// t·t·(3 − 2t) with t = clamp((x − low) / (high − low), 0, 1)
    fn smoothstep(&mut self, low: NodeId, high: NodeId, x: NodeId) -> NodeId {
        let (above, width) = (self.float("-", &[x, low]), self.float("-", &[high, low]));
        let ratio = self.float("/", &[above, width]);
        let (zero, one) = (self.number(0.0), self.number(1.0));
        let t = self.float("clamp", &[ratio, zero, one]);
        let (two, three) = (self.number(2.0), self.number(3.0));
        let twice = self.float("*", &[two, t]);
        let rest = self.float("-", &[three, twice]);
        let square = self.float("*", &[t, t]);
        self.float("*", &[square, rest])
    }

    /// Products summed from left to right.
    fn dot(&mut self, a: &[NodeId], b: &[NodeId]) -> NodeId {
        let products: Vec<NodeId> = a.iter().zip(b).map(|(&x, &y)| self.float("*", &[x, y])).collect();
        products.into_iter().reduce(|sum, p| self.float("+", &[sum, p])).unwrap_or(0)
    }

    fn length(&mut self, v: &[NodeId]) -> NodeId {
        let square = self.dot(v, v);
        self.float("sqrt", &[square])
    }

    fn minor(&mut self, a: &[NodeId], b: &[NodeId], i: usize, j: usize) -> NodeId {
        let (first, second) = (self.float("*", &[a[i], b[j]]), self.float("*", &[a[j], b[i]]));
        self.float("-", &[first, second])
    }

    /// Components along the three axes of a frame, whose components stand one axis after the other.
    fn in_frame(&mut self, frame: &[NodeId], v: &[NodeId]) -> Vec<NodeId> {
        (0..3).map(|k| self.dot(&[frame[k], frame[3 + k], frame[6 + k]], v)).collect()
    }

    fn sine_and_cosine(&mut self, degrees: NodeId) -> (NodeId, NodeId) {
        let angle = self.float("radians", &[degrees]);
        (self.float("sin", &[angle]), self.float("cos", &[angle]))
    }

    fn rotate_plane(&mut self, v: &[NodeId], degrees: NodeId) -> Vec<NodeId> {
        let (sin, cos) = self.sine_and_cosine(degrees);
        let (xc, ys) = (self.float("*", &[v[0], cos]), self.float("*", &[v[1], sin]));
        let (xs, yc) = (self.float("*", &[v[0], sin]), self.float("*", &[v[1], cos]));
        vec![self.float("-", &[xc, ys]), self.float("+", &[xs, yc])]
    }

    /// Rodrigues: v·cos + (k × v)·sin + k·(k·v)·(1 − cos)
    fn rotate_about(&mut self, v: &[NodeId], axis: &[NodeId], degrees: NodeId) -> Vec<NodeId> {
        let (sin, cos) = self.sine_and_cosine(degrees);
        let length = self.length(axis);
        let k: Vec<NodeId> = axis.iter().map(|&x| self.float("/", &[x, length])).collect();
        let side = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| self.minor(&k, v, i, j));
        let one = self.number(1.0);
        let rest = self.float("-", &[one, cos]);
        let dot = self.dot(&k, v);
        let along = self.float("*", &[dot, rest]);
        let component = |graph: &mut Graph, i: usize| {
            let (a, b) = (graph.float("*", &[v[i], cos]), graph.float("*", &[side[i], sin]));
            let c = graph.float("*", &[k[i], along]);
            let sum = graph.float("+", &[a, b]);
            graph.float("+", &[sum, c])
        };
        (0..3).map(|i| component(self, i)).collect()
    }
}
