//! Two backends in lockstep: every column of every pass compared.
//!
//! Integers and nets must be equal, and what comes of floats within the bound of [`super::bound`].
//! Where a condition lies nearer to its threshold than that, and the two decide it differently, the
//! left one does the step once more with the right one's rules; where floats differ it goes on from
//! the right one's. So no difference is carried from step to step, and each is held to one step's
//! bound.

use super::Plan;
use super::bound::{self, Known, Module};
use super::columns::{Content, Stored};
use super::derive::{Backend, Outcome, StageId};
use super::given::Given;
use super::links::Links;
use super::step::Clock;
use super::tables::Stage;
use super::turtle;
use crate::language::expr::Value;
use std::sync::Arc;

/// What the passes of one sweep wrote, for comparison: the columns of [`super::step::Column`].
/// Columns of passes that were skipped stay empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    pub attributes: Vec<u32>,
    pub rules: Vec<u32>,
    pub counts: Vec<u32>,
    pub offsets: Vec<u32>,
    pub retired: Vec<u32>,
}

/// What a backend answers that was not asked to trace.
pub static UNTRACED: Trace = Trace {
    attributes: Vec::new(),
    rules: Vec::new(),
    counts: Vec::new(),
    offsets: Vec::new(),
    retired: Vec::new(),
};

/// A backend that can be asked what its passes wrote.
pub trait Traced: Backend {
    /// The columns of the last sweep; empty unless [`Traced::set_traced`] asked for them.
    fn trace(&self) -> &Trace;
    /// Keep what the passes write from now on.
    fn set_traced(&mut self);
}

/// A backend that can do a step with what another has measured and matched.
pub trait Replay: Traced {
    /// A sweep as [`Backend::step`] does it, with these attributes and rules in place of its own.
    fn replay(
        &mut self,
        stage: StageId,
        clock: Clock,
        chunk: &Self::Chunk,
        room: u64,
        trace: &Trace,
    ) -> Result<Outcome<Self::Chunk>, Self::Error>;
    /// The records of a chunk with those beside it.
    fn window(&self, chunk: &Self::Chunk) -> Vec<u32>;
    /// What contexts saw in the last sweep, if its word was linked.
    fn links(&self) -> Links;
    /// Modules of a curve's word before the chunk, and from its first to the end.
    fn around(&self, chunk: &Self::Chunk) -> [usize; 2];
    /// The environment of a stage.
    fn environment(&self, stage: StageId) -> Vec<u32>;
}

/// The first place where two backends differ.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{pass}, sweep {sweep}: {place} is {left} on the {left_name} and {right} on the {right_name}")]
pub struct Difference {
    /// The pass that wrote it.
    pub pass: &'static str,
    /// Sweeps before it, over all chunks and steps.
    pub sweep: usize,
    /// The module of the chunk, and what of it, as a noun phrase.
    pub place: String,
    pub left: String,
    pub right: String,
    pub left_name: &'static str,
    pub right_name: &'static str,
}

/// Why a comparison ended.
#[derive(Debug, thiserror::Error)]
pub enum PairError<L, R> {
    #[error(transparent)]
    Plan(#[from] super::Error),
    #[error(transparent)]
    Left(L),
    #[error(transparent)]
    Right(R),
    #[error(transparent)]
    Difference(Box<Difference>),
}

/// Two backends as one: it does everything on both and compares.
pub struct Pair<L: Replay, R: Traced> {
    plan: Arc<Plan>,
    left: L,
    right: R,
    names: [&'static str; 2],
    /// Sweeps compared so far.
    pub sweeps: usize,
    /// Elements (words of columns, records and nets) compared so far.
    pub elements: u64,
    /// How far floats were apart at most, as a part of what is allowed.
    pub rounding: f32,
    /// Modules for which a condition near its threshold fell differently.
    pub replayed: u64,
    given: Arc<Given>,
    /// The greatest coordinate of the turtle in this word so far.
    reach: f32,
}

type ChunksOf<L, R> = (<L as Backend>::Chunk, <R as Backend>::Chunk);
type ErrorOf<L, R> = PairError<<L as Backend>::Error, <R as Backend>::Error>;

impl<L: Replay, R: Traced> Pair<L, R> {
    /// A pair whose messages use these names; both must be of one plan.
    pub fn new(mut left: L, mut right: R, names: [&'static str; 2]) -> Self {
        left.set_traced();
        right.set_traced();
        Pair {
            plan: left.plan().clone(),
            left,
            right,
            names,
            sweeps: 0,
            elements: 0,
            rounding: 0.0,
            replayed: 0,
            given: Arc::default(),
            reach: 0.0,
        }
    }

    fn same<T: PartialEq + Copy>(
        &mut self,
        pass: &'static str,
        left: &[T],
        right: &[T],
        place: impl Fn(usize) -> String,
        show: impl Fn(T) -> String,
    ) -> Result<(), ErrorOf<L, R>> {
        self.elements += left.len() as u64;
        let differ = left.iter().zip(right).position(|(a, b)| a != b);
        let index = match differ {
            None if left.len() == right.len() => return Ok(()),
            None => left.len().min(right.len()),
            Some(index) => index,
        };
        let text = |column: &[T]| column.get(index).map_or("missing".to_string(), |v| show(*v));
        Err(PairError::Difference(Box::new(Difference {
            pass,
            sweep: self.sweeps,
            place: place(index),
            left: text(left),
            right: text(right),
            left_name: self.names[0],
            right_name: self.names[1],
        })))
    }

    /// All columns, to the bit.
    fn same_modules(
        &mut self,
        pass: &'static str,
        left: &Content,
        right: &Content,
    ) -> Result<(), ErrorOf<L, R>> {
        let plan = &*self.plan.clone();
        let points = plan.tables.layout.net_points();
        for column in Stored::ALL {
            let place = |at: usize| match column {
                Stored::Records => place_in_records(plan, left.records(), at),
                Stored::Nets => {
                    let (point, component) = (at / 4, ["xw", "yw", "zw", "w"][at % 4]);
                    format!("{component} of point {} of module {}", point % points, point / points)
                }
            };
            let show = |word: u32| match column {
                Stored::Records => format!("{word:#x}"),
                Stored::Nets => format!("{:?}", f32::from_bits(word)),
            };
            self.same(pass, &left[column], &right[column], place, show)?;
        }
        Ok(())
    }

    fn read_both(&mut self, left: &L::Chunk, right: &R::Chunk) -> Result<(Content, Content), ErrorOf<L, R>> {
        let left = self.left.read(left).map_err(PairError::Left)?;
        Ok((left, self.right.read(right).map_err(PairError::Right)?))
    }

    /// Whether a word of this machine may be another one there.
    /// A difference that nothing bounds is one.
    fn allows(&mut self, known: Known, own: u32, other: u32) -> bool {
        if let Known::Near { radius, .. } = known
            && radius > 0.0
        {
            let apart = bound::distance(f32::from_bits(own), f32::from_bits(other));
            if apart <= radius && radius.is_finite() {
                self.rounding = self.rounding.max(apart / radius);
            }
        }
        known.is_bounded() && known.allows(other)
    }

    /// Compares what was measured and matched. True where the two may, and do, differ: then the left
    /// one has to do the sweep again with what the right one found.
    fn settle(&mut self, id: StageId, clock: Clock, chunk: &L::Chunk) -> Result<bool, ErrorOf<L, R>> {
        let (own, other) = (self.left.trace().clone(), self.right.trace().clone());
        self.elements += (own.attributes.len() + own.rules.len()) as u64;
        let lengths = |t: &Trace| [t.attributes.len(), t.rules.len()];
        self.same("measure", &lengths(&own), &lengths(&other), whole, |n| format!("{n} words"))?;
        let [before, behind] = self.left.around(chunk);
        let turtle = id.of(&self.plan).row.turtle;
        if turtle {
            let reach = if before == 0 { 0.0 } else { self.reach };
            self.reach = reach.max(turtle::reach(&own.attributes));
        }
        if own.attributes == other.attributes && own.rules == other.rules {
            return Ok(false);
        }
        let plan = &*self.plan.clone();
        let (stage, layout) = (id.of(plan), plan.tables.layout);
        let content = self.left.read(chunk).map_err(PairError::Left)?;
        let (records, nets) = (content.records(), content.nets());
        let environment = self.left.environment(id);
        let window = self.left.window(chunk);
        let links = self.left.links();
        let linked = plan.tables.linked(records, &links);
        let given = self.given.clone();
        let view = &environment[plan.tables.given.view()..];
        let row = stage.row.words;
        for (i, record) in records.chunks_exact(layout.record_words).enumerate() {
            let of_row = |t: &Trace| i * row..(i * row + row).min(t.attributes.len());
            let (measured, theirs) = (&own.attributes[of_row(&own)], &other.attributes[of_row(&other)]);
            let rules = [&own, &other].map(|t| t.rules.get(i).copied().unwrap_or(0));
            if measured == theirs && rules[0] == rules[1] {
                continue;
            }
            let net = &nets[i * layout.net_points()..][..layout.net_points()];
            let spread = match turtle {
                true => turtle::spread(before + i + 1, self.reach).to_vec(),
                false => bound::spread(&stage.row, net, plan.rational(), view),
            };
            let float = |w: u32| format!("{:?}", f32::from_bits(w));
            for (n, (&a, &b)) in measured.iter().zip(theirs).enumerate() {
                let value = f32::from_bits(a);
                if a != b && !self.allows(Known::Near { value, radius: spread[n] }, a, b) {
                    let place = |_| format!("word {n} of the attributes of module {i}");
                    let pass = if turtle { "turtle" } else { "measure" };
                    self.same(pass, &[a], &[b], place, float)?;
                }
            }
            if rules[0] != rules[1] {
                let (given, environment) = (given.words.as_slice(), environment.as_slice());
                let at = (layout.halo() + i) * layout.record_words;
                let (spread, window) = (&spread[..], &window[..]);
                let behind = (behind - i) as u32;
                let module = Module {
                    record,
                    window,
                    at,
                    behind,
                    environment,
                    given,
                    measured,
                    spread,
                    clock,
                    linked,
                    index: i as u32,
                };
                let (possible, bounded) = bound::possible_rules(stage, &module);
                if !bounded || !possible.contains(&rules[1]) {
                    let place = |_| format!("the rule of module {i}");
                    self.same("match_modules", &rules[..1], &rules[1..], place, |w| w.to_string())?;
                }
                self.replayed += 1;
            }
        }
        Ok(true)
    }

    /// The right records with the left's floats where both are right: what the rules made of floats.
    fn within_bounds(
        &mut self,
        id: StageId,
        clock: Clock,
        (parents, window): (&[u32], &[u32]),
        left: &[u32],
        mut right: Vec<u32>,
    ) -> Vec<u32> {
        let plan = &*self.plan.clone();
        let (stage, words) = (id.of(plan), plan.tables.layout.record_words);
        let trace = self.left.trace().clone();
        let environment = self.left.environment(id);
        let given = self.given.clone();
        let links = self.left.links();
        let linked = plan.tables.linked(parents, &links);
        for (n, (own, other)) in left.chunks_exact(words).zip(right.chunks_exact_mut(words)).enumerate() {
            if own == other {
                continue;
            }
            let Some((i, rule, cell)) = origin(stage, &trace, parents, words, n) else { continue };
            let row = stage.row.words;
            let module = Module {
                record: &parents[i * words..][..words],
                window,
                at: (plan.tables.layout.halo() + i) * words,
                // No child is made of it.
                behind: 0,
                environment: &environment,
                given: &given.words,
                measured: trace.attributes.get(i * row..i * row + row).unwrap_or(&[]),
                spread: &[],
                clock,
                linked,
                index: i as u32,
            };
            let code = &stage.code.children[rule];
            let known = bound::evaluate(&code.graph, &module);
            for &(node, at) in code.args[cell].iter().filter(|arg| Some(arg.1) != plan.tables.layout.link) {
                if own[at] != other[at] && self.allows(known[node], own[at], other[at]) {
                    other[at] = own[at];
                }
            }
        }
        right
    }

    fn same_trace(&mut self) -> Result<(), ErrorOf<L, R>> {
        let (left, right) = (self.left.trace().clone(), self.right.trace().clone());
        let of_module = |what: &'static str| move |i| format!("the {what} of module {i}");
        let number = |w: u32| w.to_string();
        self.same("count", &left.counts, &right.counts, of_module("count"), number)?;
        self.same("scan", &left.offsets, &right.offsets, of_module("offset"), number)?;
        self.same("compact", &left.retired, &right.retired, |i| format!("retired module {i}"), number)
    }
}

impl<L: Replay, R: Traced> Backend for Pair<L, R> {
    type Chunk = (L::Chunk, R::Chunk);
    type Error = ErrorOf<L, R>;

    fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    fn bind(&mut self, uniforms: &[Value], given: &Given) -> Result<(), Self::Error> {
        self.given = Arc::new(given.clone());
        self.left.bind(uniforms, given).map_err(PairError::Left)?;
        self.right.bind(uniforms, given).map_err(PairError::Right)
    }

    fn upload(&mut self, content: Content) -> Result<Self::Chunk, Self::Error> {
        let left = self.left.upload(content.clone()).map_err(PairError::Left)?;
        Ok((left, self.right.upload(content).map_err(PairError::Right)?))
    }

    fn read(&mut self, chunk: &Self::Chunk) -> Result<Content, Self::Error> {
        let (left, right) = self.read_both(&chunk.0, &chunk.1)?;
        self.same_modules("read", &left, &right)?;
        Ok(left)
    }

    fn len(&self, chunk: &Self::Chunk) -> usize {
        self.left.len(&chunk.0)
    }

    fn most_modules(&self) -> usize {
        self.left.most_modules().min(self.right.most_modules())
    }

    fn split(&mut self, chunk: Self::Chunk, most: usize) -> Result<Vec<Self::Chunk>, Self::Error> {
        let left = self.left.split(chunk.0, most).map_err(PairError::Left)?;
        let right = self.right.split(chunk.1, most).map_err(PairError::Right)?;
        Ok(left.into_iter().zip(right).collect())
    }

    fn join(&mut self, chunks: Vec<Self::Chunk>, ring: bool) -> Result<Vec<Self::Chunk>, Self::Error> {
        let (left, right): (Vec<_>, Vec<_>) = chunks.into_iter().unzip();
        let left = self.left.join(left, ring).map_err(PairError::Left)?;
        let right = self.right.join(right, ring).map_err(PairError::Right)?;
        Ok(left.into_iter().zip(right).collect())
    }

    fn recycle(&mut self, chunk: Self::Chunk) {
        self.left.recycle(chunk.0);
        self.right.recycle(chunk.1);
    }

    fn finish(&mut self) -> Result<(), Self::Error> {
        self.left.finish().map_err(PairError::Left)?;
        self.right.finish().map_err(PairError::Right)
    }

    fn step(
        &mut self,
        stage: StageId,
        clock: Clock,
        chunk: &Self::Chunk,
        room: u64,
    ) -> Result<Outcome<Self::Chunk>, Self::Error> {
        let mut left = self.left.step(stage, clock, &chunk.0, room).map_err(PairError::Left)?;
        let right = self.right.step(stage, clock, &chunk.1, room).map_err(PairError::Right)?;
        if self.settle(stage, clock, &chunk.0)? {
            let theirs = self.right.trace().clone();
            left = self.left.replay(stage, clock, &chunk.0, room, &theirs).map_err(PairError::Left)?;
        }
        self.same_trace()?;
        let outcome = match (left, right) {
            (
                Outcome::Done { next: a, retired: b, fired: c },
                Outcome::Done { next: d, retired: e, fired: f },
            ) => {
                self.same("match_modules", &[c], &[f], whole, |fired| format!("fired = {fired}"))?;
                let symbols = |s: Option<u32>| s.map_or("nothing".to_string(), |s| format!("symbols {s:#x}"));
                let retired = |r: Option<u32>| [r];
                self.same(
                    "retire",
                    &retired(b.as_ref().map(|b| b.1)),
                    &retired(e.as_ref().map(|e| e.1)),
                    whole,
                    symbols,
                )?;
                let next = self.both("emit", a, d, Some((stage, clock, &chunk.0)))?;
                let mask = b.as_ref().map_or(0, |b| b.1);
                let retired = self.both("retire", b.map(|b| b.0), e.map(|e| e.0), None)?.map(|c| (c, mask));
                Outcome::Done { next, retired, fired: c }
            }
            (Outcome::NoRoom { needed, modules }, Outcome::NoRoom { needed: other, .. }) => {
                self.same("scan", &[needed], &[other], whole, |n| format!("{n} bytes"))?;
                Outcome::NoRoom { needed, modules }
            }
            (Outcome::TooDeep, Outcome::TooDeep) => Outcome::TooDeep,
            (left, right) => {
                let name = |n: usize| ["done", "out of room", "too deep"][n];
                self.same("emit", &[kind(&left)], &[kind(&right)], whole, |n| name(n).to_string())?;
                return Ok(Outcome::TooDeep);
            }
        };
        self.sweeps += 1;
        Ok(outcome)
    }
}

/// The place of what is said of all modules at once.
fn whole(_: usize) -> String {
    "the chunk".to_string()
}

/// The module, and the field of its record, that a word belongs to.
fn place_in_records(plan: &Plan, records: &[u32], at: usize) -> String {
    let layout = &plan.tables.layout;
    let words = layout.record_words;
    let (module, word) = (at / words, at % words);
    let header = plan.tables.kind.header(layout);
    let Some(record) = records.get(module * words..(module + 1) * words) else {
        return format!("word {word} of module {module}");
    };
    let symbol = plan.tables.symbols.get((record[0] & 0xffff) as usize);
    let field = symbol.and_then(|s| {
        let mut fields = s.fields.iter().zip(&s.words);
        fields.find(|(f, first)| (**first..**first + f.ty.words()).contains(&word))
    });
    match (header.get(word), field) {
        (Some(name), _) => format!("{name} of module {module}"),
        (None, Some((field, _))) => format!("parameter {} of module {module}", field.name),
        (None, None) => format!("word {word} of module {module}"),
    }
}

/// Of child `n` the parent, the rule that made it, and the cell; none where it is a copy.
fn origin(
    stage: &Stage,
    trace: &Trace,
    parents: &[u32],
    words: usize,
    n: usize,
) -> Option<(usize, usize, usize)> {
    let (parent, rule, nth) = match stage.closed {
        Some(growth) => {
            let parent = n / growth as usize;
            let symbol = parents[parent * words] & 0xffff;
            (parent, stage.unconditional(symbol as usize)?, n % growth as usize)
        }
        None => {
            let parent = trace.offsets.partition_point(|&o| o as usize <= n).checked_sub(1)?;
            (parent, trace.rules[parent] as usize, n - trace.offsets[parent] as usize)
        }
    };
    let production = stage.productions.get(rule)?;
    let (cell, _) = production.successors().nth(nth)?;
    Some((parent, rule, cell))
}

fn kind<C>(outcome: &Outcome<C>) -> usize {
    match outcome {
        Outcome::Done { .. } => 0,
        Outcome::NoRoom { .. } => 1,
        Outcome::TooDeep => 2,
    }
}

impl<L: Replay, R: Traced> Pair<L, R> {
    /// The chunks of both, compared; where only one has modules, that is the difference. `parents`
    /// says what they are made of, where they are not copies.
    fn both(
        &mut self,
        pass: &'static str,
        left: Option<L::Chunk>,
        right: Option<R::Chunk>,
        parents: Option<(StageId, Clock, &L::Chunk)>,
    ) -> Result<Option<ChunksOf<L, R>>, ErrorOf<L, R>> {
        let lengths =
            (left.as_ref().map_or(0, |c| self.left.len(c)), right.as_ref().map_or(0, |c| self.right.len(c)));
        self.same(pass, &[lengths.0], &[lengths.1], whole, |n| format!("{n} modules"))?;
        match (left, right) {
            (Some(mut l), Some(r)) => {
                let (left, mut right) = self.read_both(&l, &r)?;
                let differ = left.records() != right.records();
                let Some((id, clock, chunk)) = parents.filter(|_| differ) else {
                    self.same_modules(pass, &left, &right)?;
                    return Ok(Some((l, r)));
                };
                let parents = self.left.read(chunk).map_err(PairError::Left)?;
                let window = self.left.window(chunk);
                let theirs = right.records().to_vec();
                let around = (parents.records(), &window[..]);
                right[Stored::Records] =
                    self.within_bounds(id, clock, around, left.records(), theirs.clone());
                self.same_modules(pass, &left, &right)?;
                right[Stored::Records] = theirs;
                self.left.recycle(l);
                l = self.left.upload(right).map_err(PairError::Left)?;
                Ok(Some((l, r)))
            }
            _ => Ok(None),
        }
    }
}
