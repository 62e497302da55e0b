//! The turtle: `trace into P` as rules, and what its symbols do to it.
//!
//! A trace is one step of rules that no file writes: `F` and `f` become the point where the turtle stands behind
//! them, all else becomes nothing, and before the first module of an open word stands the point at which it starts. In a
//! ring the last point would be the first again; there each move becomes the point *before* it. So matching,
//! counting, scanning and writing are those of every step.
//!
//! What the rules read is measured by the pass `turtle`: a row of four words a module, where it stands and how wide it
//! drew on its way there. Every module is a rigid motion ([`Command`]), and the turtle's state behind it is the composition of all up to
//! it, a scan. In a word with links ([`super::layout`]) it is the state of the module that it hangs on, and its own
//! motion.
//!
//! **Accuracy.** Turns are quaternions of any length, which for right angles are whole numbers: a word that turns by
//! multiples of 90° and moves by whole numbers is traced without any rounding, the same on every machine, as long as
//! coordinates are below 2²². Every other turn is rounded, and what it is off is carried on. [`bound`] is
//! what may be relied on, were all roundings of one sign. They are not: after n modules of Koch's curve, of a dragon whose
//! folds are not right, of a random path in space, no coordinate is off by more than 4·ε·√n of the greatest one, which
//! the tests measure over a million moves.

use super::Plan;
use super::context::{Near, Place};
use super::layout::{END, NONE};
use super::tables::{Becomes, MatchRule, Production, RulesOf, Successor, Symbol, Tables};
use crate::language::Span;
use crate::language::expr::{Expr, ExprKind, Type, Value};
use crate::language::system::{Hang, Kind, System, Topology};

/// Words a module: x, y, z, width.
pub const ROW_WORDS: usize = 4;

/// Words of a motion in memory: the quaternion x, y, z, w; the shift x, y, z; the width; the width of its last move; and three
/// that are not used.
pub const MOTION_WORDS: usize = 12;

/// In place of a width: the motion sets none, or does not move. No width that a number says has these bits.
pub const UNSET: u32 = u32::MAX;

/// In place of the width of the last move: the one that was set before the motion.
pub const INHERITED: u32 = u32::MAX - 1;

/// The motion that changes nothing.
pub const STILL: [u32; MOTION_WORDS] = [0, 0, 0, 1f32.to_bits(), 0, 0, 0, UNSET, UNSET, 0, 0, 0];

/// The attributes by which the rules name the row; no file can.
const POSITION: &str = "position #";
const WIDTH: &str = "width #";

/// Where an attribute of the turtle stands in the row.
pub fn place(attribute: &str) -> Option<usize> {
    match attribute {
        POSITION => Some(0),
        WIDTH => Some(3),
        _ => None,
    }
}

/// What a symbol does to the turtle, by its one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Moves along its heading.
    Move,
    /// Sets the width.
    Width,
    /// Turns by so many degrees about an axis of its own: 0 to its right, 1 its heading, 2 up.
    Turn { axis: usize, backwards: bool },
}

impl Command {
    /// That of a symbol of the turtle.
    pub fn of(symbol: &str) -> Option<Command> {
        let turn = |axis, backwards| Some(Command::Turn { axis, backwards });
        match symbol {
            "F" | "f" => Some(Command::Move),
            "!" => Some(Command::Width),
            "+" | "|" => turn(2, false),
            "-" => turn(2, true),
            "^" => turn(0, false),
            "&" => turn(0, true),
            "/" => turn(1, false),
            "\\" => turn(1, true),
            _ => None,
        }
    }

    /// Its number in the kernels; 0 is none.
    pub fn code(self) -> u32 {
        match self {
            Command::Move => 1,
            Command::Width => 2,
            Command::Turn { axis, backwards } => 4 + 2 * axis as u32 + u32::from(backwards),
        }
    }
}

/// What the pass `turtle` knows of a system.
#[derive(Clone, Debug, Default)]
pub struct Turtle {
    /// For each symbol.
    pub commands: Vec<Option<Command>>,
    /// The word of a record that holds their argument.
    pub argument: usize,
    /// The row is the state before the module, not behind it.
    pub before: bool,
}

impl Turtle {
    pub fn new(system: &System, symbols: &[Symbol]) -> Turtle {
        let Kind::Curve(topology) = system.kind else { return Turtle::default() };
        let commands: Vec<Option<Command>> = symbols.iter().map(|s| Command::of(&s.name)).collect();
        let argument = symbols.iter().zip(&commands).find(|(_, command)| command.is_some());
        Turtle {
            argument: argument.and_then(|(s, _)| s.words.first().copied()).unwrap_or(0),
            before: topology == Topology::Ring,
            commands,
        }
    }
}

/// The rules of `trace into` a symbol, by priority.
pub fn rules(system: &System, symbols: &[Symbol], into: usize) -> Vec<(MatchRule, Vec<Production>)> {
    let span = system.source.name.span;
    let start = point(symbols, into, span, &|ty| zero(ty, span), number(1.0, span));
    let start = Successor { hang: Hang { root: true, ..Hang::default() }, ..start };
    let here = |ty: &Type| match ty {
        Type::Vec2 => {
            let component = |n| {
                let position = Box::new(attribute(POSITION, Type::Vec3, span));
                Expr { ty: Type::Float, kind: ExprKind::Component(position, n), span }
            };
            Expr { ty: Type::Vec2, kind: ExprKind::Vector(vec![component(0), component(1)]), span }
        }
        _ => attribute(POSITION, Type::Vec3, span),
    };
    let here = point(symbols, into, span, &here, attribute(WIDTH, Type::Float, span));
    let mut rules = Vec::new();
    for (predecessor, symbol) in symbols.iter().enumerate() {
        let moves = Command::of(&symbol.name) == Some(Command::Move);
        // A move without drawing begins a new curve.
        let hang = Hang { root: symbol.name == "f", ..Hang::default() };
        let points: Vec<Successor> = moves.then(|| Successor { hang, ..here.clone() }).into_iter().collect();
        if let Some(context) = first_of_curve(system) {
            // What hung on nothing hangs on the start, as does what hung on a first module that is no move.
            let exit = points.len().checked_sub(1).map(|_| 1);
            let second = |p: &Successor| Successor { hang: Hang { slot: 1, ..p.hang }, ..p.clone() };
            let points = [start.clone()].into_iter().chain(points.iter().map(second)).collect();
            rules.push(rule(predecessor, context, points, exit, span));
        }
        let exit = points.len().checked_sub(1);
        rules.push(rule(predecessor, Vec::new(), points, exit, span));
    }
    rules
}

/// What stands around a module before which the turtle starts; none in a ring, where no module has the start to itself.
fn first_of_curve(system: &System) -> Option<Vec<Near>> {
    (system.kind != Kind::Curve(Topology::Ring)).then(|| vec![Near { place: Place::Previous, symbol: END }])
}

fn rule(
    predecessor: usize,
    context: Vec<Near>,
    points: Vec<Successor>,
    exit: Option<usize>,
    span: Span,
) -> (MatchRule, Vec<Production>) {
    let rule = MatchRule {
        predecessor,
        others: Vec::new(),
        context,
        reads: Vec::new(),
        lets: Vec::new(),
        guards: Vec::new(),
        weights: Vec::new(),
        productions: 0..0,
        site: 0,
        span,
    };
    let becomes = Becomes::Word { modules: points, exit, relabels: false };
    let production = Production { rule: 0, predecessor, length: 1, becomes, span };
    (rule, vec![production])
}

/// A module of the traced word: the first vector is the position, and what else there is, the checker has seen to,
/// the width.
fn point(
    symbols: &[Symbol],
    into: usize,
    span: Span,
    position: &dyn Fn(&Type) -> Expr,
    width: Expr,
) -> Successor {
    let fields = &symbols[into].fields;
    let vector = fields.iter().position(|f| matches!(f.ty, Type::Vec2 | Type::Vec3));
    let arg = |(n, ty): (usize, &Type)| match Some(n) == vector {
        true => position(ty),
        false => Expr { span, ..width.clone() },
    };
    let args = fields.iter().map(|f| &f.ty).enumerate().map(arg).collect();
    Successor { symbol: into, args, hang: Hang::default() }
}

fn attribute(name: &'static str, ty: Type, span: Span) -> Expr {
    Expr { ty, kind: ExprKind::Attribute(name), span }
}

fn number(x: f32, span: Span) -> Expr {
    Expr::literal(Value::Float(x), span)
}

fn zero(ty: &Type, span: Span) -> Expr {
    let value = if *ty == Type::Vec2 { Value::Vec2([0.0; 2]) } else { Value::Vec3([0.0; 3]) };
    Expr::literal(value, span)
}

/// The record of the point at which the turtle starts: the word that is traced of no modules, or of a ring in which
/// nothing moves.
pub fn start(plan: &Plan, into: usize) -> Vec<u32> {
    let Tables { layout, symbols, .. } = &*plan.tables;
    let mut record = vec![0; layout.record_words];
    record[0] = into as u32;
    // In a ring it hangs on itself.
    if let (Some(link), false) = (layout.link, plan.is_ring()) {
        record[link] = NONE;
    }
    let symbol = &symbols[into];
    for (field, &at) in symbol.fields.iter().zip(&symbol.words) {
        if field.ty == Type::Float {
            record[at] = 1f32.to_bits();
        }
    }
    record
}

/// Whether nothing may be left of a word that was traced: an open one has a start, if it has a module.
pub fn may_be_empty(plan: &Plan) -> bool {
    let written = plan.tables.rule_sets.iter().filter(|set| matches!(set.of, RulesOf::Groups(_)));
    let mut productions = written.flat_map(|set| &set.stages).flat_map(|stage| &stage.productions);
    plan.is_ring() || productions.any(|p| p.count() == 0)
}

/// How far a coordinate may be off behind so many modules on any machine, where none of the positions so far has a
/// greater coordinate than `reach`: the roundings of every turn and move, were they all of one sign, and the distances
/// over which they are carried.
pub fn bound(modules: usize, reach: f32) -> f32 {
    f32::EPSILON * (64.0 + 16.0 * modules as f32) * reach + f32::MIN_POSITIVE
}

/// The same of the words of a module's row: the width is written, not worked out.
pub fn spread(modules: usize, reach: f32) -> [f32; ROW_WORDS] {
    let bound = bound(modules, reach);
    [bound, bound, bound, 0.0]
}

/// The greatest coordinate of these rows.
pub fn reach(rows: &[u32]) -> f32 {
    let coordinates = rows.chunks_exact(ROW_WORDS).flat_map(|row| &row[..3]);
    coordinates.map(|&word| f32::from_bits(word).abs()).fold(0.0, f32::max)
}
