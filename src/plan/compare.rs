//! Two backends in lockstep: every column of every pass compared.

use super::Plan;
use super::derive::{Backend, Modules, Outcome, StageId};
use super::given::Given;
use super::layout::Header;
use super::step::Clock;

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

/// How far float parameters may be apart, relative to the greater: compilers of shaders may factor
/// and reorder sums and products. Everything else must be equal to the bit.
pub const ROUNDING: f32 = 1e-4;

/// Two backends as one: it does everything on both and compares.
pub struct Pair<'a, L: Traced, R: Traced> {
    plan: &'a Plan,
    left: L,
    right: R,
    names: [&'static str; 2],
    /// Sweeps compared so far.
    pub sweeps: usize,
    /// Elements (words of columns, records and nets) compared so far.
    pub elements: u64,
    /// How far float parameters were apart at most, as a part of [`ROUNDING`].
    pub rounding: f32,
}

type ChunksOf<L, R> = (<L as Backend>::Chunk, <R as Backend>::Chunk);
type ErrorOf<L, R> = PairError<<L as Backend>::Error, <R as Backend>::Error>;

impl<'a, L: Traced, R: Traced> Pair<'a, L, R> {
    /// A pair whose messages use these names.
    pub fn new(plan: &'a Plan, mut left: L, mut right: R, names: [&'static str; 2]) -> Self {
        left.set_traced();
        right.set_traced();
        Pair { plan, left, right, names, sweeps: 0, elements: 0, rounding: 0.0 }
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

    fn same_chunk(
        &mut self,
        pass: &'static str,
        left: &L::Chunk,
        right: &R::Chunk,
    ) -> Result<(), ErrorOf<L, R>> {
        let (left_records, left_nets) = self.left.read(left).map_err(PairError::Left)?;
        let (right_records, right_nets) = self.right.read(right).map_err(PairError::Right)?;
        let right_records = self.within_rounding(&left_records, right_records);
        let plan = self.plan;
        let place = |at| place_in_records(plan, &left_records, at);
        self.same(pass, &left_records, &right_records, place, |w| format!("{w:#x}"))?;
        let bits = |nets: &[[f32; 4]]| -> Vec<u32> { nets.iter().flatten().map(|x| x.to_bits()).collect() };
        let points = plan.tables.layout.net_points();
        let place = |at| {
            let (point, component) = (at / 4, ["xw", "yw", "zw", "w"][at % 4]);
            format!("{component} of point {} of module {}", point % points, point / points)
        };
        self.same(pass, &bits(&left_nets), &bits(&right_nets), place, |w| format!("{:?}", f32::from_bits(w)))
    }

    /// The right records with the left's floats where these are near enough.
    fn within_rounding(&mut self, left: &[u32], mut right: Vec<u32>) -> Vec<u32> {
        let words = self.plan.tables.layout.record_words;
        for (left, right) in left.chunks_exact(words).zip(right.chunks_exact_mut(words)) {
            let symbol = Header::read(left).symbol as usize;
            for at in self.plan.tables.symbols.get(symbol).iter().flat_map(|s| s.float_words()) {
                let (a, b) = (f32::from_bits(left[at]), f32::from_bits(right[at]));
                let (apart, allowed) = ((a - b).abs(), ROUNDING * a.abs().max(b.abs()));
                if apart > 0.0 && apart <= allowed {
                    self.rounding = self.rounding.max(apart / allowed);
                }
                if apart <= allowed || a.is_nan() && b.is_nan() {
                    right[at] = left[at];
                }
            }
        }
        right
    }

    fn same_trace(&mut self) -> Result<(), ErrorOf<L, R>> {
        let (left, right) = (self.left.trace().clone(), self.right.trace().clone());
        let of_module = |what: &'static str| move |i| format!("the {what} of module {i}");
        let number = |w: u32| w.to_string();
        self.same("match_modules", &left.rules, &right.rules, of_module("rule"), number)?;
        self.same("count", &left.counts, &right.counts, of_module("count"), number)?;
        self.same("scan", &left.offsets, &right.offsets, of_module("offset"), number)?;
        self.same("compact", &left.retired, &right.retired, |i| format!("retired module {i}"), number)
    }
}

impl<L: Traced, R: Traced> Backend for Pair<'_, L, R> {
    type Chunk = (L::Chunk, R::Chunk);
    type Error = ErrorOf<L, R>;

    fn bind(&mut self, given: &Given) -> Result<(), Self::Error> {
        self.left.bind(given).map_err(PairError::Left)?;
        self.right.bind(given).map_err(PairError::Right)
    }

    fn upload(&mut self, records: Vec<u32>, nets: Vec<[f32; 4]>) -> Result<Self::Chunk, Self::Error> {
        let left = self.left.upload(records.clone(), nets.clone()).map_err(PairError::Left)?;
        Ok((left, self.right.upload(records, nets).map_err(PairError::Right)?))
    }

    fn read(&mut self, chunk: &Self::Chunk) -> Result<Modules, Self::Error> {
        self.same_chunk("read", &chunk.0, &chunk.1)?;
        self.left.read(&chunk.0).map_err(PairError::Left)
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
        let left = self.left.step(stage, clock, &chunk.0, room).map_err(PairError::Left)?;
        let right = self.right.step(stage, clock, &chunk.1, room).map_err(PairError::Right)?;
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
                let next = self.both("emit", a, d)?;
                let mask = b.as_ref().map_or(0, |b| b.1);
                let retired = self.both("retire", b.map(|b| b.0), e.map(|e| e.0))?.map(|c| (c, mask));
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
    let words = plan.tables.layout.record_words;
    let (module, word) = (at / words, at % words);
    let header =
        ["symbol and halvings", "root", "high word of the key", "low word of the key", "row", "column"];
    let Some(record) = records.get(module * words..(module + 1) * words) else {
        return format!("word {word} of module {module}");
    };
    let symbol = plan.tables.symbols.get(Header::read(record).symbol as usize);
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

fn kind<C>(outcome: &Outcome<C>) -> usize {
    match outcome {
        Outcome::Done { .. } => 0,
        Outcome::NoRoom { .. } => 1,
        Outcome::TooDeep => 2,
    }
}

impl<L: Traced, R: Traced> Pair<'_, L, R> {
    /// The chunks of both, compared; where only one has modules, that is the difference.
    fn both(
        &mut self,
        pass: &'static str,
        left: Option<L::Chunk>,
        right: Option<R::Chunk>,
    ) -> Result<Option<ChunksOf<L, R>>, ErrorOf<L, R>> {
        let lengths =
            (left.as_ref().map_or(0, |c| self.left.len(c)), right.as_ref().map_or(0, |c| self.right.len(c)));
        self.same(pass, &[lengths.0], &[lengths.1], whole, |n| format!("{n} modules"))?;
        match (left, right) {
            (Some(l), Some(r)) => {
                self.same_chunk(pass, &l, &r)?;
                Ok(Some((l, r)))
            }
            _ => Ok(None),
        }
    }
}
