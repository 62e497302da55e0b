//! The derivation: the schedule run step by step over the chunks of a word, whatever the backend.
//!
//! A patch word has no contexts, so any range of its modules is an independent word: a *chunk*. A
//! step maps chunk to chunk. Chunks are split here, before a step, so that what a step may write
//! always fits in the buffers a backend can bind. Modules on which no rule of the running rule set
//! can ever fire again leave the frontier for the *finished* chunks, and come back when a later
//! derive names their symbol. The order of the word is restored by its keys at the end.

use super::columns::{Content, Stored};
use super::given::{Given, View};
use super::schedule::{self, Act, Rewrite};
use super::size::{self, Bounds, Endless};
use super::step::Clock;
use super::tables::{Stage, Tables};
use super::{Error, Plan, Settings, links, turtle};
use crate::language::expr::Value;
use crate::patch;
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub use super::collect::{Collected, collect};
pub use super::start::Start;

/// What a backend does with a chunk. The passes are those of [`super::step`].
pub trait Backend {
    /// The columns of some modules, wherever the backend keeps them.
    type Chunk;
    type Error: From<Error>;

    /// What it runs.
    fn plan(&self) -> &Arc<Plan>;
    /// The values of the plan's uniforms and what the host gives, for all chunks until others are bound. A backend
    /// begins with the params' defaults.
    fn bind(&mut self, uniforms: &[Value], given: &Given) -> Result<(), Self::Error>;
    /// A chunk of this content.
    fn upload(&mut self, content: Content) -> Result<Self::Chunk, Self::Error>;
    /// What a chunk holds, without what stands beside it.
    fn read(&mut self, chunk: &Self::Chunk) -> Result<Content, Self::Error>;
    /// Modules of the chunk.
    fn len(&self, chunk: &Self::Chunk) -> usize;
    /// Modules that one chunk can hold at most.
    fn most_modules(&self) -> usize;
    /// The chunk in pieces of at most `most` modules, in order.
    fn split(&mut self, chunk: Self::Chunk, most: usize) -> Result<Vec<Self::Chunk>, Self::Error>;
    /// Gives chunks that follow each other the records that stand beside them: of a ring, or of a word that ends.
    fn join(&mut self, chunks: Vec<Self::Chunk>, ring: bool) -> Result<Vec<Self::Chunk>, Self::Error>;
    /// The chunk is needed no more; what was recorded with it still runs.
    fn recycle(&mut self, chunk: Self::Chunk);
    /// Waits until everything is done.
    fn finish(&mut self) -> Result<(), Self::Error>;
    /// One sweep of the passes over a chunk, which stays as it is. `room` is how many bytes the new chunks may take:
    /// beyond it nothing is written, and the outcome says what was needed.
    fn step(
        &mut self,
        stage: StageId,
        clock: Clock,
        chunk: &Self::Chunk,
        room: u64,
    ) -> Result<Outcome<Self::Chunk>, Self::Error>;
}

/// A stage of the plan's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StageId {
    pub rule_set: usize,
    pub stage: usize,
}

impl StageId {
    /// The stage itself.
    pub fn of(self, plan: &Plan) -> &Stage {
        &plan.tables.rule_sets[self.rule_set].stages[self.stage]
    }
}

/// What came of a sweep.
pub enum Outcome<C> {
    /// What goes on, what is finished (with the symbols in it, bit s mod 32), whether a rule fired.
    Done { next: Option<C>, retired: Option<(C, u32)>, fired: bool },
    /// It would have taken this many bytes, for this many modules.
    NoRoom { needed: u64, modules: u64 },
    /// A child's address would not have fitted.
    TooDeep,
}

/// How a derivation is run.
#[derive(Clone)]
pub struct Options<'a> {
    /// Params by name; the others are their defaults.
    pub set: Vec<(String, Value)>,
    /// The values of queries without `=`, by name.
    pub bind: Vec<(String, patch::Values)>,
    /// What `bbox_px` and `area_px` are seen through.
    pub view: Option<View>,
    /// What random numbers begin with; none: the param `seed` of the system, if it has one of type int, else 0.
    pub seed: Option<u32>,
    /// Stop after this many steps in all.
    pub steps: Option<u32>,
    /// Bytes that the word, with what a step writes, may take.
    pub max_bytes: u64,
    /// Chunks of at most this many modules before every step.
    pub chunk_modules: Option<usize>,
    /// Looked at between chunks: true ends the derivation with [`Error::Stopped`].
    pub stop: Option<&'a AtomicBool>,
    /// Told after every step.
    pub progress: Option<&'a dyn Fn(Progress)>,
}

impl Default for Options<'_> {
    /// The system's own params and schedule, within 4 GiB.
    fn default() -> Self {
        Options {
            set: Vec::new(),
            bind: Vec::new(),
            view: None,
            seed: None,
            steps: None,
            max_bytes: 4 << 30,
            chunk_modules: None,
            stop: None,
            progress: None,
        }
    }
}

/// Where a derivation stands.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Steps done, and steps there may be in all.
    pub step: u32,
    pub of: u32,
    pub modules: u64,
    pub bytes: u64,
}

/// One step that was done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepStats {
    /// Modules of the word after the step.
    pub modules: u64,
    /// Wall-clock time. On a GPU steps that need no answer are only recorded; the wait falls on
    /// the next one that does.
    pub time: Duration,
}

/// The final word, or words, in chunks, and how it came about. [`collect`] reads it as a `W`.
pub struct Derivation<C, W> {
    pub chunks: Vec<C>,
    pub steps: Vec<StepStats>,
    pub peak_bytes: u64,
    /// Of the plan that it was derived by.
    pub(super) tables: Arc<Tables>,
    /// Words that were derived at once; 0 where it is one alone.
    pub(super) words: usize,
    of: PhantomData<fn() -> W>,
}

/// What came of a start, read, and how it came about.
pub type Derived<S, C> = (<S as Start>::Word, Derivation<C, <S as Start>::Word>);

/// What options come to for a plan and a start.
pub(crate) struct Asked {
    pub settings: Settings,
    /// Of several words at once what each runs with; else none.
    pub each: Vec<Settings>,
    pub schedule: Vec<Act>,
    pub given: Given,
}

impl Asked {
    pub fn of<S: Start>(plan: &Plan, start: &S, options: &Options) -> Result<Asked, Error> {
        let settings = plan.settings(&options.set, options.seed)?;
        let each = start.each(plan, options)?;
        let schedule = match each.split_first() {
            None => schedule::unroll(plan, &settings.uniforms)?,
            Some((first, others)) => schedule::of_all(plan, first, others)?,
        };
        let words = |values: &Settings| {
            values.uniforms.iter().flat_map(Value::words).chain([values.seed]).collect::<Vec<u32>>()
        };
        let words = each.iter().flat_map(words).collect();
        let given = Given::behind(words, &plan.system, start.roots(), &options.bind, options.view)?;
        Ok(Asked { settings, each, schedule, given })
    }
}

/// Runs the whole schedule of the backend's plan on `start`.
///
/// # Errors
/// What [`Plan::settings`], [`Given::new`] and [`Start::content`] say of the options and the start, and the backend.
pub fn derive<S: Start, B: Backend>(
    start: &S,
    options: &Options,
    backend: &mut B,
) -> Result<Derivation<B::Chunk, S::Word>, B::Error> {
    let plan = &*backend.plan().clone();
    let Asked { settings: values, each, schedule, given } = Asked::of(plan, start, options)?;
    backend.bind(&values.uniforms, &given)?;
    let content = start.content(plan, &values, &each)?;
    // What several words have in common.
    let common: &[Value] = match each.split_first() {
        None => &values.uniforms,
        Some((first, others)) if others.iter().all(|other| other.uniforms == first.uniforms) => {
            &first.uniforms
        }
        Some(_) => &[],
    };
    refuse_growth(plan, common, content.records(), &schedule, options)?;
    let layout = plan.tables.layout;
    let modules = layout.modules(&content) as u64;
    let mut run = Run {
        plan,
        options,
        seed: values.seed,
        frontier: vec![],
        finished: vec![],
        steps: vec![],
        modules,
        words: each.len(),
        peak_bytes: modules * layout.module_bytes(),
        most_steps: most_steps(&schedule, options),
        backend,
    };
    run.put(content, 0)?;
    for act in schedule {
        if run.steps.len() as u64 >= run.most_steps {
            break;
        }
        run.act(act)?;
    }
    let chunks = run.frontier.into_iter().chain(run.finished.into_iter().map(|f| f.0)).collect();
    Ok(Derivation {
        chunks,
        steps: run.steps,
        peak_bytes: run.peak_bytes,
        tables: plan.tables.clone(),
        words: each.len(),
        of: PhantomData,
    })
}

fn most_steps(schedule: &[Act], options: &Options) -> u64 {
    let all = schedule.iter().map(|act| act.rewrite().count as u64).sum();
    options.steps.map_or(all, |s| all.min(s as u64))
}

/// Bounds of the word's size after each step, from the rules alone: up to an `until terminal`, which may end early.
pub fn bounds(plan: &Plan, uniforms: &[Value], records: &[u32], schedule: &[Act], most: u64) -> Vec<Bounds> {
    let sure = schedule.iter().map(Act::rewrite).take_while(|d| !d.until_terminal);
    let steps: Vec<usize> = sure
        .flat_map(|d| std::iter::repeat_n(d.rule_set, d.count.min(size::HORIZON as u32) as usize))
        .take(most.min(size::HORIZON as u64) as usize)
        .collect();
    size::growth(&plan.tables, uniforms, &by_symbol(plan, records), &steps)
}

/// The number of modules of each symbol.
fn by_symbol(plan: &Plan, records: &[u32]) -> Vec<u64> {
    let mut counts = vec![0u64; plan.tables.symbols.len()];
    for record in records.chunks_exact(plan.tables.layout.record_words) {
        counts[(record[0] & 0xffff) as usize] += 1;
    }
    counts
}

/// Refuses only what is sure not to fit.
fn refuse_growth(
    plan: &Plan,
    uniforms: &[Value],
    records: &[u32],
    schedule: &[Act],
    options: &Options,
) -> Result<(), Error> {
    let module = plan.tables.layout.module_bytes();
    let budget = options.max_bytes;
    let axiom = by_symbol(plan, records);
    let most = most_steps(schedule, options);
    let Some(excess) = size::excess(&plan.tables, uniforms, &axiom, schedule, most, budget / module) else {
        return Ok(());
    };
    let (step, modules) = (excess.step as u32, excess.modules);
    let needed = modules.saturating_mul(module);
    Err(match excess.endless {
        None => Error::Memory { needed, modules, step, budget },
        Some(Endless { symbol, rule, derive }) => {
            let symbol = plan.tables.symbols[symbol].name.clone();
            Error::Endless { symbol, rule, derive: derive.span, needed, modules, step, budget }
        }
    })
}

struct Run<'a, B: Backend> {
    plan: &'a Plan,
    options: &'a Options<'a>,
    seed: u32,
    backend: &'a mut B,
    frontier: Vec<B::Chunk>,
    /// With the symbols that occur in it, bit s mod 32.
    finished: Vec<(B::Chunk, u32)>,
    steps: Vec<StepStats>,
    /// Of the whole word.
    modules: u64,
    /// How many words it is of; 0 where it is no plan of words.
    words: usize,
    peak_bytes: u64,
    most_steps: u64,
}

impl<B: Backend> Run<'_, B> {
    fn act(&mut self, act: Act) -> Result<(), B::Error> {
        match act {
            Act::Rewrite(rewrite) => self.rewrite(rewrite, &mut |_| Ok(())),
            Act::Trace { by, into } => self.rewrite(by, &mut |run| run.start_empty_words(into)),
        }
    }

    /// Steps, each with what comes after its sweeps.
    fn rewrite(
        &mut self,
        derive: Rewrite,
        after: &mut dyn FnMut(&mut Self) -> Result<(), B::Error>,
    ) -> Result<(), B::Error> {
        self.recall(derive.rule_set);
        for step in 0..derive.count {
            if self.steps.len() as u64 >= self.most_steps {
                break;
            }
            let start = Instant::now();
            let fired = self.step(derive.rule_set, step)?;
            after(self)?;
            if derive.until_terminal && !fired {
                break;
            }
            self.steps.push(StepStats { modules: self.modules, time: start.elapsed() });
            if let Some(progress) = self.options.progress {
                progress(Progress {
                    step: self.steps.len() as u32,
                    of: self.most_steps.min(u32::MAX as u64) as u32,
                    modules: self.modules,
                    bytes: self.modules * self.plan.tables.layout.module_bytes(),
                });
            }
        }
        Ok(())
    }

    /// Puts modules of the word after `step` on the frontier, in chunks that the backend can hold.
    fn put(&mut self, content: Content, step: u32) -> Result<(), B::Error> {
        let layout = self.plan.tables.layout;
        let most = self.backend.most_modules().max(1);
        let modules = layout.modules(&content);
        if modules == 0 {
            return Ok(());
        }
        if modules <= most {
            self.frontier.push(self.backend.upload(content)?);
            return Ok(());
        }
        if layout.one_piece() {
            let halves = layout.word.and_then(|_| links::halves(content.records(), &layout));
            let too_long = || Error::TooLong { modules: modules as u64, most: most as u64, step };
            let [first, second] = halves.ok_or_else(too_long)?;
            self.put(Content::of_records(first), step)?;
            return self.put(Content::of_records(second), step);
        }
        for start in (0..modules).step_by(most) {
            let part = layout.part(&content, start..modules.min(start + most));
            self.frontier.push(self.backend.upload(part)?);
        }
        Ok(())
    }

    /// Finished chunks that hold a symbol which the rule set names go back to the frontier.
    fn recall(&mut self, rule_set: usize) {
        let Some(first) = self.plan.tables.rule_sets[rule_set].stages.first() else { return };
        let named = first.productions.iter().fold(0u32, |m, p| m | 1 << (p.predecessor % 32));
        let (back, stay) = std::mem::take(&mut self.finished).into_iter().partition(|f| f.1 & named != 0);
        self.finished = stay;
        self.frontier.extend(Vec::into_iter(back).map(|f: (B::Chunk, u32)| f.0));
    }

    /// One step over all chunks; whether any rule fired.
    fn step(&mut self, rule_set: usize, step: u32) -> Result<bool, B::Error> {
        let clock = Clock { step, run_step: self.steps.len() as u32, seed: self.seed };
        let mut fired = false;
        for stage in 0..self.plan.tables.rule_sets[rule_set].stages.len() {
            let id = StageId { rule_set, stage };
            fired |= self.sweep(id, clock)?;
        }
        Ok(fired)
    }

    /// Where a word has no module, its trace is the point at which the turtle starts.
    fn start_empty_words(&mut self, into: usize) -> Result<(), B::Error> {
        let layout = &self.plan.tables.layout;
        let start = turtle::start(self.plan, into);
        if self.words == 0 && self.modules == 0 {
            self.put(Content::of_records(start), self.steps.len() as u32 + 1)?;
            self.modules = 1;
        } else if self.words > 0 && turtle::may_be_empty(self.plan) {
            let chunks = std::mem::take(&mut self.frontier);
            let mut words = 0;
            let mut read = Vec::with_capacity(chunks.len());
            for chunk in chunks {
                read.push(std::mem::take(&mut self.backend.read(&chunk)?[Stored::Records]));
                self.backend.recycle(chunk);
            }
            if read.is_empty() {
                read.push(Vec::new());
            }
            self.modules = 0;
            for n in 0..read.len() {
                // Those of which nothing is left between two chunks go to the first.
                let next = read[n + 1..].iter().find_map(|records| links::first_word(records, layout));
                let until = next.unwrap_or(self.words);
                let records = links::with_starts(&read[n], layout, &start, words..until);
                words = until;
                self.modules += (records.len() / layout.record_words) as u64;
                self.put(Content::of_records(records), self.steps.len() as u32 + 1)?;
            }
        }
        Ok(())
    }

    fn sweep(&mut self, id: StageId, clock: Clock) -> Result<bool, B::Error> {
        let layout = self.plan.tables.layout;
        let growth = id.of(self.plan).max_count() as usize;
        let whole = self.backend.most_modules();
        let most = if layout.one_piece() { whole } else { (whole / growth).max(1) };
        let most = self.options.chunk_modules.map_or(most, |m| most.min(m.max(1)));
        let mut fired = false;
        let mut next = Vec::new();
        let mut waiting = std::mem::take(&mut self.frontier);
        if layout.halo() > 0 {
            // What stands beside a chunk is copied to it before any is rewritten.
            let mut pieces = Vec::with_capacity(waiting.len());
            for chunk in waiting {
                match self.backend.len(&chunk) > most {
                    true => pieces.extend(self.backend.split(chunk, most)?),
                    false => pieces.push(chunk),
                }
            }
            waiting = self.backend.join(pieces, self.plan.is_ring())?;
        }
        waiting.reverse();
        while let Some(chunk) = waiting.pop() {
            if self.options.stop.is_some_and(|s| s.load(Ordering::Relaxed)) {
                return Err(Error::Stopped { steps: self.steps.len() as u32 }.into());
            }
            let length = self.backend.len(&chunk);
            if length > most && !layout.one_piece() {
                waiting.extend(self.backend.split(chunk, most)?.into_iter().rev());
                continue;
            }
            // A linked word is one chunk: its links say where modules stand in it.
            if length > most
                && let Some(halves) = self.halves(&chunk)?
            {
                self.backend.recycle(chunk);
                waiting.extend(halves.into_iter().rev());
                continue;
            }
            if layout.one_piece() {
                self.fits_one_chunk(length as u64)?;
            }
            // The word as it stands, this chunk's old modules among it, is there beside the new ones.
            let held = self.modules * layout.module_bytes();
            let mut room = self.options.max_bytes.saturating_sub(held);
            if layout.one_piece() {
                room = room.min(whole as u64 * layout.module_bytes());
            }
            let outcome = self.backend.step(id, clock, &chunk, room)?;
            if let Outcome::NoRoom { modules, .. } = outcome
                && layout.one_piece()
                && modules > whole as u64
                && let Some(halves) = self.halves(&chunk)?
            {
                self.backend.recycle(chunk);
                waiting.extend(halves.into_iter().rev());
                continue;
            }
            self.backend.recycle(chunk);
            match outcome {
                Outcome::Done { next: live, retired, fired: any } => {
                    fired |= any;
                    let mut new = 0;
                    if let Some(live) = live {
                        new += self.backend.len(&live) as u64;
                        next.push(live);
                    }
                    if let Some(retired) = retired {
                        new += self.backend.len(&retired.0) as u64;
                        self.finished.push(retired);
                    }
                    let bytes = held + new * layout.module_bytes();
                    self.peak_bytes = self.peak_bytes.max(bytes);
                    self.modules = self.modules + new - length as u64;
                }
                Outcome::NoRoom { needed, modules } => {
                    if layout.one_piece() {
                        self.fits_one_chunk(modules)?;
                    }
                    return Err(Error::Memory {
                        needed: held + needed,
                        modules: self.modules + modules,
                        step: self.steps.len() as u32 + 1,
                        budget: self.options.max_bytes,
                    }
                    .into());
                }
                Outcome::TooDeep => {
                    return Err(Error::TooDeep { step: self.steps.len() as u32 + 1 }.into());
                }
            }
        }
        self.frontier = next;
        Ok(fired)
    }

    /// Several words of a chunk in two chunks; none where it holds one word.
    fn halves(&mut self, chunk: &B::Chunk) -> Result<Option<[B::Chunk; 2]>, B::Error> {
        let layout = &self.plan.tables.layout;
        if layout.word.is_none() {
            return Ok(None);
        }
        let content = self.backend.read(chunk)?;
        let Some(halves) = links::halves(content.records(), layout) else { return Ok(None) };
        let [first, second] = halves.map(|records| self.backend.upload(Content::of_records(records)));
        Ok(Some([first?, second?]))
    }

    fn fits_one_chunk(&self, modules: u64) -> Result<(), Error> {
        let most = self.backend.most_modules() as u64;
        if modules <= most {
            return Ok(());
        }
        Err(Error::TooLong { modules, most, step: self.steps.len() as u32 + 1 })
    }
}
