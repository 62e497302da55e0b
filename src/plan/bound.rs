//! How far the same expression may be off on another machine.
//!
//! WGSL guarantees no float bits: a driver may fuse a product and a sum, or divide within 2.5 units
//! in the last place. Here a graph is evaluated with, for every float, how far a conforming machine
//! may be from the value of this one. Where a condition could fall either way within that, both
//! outcomes are right, and only there: everything else must be equal. (Only comparisons of two
//! backends ask; a derivation never does.)

use super::graph::{Graph, Node, Scalar};
use super::links::{Linked, NOWHERE};
use super::measure::Row;
use super::step::Clock;
use super::tables::Stage;
use crate::language::expr::Type;
use crate::language::ops::Op;

/// A value of this machine, and those of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Known {
    /// The same word everywhere.
    Exact(u32),
    /// Within `radius` of `value`; infinite where nothing is known. Of a value that is not finite any of its kind.
    Near { value: f32, radius: f32 },
    /// An int, or a bool as 0 or 1, that comes of a float: `own` on this machine, elsewhere from `low` to `high`.
    Between { own: i32, low: i32, high: i32 },
    /// An int or bool of which nothing is known.
    Any,
}

impl Known {
    fn near(value: f32, radius: f32) -> Known {
        Known::Near { value, radius: if radius.is_nan() { f32::INFINITY } else { radius } }
    }

    /// Whether anything is known.
    pub fn is_bounded(self) -> bool {
        !matches!(self, Known::Any | Known::Near { radius: f32::INFINITY, .. })
    }

    /// Whether another machine may have this word.
    pub fn allows(self, word: u32) -> bool {
        match self {
            Known::Any => true,
            Known::Exact(own) => own == word,
            Known::Between { low, high, .. } => (low..=high).contains(&(word as i32)),
            Known::Near { value, radius } => {
                radius == f32::INFINITY || distance(value, f32::from_bits(word)) <= radius
            }
        }
    }

    /// Whether it must have it.
    fn forces(self, word: u32) -> bool {
        match self {
            Known::Exact(own) => own == word,
            Known::Near { value, radius } => radius == 0.0 && value.to_bits() == word,
            Known::Between { .. } | Known::Any => false,
        }
    }
}

/// How far two floats are apart; 0 where both are not a number, or the same infinity.
pub fn distance(a: f32, b: f32) -> f32 {
    if a == b || a.is_nan() && b.is_nan() {
        return 0.0;
    }
    let apart = (a - b).abs();
    if apart.is_nan() { f32::INFINITY } else { apart }
}

/// What a module's expressions read.
#[derive(Clone, Copy)]
pub struct Module<'a> {
    pub record: &'a [u32],
    /// The records around it, and where its own begins among them.
    pub window: &'a [u32],
    pub at: usize,
    /// Modules from this one to the end of the word.
    pub behind: u32,
    pub environment: &'a [u32],
    pub given: &'a [u32],
    pub measured: &'a [u32],
    /// For each word of `measured` how far it may be off.
    pub spread: &'a [f32],
    pub clock: Clock,
    /// The word, where it is linked, and the module's index in it.
    pub linked: Option<Linked<'a>>,
    pub index: u32,
}

impl Module<'_> {
    /// What the links of the word say.
    fn walk(&self, of: impl Fn(&Linked) -> u32) -> Known {
        Known::Exact(self.linked.as_ref().map_or(0, of))
    }

    /// A word of the record so many places to the right.
    fn near(&self, offset: i32, word: usize) -> u32 {
        let at = self.at as i64 + i64::from(offset) * self.record.len() as i64 + word as i64;
        usize::try_from(at).ok().and_then(|at| self.window.get(at)).copied().unwrap_or(0)
    }
}

/// A place, which is the same everywhere.
fn exact(place: Known) -> u32 {
    match place {
        Known::Exact(place) => place,
        _ => NOWHERE,
    }
}

/// Half a unit in the last place of 1.
const EPSILON: f32 = f32::EPSILON / 2.0;

/// Every node of a graph.
pub fn evaluate(graph: &Graph, module: &Module) -> Vec<Known> {
    let mut known: Vec<Known> = Vec::with_capacity(graph.nodes.len());
    let word = |list: &[u32], at: usize| list.get(at).copied().unwrap_or(0);
    for node in &graph.nodes {
        let value = match *node {
            Node::Literal(_, word) | Node::Held(word) => Known::Exact(word),
            Node::Field(_, at) => Known::Exact(word(module.record, at)),
            Node::Near(_, offset, at) => Known::Exact(module.near(offset, at)),
            Node::NearSymbol(offset) => Known::Exact(module.near(offset, 0) & 0xffff),
            // Which of two backends counts, they agree on: it is no float.
            Node::Behind => Known::Exact(module.behind),
            Node::Previous => module.walk(|word| word.previous(module.index)),
            Node::Index => Known::Exact(module.index),
            Node::Beside(places) => module.walk(|word| word.beside(module.index, places)),
            Node::Up(n) => module.walk(|word| word.up(exact(known[n]))),
            Node::Down(n) => module.walk(|word| word.down(exact(known[n]))),
            Node::Search(search) => module.walk(|word| word.found(module.index, search, 0)),
            Node::Found { search, step } => match graph.nodes[search] {
                Node::Search(search) => module.walk(|word| word.found(module.index, search, step)),
                _ => Known::Any,
            },
            Node::At(_, n, at) => module.walk(|word| word.word(exact(known[n]), at)),
            Node::SymbolAt(n) => module.walk(|word| word.symbol(exact(known[n]))),
            // An integer that no expression reads.
            Node::Link { .. } => Known::Any,
            Node::Uniform(_, at) => Known::Exact(word(module.environment, at)),
            Node::Measured(_, at) => {
                let (word, radius) = (word(module.measured, at), module.spread.get(at).copied());
                match radius {
                    Some(radius) if radius > 0.0 => Known::near(f32::from_bits(word), radius),
                    _ => Known::Exact(word),
                }
            }
            Node::Given(ty, index) => {
                let last = module.given.len().saturating_sub(1);
                indexed(ty, known[index], |i| word(module.given, (i as usize).min(last)))
            }
            // Prefix sums that the two agree on.
            Node::Number(_) => Known::Exact(u32::MAX),
            Node::Level => {
                let head = word(module.record, 0);
                Known::Exact((head >> 16 & 0xff).max(head >> 24))
            }
            Node::Step => Known::Exact(module.clock.step),
            Node::RunStep => Known::Exact(module.clock.run_step),
            Node::Seed => Known::Exact(module.clock.seed),
            Node::Element { ty, base, stride, length, index } => {
                let last = length.saturating_sub(1) as i32;
                let at = |i: u32| base + stride * (i as i32).clamp(0, last) as usize;
                indexed(ty, known[index], |i| word(module.environment, at(i)))
            }
            Node::Call(op, args) => {
                let args: Vec<Known> = args[..op.row().args.len()].iter().map(|&a| known[a]).collect();
                call(op, &args)
            }
        };
        known.push(value);
    }
    known
}

fn unknown(ty: Scalar) -> Known {
    match ty {
        Scalar::Float => Known::Near { value: 0.0, radius: f32::INFINITY },
        _ => Known::Any,
    }
}

fn indexed(ty: Scalar, index: Known, at: impl Fn(u32) -> u32) -> Known {
    match index {
        Known::Exact(i) => Known::Exact(at(i)),
        _ => unknown(ty),
    }
}

/// Ints that are tried one by one.
const MOST_CANDIDATES: i64 = 4;

/// The words that an argument may have, its own first; none where they cannot be listed.
fn candidates(ty: &Type, arg: Known) -> Option<Vec<u32>> {
    match (arg, ty) {
        (Known::Exact(word), _) => Some(vec![word]),
        (Known::Near { value, radius: 0.0 }, _) => Some(vec![value.to_bits()]),
        (Known::Near { value, radius }, _) if radius.is_finite() => {
            Some([value, value - radius, value + radius].map(f32::to_bits).to_vec())
        }
        (Known::Between { own, low, high }, _) if i64::from(high) - i64::from(low) < MOST_CANDIDATES => {
            let others = (low..=high).filter(|&i| i != own);
            Some(std::iter::once(own).chain(others).map(|i| i as u32).collect())
        }
        _ => None,
    }
}

fn call(op: Op, args: &[Known]) -> Known {
    let row = op.row();
    let result = Scalar::of(&row.result);
    if let (Known::Exact(_), "if") = (args[0], row.name) {
        // What is not chosen matters to nobody.
        let chosen = if args[0] == Known::Exact(0) { args[2] } else { args[1] };
        return chosen;
    }
    let lists: Option<Vec<Vec<u32>>> = row.args.iter().zip(args).map(|(t, a)| candidates(t, *a)).collect();
    let (Some(cpu), Some(lists)) = (row.cpu, lists) else { return unknown(result) };
    if touches_a_jump(row.name, args) {
        return unknown(result);
    }
    let mut outcomes = vec![Vec::new()];
    for list in &lists {
        let longer = |(before, word): (&Vec<u32>, &u32)| [before.as_slice(), &[*word]].concat();
        outcomes = outcomes.iter().flat_map(|b| list.iter().map(move |w| (b, w))).map(longer).collect();
    }
    let words: Option<Vec<u32>> = outcomes.iter().map(|words| cpu.word(words)).collect();
    let Some(words) = words else { return unknown(result) };
    if result != Scalar::Float {
        let own = words[0] as i32;
        let (low, high) = words.iter().fold((own, own), |(l, h), &w| (l.min(w as i32), h.max(w as i32)));
        // Of a hash nothing is known between two values.
        return match low == high {
            true => Known::Exact(words[0]),
            false if row.name.ends_with('#') => Known::Any,
            false => Known::Between { own, low, high },
        };
    }
    let value = f32::from_bits(words[0]);
    let moved = words.iter().map(|w| distance(f32::from_bits(*w), value)).fold(0.0, f32::max);
    if !value.is_finite() {
        return Known::near(value, moved);
    }
    let own = rounding(row.name, row.wgsl, value);
    if moved == 0.0 && own == 0.0 { Known::Exact(words[0]) } else { Known::near(value, moved * 1.01 + own) }
}

/// Whether between the candidates lies something that they do not show.
fn touches_a_jump(name: &str, args: &[Known]) -> bool {
    let radius = |k: &Known| if let Known::Near { radius, .. } = k { *radius } else { 0.0 };
    let value = |k: &Known| match *k {
        Known::Near { value, .. } => value,
        Known::Exact(word) => f32::from_bits(word),
        Known::Between { .. } | Known::Any => 0.0,
    };
    match (name, args) {
        // Two floats that may be equal, or not.
        ("==" | "!=", [a, b]) if radius(a) + radius(b) > 0.0 => {
            (value(a) - value(b)).abs() <= radius(a) + radius(b)
        }
        ("/", [_, b]) if radius(b) > 0.0 => value(b).abs() <= radius(b),
        // More than part of a period.
        ("sin" | "cos" | "tan" | "noise #", _) => args.iter().any(|a| radius(a) > 0.5),
        _ => false,
    }
}

/// What the operation itself may add, on this machine and on another. Ours are correctly rounded;
/// drivers divide within 2.5 units and may flush denormals; the elementary functions are sums and
/// products of their own.
fn rounding(name: &str, wgsl: &str, value: f32) -> f32 {
    match name {
        "abs" | "min" | "max" | "clamp" | "floor" | "ceil" | "round" | "trunc" | "sign" | "if" | "float"
        | "unit #" => 0.0,
        // Bits are changed, or picked.
        "-" if wgsl.starts_with("negative") => 0.0,
        "pow" => 64.0 * EPSILON * value.abs() * (1.0 + value.abs().max(f32::MIN_POSITIVE).ln().abs()),
        _ if wgsl.starts_with("portable_") || wgsl.starts_with("gradient_noise") => {
            64.0 * EPSILON * value.abs().max(1.0)
        }
        _ => 8.0 * EPSILON * value.abs() + f32::MIN_POSITIVE,
    }
}

/// The rule ids that a conforming machine may give a module, and whether all that decides between them is bounded.
pub fn possible_rules(stage: &Stage, module: &Module) -> (Vec<u32>, bool) {
    let mut bounded = true;
    let symbol = (module.record[0] & 0xffff) as usize;
    let mut possible = Vec::new();
    for &id in &stage.by_symbol[symbol] {
        let (rule, code) = (&stage.rules[id], &stage.code.rules[id]);
        let known = evaluate(&code.graph, module);
        let guards = |word: u32| code.guards.iter().filter(|g| known[**g] == Known::Exact(word)).count();
        if guards(0) > 0 {
            continue;
        }
        bounded &= code.guards.iter().chain(&code.choice).all(|&g| known[g].is_bounded());
        let sure = guards(1) == code.guards.len();
        let drawn = match code.choice.map(|c| known[c]) {
            None => vec![0],
            Some(Known::Exact(n)) => vec![n as usize],
            Some(_) => (0..rule.productions.len()).collect(),
        };
        for n in drawn {
            let args = code.unchanged[n].as_deref();
            let all = |test: &dyn Fn(Known, u32) -> bool| {
                args.is_some_and(|a| a.iter().all(|&(node, at)| test(known[node], module.record[at])))
            };
            let decide = |&(node, _): &(usize, usize)| known[node].is_bounded();
            bounded &= args.is_none_or(|a| a.iter().all(decide));
            if all(&Known::allows) {
                possible.push(stage.idle(symbol));
            }
            if !all(&Known::forces) {
                possible.push(rule.productions.start as u32 + n as u32);
            }
        }
        if sure {
            return (possible, bounded);
        }
    }
    possible.push(stage.idle(symbol));
    (possible, bounded)
}

/// How far each word of a module's measured attributes may be off: so many roundings of the greatest
/// coordinate, of the products that an area sums, of what a point on the screen is divided from.
pub fn spread(row: &Row, net: &[[f32; 4]], rational: bool, view: &[u32]) -> Vec<f32> {
    let n = net.len() as f32;
    let weight = |p: &[f32; 4]| if rational { p[3].abs() } else { 1.0 };
    let size = net.iter().map(|p| greatest(&p[..3]) / weight(p)).fold(0.0, f32::max);
    let rounding = EPSILON * size + f32::MIN_POSITIVE;
    let area = n * 256.0 * rounding * size;
    let (bbox_px, area_px) = if row.place("bbox_px").or(row.place("area_px")).is_some() {
        on_screen(net, view)
    } else {
        (0.0, 0.0)
    };
    let radius = |name: &str| match name {
        "centroid" => (2.0 * n + 16.0) * rounding,
        "area" => area,
        "bbox_px" => bbox_px,
        "area_px" => area_px,
        "uv" => 4.0 * EPSILON,
        // Lengths of differences.
        _ => 64.0 * rounding,
    };
    let mut spread = Vec::with_capacity(row.words);
    for (place, measure) in row.places.iter().zip(super::measure::MEASURES) {
        if place.is_some() {
            spread.extend(std::iter::repeat_n(radius(measure.name), measure.words));
        }
    }
    spread
}

fn greatest(list: &[f32]) -> f32 {
    list.iter().map(|x| x.abs()).fold(0.0, f32::max)
}

/// The same of a length and of an area in pixels.
fn on_screen(net: &[[f32; 4]], view: &[u32]) -> (f32, f32) {
    let word = |at: usize| f32::from_bits(view.get(at).copied().unwrap_or(0));
    let half = word(16).max(word(17)) * 0.5;
    let mut error = 0f32;
    let mut reach = 0f32;
    for p in net {
        let row = |r: usize| [0, 1, 2, 3].map(|c| word(4 * c + r) * p[c]);
        let sum = |r: usize| row(r).iter().sum::<f32>();
        let rounding = |r: usize| 16.0 * EPSILON * row(r).iter().map(|x| x.abs()).sum::<f32>();
        let w = sum(3).abs() - rounding(3);
        if w <= 0.0 {
            return (f32::INFINITY, f32::INFINITY);
        }
        let place = sum(0).abs().max(sum(1).abs()) / w;
        let moved = (rounding(0).max(rounding(1)) + place * rounding(3)) / w + 8.0 * EPSILON * place;
        error = error.max(half * moved);
        reach = reach.max(half * place);
    }
    (4.0 * error, 16.0 * net.len() as f32 * error * (reach + error))
}
