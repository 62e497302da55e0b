//! The CPU backend: the passes of [`crate::plan::step`] over slices, in parallel, with the same
//! result whatever the number of threads.
//!
//! Every kernel of `wgsl/` has its twin here under the same name.

pub mod claim;
pub mod compact;
pub mod copy;
pub mod count;
pub mod emit;
pub mod emit_word;
pub mod expand;
mod lanes;
pub mod link;
pub mod match_modules;
pub mod measure;
pub mod motion;
pub mod program;
pub mod retire;
pub mod scan;
pub mod stencil;
mod sums;
pub mod tessellate;
pub mod turtle;
pub mod turtle_linked;

use crate::language::expr::Value;
use crate::plan::compare::{Replay, Trace, Traced, UNTRACED};
use crate::plan::derive::{self, Backend, Derived, Modules, Options, Outcome, StageId, Start};
use crate::plan::edges;
use crate::plan::given::Given;
use crate::plan::layout::{END, Layout};
use crate::plan::links::Links;
use crate::plan::step::{Clock, Status};
use crate::plan::tables::Stage;
use crate::plan::{Error, Plan};
use std::collections::HashMap;
use std::sync::Arc;

/// Modules that one task of a pass works on.
pub const BLOCK: usize = 1024;

/// Records, with those beside them, and nets of a chunk. The vectors come from a pool and may be longer than the chunk.
pub struct Chunk {
    records: Vec<u32>,
    nets: Vec<[f32; 4]>,
    len: usize,
    /// Modules of a curve's word before it, and from its first to the end.
    before: usize,
    behind: usize,
}

/// The backend. One belongs to one plan.
pub struct Cpu {
    plan: Arc<Plan>,
    uniforms: Vec<Value>,
    given: Given,
    environments: HashMap<StageId, Vec<u32>>,
    threads: rayon::ThreadPool,
    pool: Pool,
    trace: Option<Trace>,
    columns: Columns,
    /// The column of the measured attributes.
    attributes: Vec<u32>,
    /// What the chunk before left for this one, and what this one leaves: a chunk may be done again.
    entered: Carried,
    left: Carried,
    /// What contexts see in a linked word, kept for the next.
    links: Links,
}

/// What goes from a chunk of a curve's word to the next.
#[derive(Clone, Copy, Default)]
struct Carried {
    /// Modules that a rule has claimed.
    claimed: u32,
    /// Modules of the new word so far.
    made: u32,
    /// Where the turtle stands.
    turtle: motion::Motion,
}

/// One sweep of the passes over a chunk.
#[derive(Clone, Copy)]
struct Sweep<'c> {
    id: StageId,
    clock: Clock,
    chunk: &'c Chunk,
    room: u64,
    /// What another backend measured and matched, to be done again with it.
    replayed: Option<&'c Trace>,
}

/// Columns that live for one sweep, kept for the next.
#[derive(Default)]
struct Columns {
    rules: Vec<u32>,
    counts: Vec<u32>,
    offsets: Vec<u32>,
    retired: Vec<u32>,
    /// What the children of a linked word hang on.
    hangs: Vec<u32>,
}

impl Cpu {
    /// A backend with `threads` threads; 0 = one for each core.
    ///
    /// # Errors
    /// When the operating system gives no threads.
    pub fn new(plan: &Plan, threads: usize) -> Result<Cpu, Error> {
        let threads = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| Error::Value(format!("the CPU backend could not start its threads: {e}")))?;
        Ok(Cpu {
            plan: Arc::new(plan.clone()),
            uniforms: plan.defaults(),
            given: Given::default(),
            environments: HashMap::new(),
            threads,
            pool: Pool { layout: plan.tables.layout, chunks: Vec::new() },
            trace: None,
            columns: Columns::default(),
            attributes: Vec::new(),
            entered: Carried::default(),
            left: Carried::default(),
            links: Links::default(),
        })
    }

    fn sweep(
        &mut self,
        sweep: Sweep,
        environment: &[u32],
        columns: &mut Columns,
        attributes: &mut Vec<u32>,
    ) -> Outcome<Chunk> {
        let Sweep { id, clock, chunk, room, replayed } = sweep;
        let plan = self.plan.clone();
        let stage: &Stage = id.of(&plan);
        let layout = plan.tables.layout;
        let n = chunk.len;
        let nets = &chunk.nets[..n * layout.net_points()];
        let tables = &plan.tables;
        if layout.link.is_some() {
            link::link(&layout, chunk.own(&layout), &tables.ignored, stage.sees_branches(), &mut self.links);
        }
        let mut input = program::Input {
            records: chunk.own(&layout),
            window: &chunk.records,
            first: layout.halo(),
            behind: chunk.behind,
            layout,
            environment,
            given: &self.given.words,
            measured: &[],
            measured_words: stage.row.words,
            offsets: &[],
            made: self.entered.made,
            clock,
            linked: tables.linked(chunk.own(&layout), &self.links),
            hangs: &[],
        };
        if let Some(trace) = replayed {
            attributes.extend(&trace.attributes);
        } else if stage.row.turtle {
            attributes.resize(n * stage.row.words, 0);
            let (turtle, state) = (&tables.turtle, self.entered.turtle);
            if layout.link.is_some() {
                turtle_linked::turtle_linked(turtle, &layout, input.records, attributes);
            } else {
                let state = || turtle::turtle(turtle, &layout, input.records, state, attributes);
                self.left.turtle = self.threads.install(state);
            }
        } else if stage.row.words > 0 {
            attributes.resize(n * stage.row.words, 0);
            let view = tables.given.view();
            let rational = plan.rational();
            self.threads.install(|| measure::measure(&stage.row, &input, nets, rational, view, attributes));
        }
        input.measured = attributes;
        let (total, retired, status) = match stage.closed {
            Some(growth) => (n * growth as usize, 0, Status { fired: 1, ..Status::default() }),
            None => {
                let mut claimed = self.entered.claimed;
                let filled = self.threads.install(|| columns.fill(stage, &input, n, replayed, &mut claimed));
                self.left.claimed = claimed;
                filled
            }
        };
        if status.too_deep != 0 {
            return Outcome::TooDeep;
        }
        self.left.made = self.entered.made.wrapping_add(total as u32);
        let modules = (total + retired) as u64;
        if modules * layout.module_bytes() > room {
            return Outcome::NoRoom { needed: modules * layout.module_bytes(), modules };
        }
        if let Some(word) = &input.linked {
            let Columns { rules, offsets, hangs, .. } = &mut *columns;
            link::rehang(word, &stage.rule_words(), rules, offsets, stage.roots, hangs);
        }
        let columns = &*columns;
        (input.offsets, input.hangs) = (&columns.offsets, &columns.hangs);
        let mut next = take_if(total, || self.pool.take(total));
        let mut finished = take_if(retired, || self.pool.take(retired));
        let fits = next.as_mut().is_none_or(|next| {
            if layout.is_curve() {
                let (rules, offsets) = (&columns.rules, &columns.offsets);
                emit_word::emit_word(&self.threads, stage, &input, rules, offsets, next.own_mut(&layout));
                return true;
            }
            let out = emit::Output {
                records: &mut next.records[..total * layout.record_words],
                nets: &mut next.nets[..total * layout.net_points()],
            };
            emit::emit(&self.threads, stage, &input, nets, &columns.rules, &columns.offsets, out)
        });
        if let Some(out) = &mut finished {
            let retire = || retire::retire(&input, nets, &columns.retired, &mut out.records, &mut out.nets);
            self.threads.install(retire);
        }
        if !fits {
            return Outcome::TooDeep;
        }
        let retired = finished.map(|c| (c, status.retired_symbols));
        Outcome::Done { next, retired, fired: status.fired != 0 }
    }
}

impl Chunk {
    fn size(&self) -> usize {
        self.records.len() + 4 * self.nets.len()
    }
    fn own(&self, layout: &Layout) -> &[u32] {
        &self.records[layout.halo() * layout.record_words..][..self.len * layout.record_words]
    }
    fn own_mut(&mut self, layout: &Layout) -> &mut [u32] {
        &mut self.records[layout.halo() * layout.record_words..][..self.len * layout.record_words]
    }
}

/// Chunks to be used again. It keeps a few, since a step needs at most one in and two out.
struct Pool {
    layout: Layout,
    chunks: Vec<Chunk>,
}

impl Pool {
    /// A chunk with room for `len` modules; what it holds is anything.
    fn take(&mut self, len: usize) -> Chunk {
        let beside = 2 * self.layout.halo();
        let (words, points) = ((len + beside) * self.layout.record_words, len * self.layout.net_points());
        let fits = |c: &Chunk| c.records.len() >= words && c.nets.len() >= points;
        let smallest =
            (0..self.chunks.len()).filter(|&i| fits(&self.chunks[i])).min_by_key(|&i| self.chunks[i].size());
        match smallest {
            Some(i) => Chunk { len, ..self.chunks.swap_remove(i) },
            None => {
                let (records, nets) = (vec![0; words], vec![[0.0; 4]; points]);
                Chunk { records, nets, len, before: 0, behind: len }
            }
        }
    }

    /// Back to the pool.
    fn give(&mut self, chunk: Chunk) {
        self.chunks.push(chunk);
        if self.chunks.len() > 4 {
            let least = (0..self.chunks.len()).min_by_key(|&i| self.chunks[i].size()).unwrap_or(0);
            self.chunks.swap_remove(least);
        }
    }
}

fn take_if(len: usize, take: impl FnOnce() -> Chunk) -> Option<Chunk> {
    (len > 0).then(take)
}

impl Columns {
    /// match → count → scan, and compact: how many modules come, how many are retired, what the
    /// chunk says.
    fn fill(
        &mut self,
        stage: &Stage,
        input: &program::Input,
        n: usize,
        replayed: Option<&Trace>,
        claimed: &mut u32,
    ) -> (usize, usize, Status) {
        self.rules.resize(n, 0);
        self.counts.resize(n, 0);
        self.offsets.resize(n + 1, 0);
        let words = stage.rule_words();
        let status = match replayed {
            None => match_modules::match_modules(stage, &words, input, &mut self.rules),
            Some(trace) => {
                self.rules.copy_from_slice(&trace.rules);
                match_modules::status(stage, &words, input, &self.rules)
            }
        };
        if stage.claims() {
            *claimed = claim::claim(&words, stage.retired(), *claimed, &mut self.rules);
        }
        count::count(&words, &self.rules, &mut self.counts);
        scan::scan(&self.counts, &mut self.offsets);
        if stage.may_retire() {
            compact::compact(&self.rules, stage.retired(), &mut self.retired);
        }
        (self.offsets[n] as usize, self.retired.len(), status)
    }

    fn clear(&mut self) {
        self.rules.clear();
        self.counts.clear();
        self.offsets.clear();
        self.retired.clear();
        self.hangs.clear();
    }
}

impl Backend for Cpu {
    type Chunk = Chunk;
    type Error = Error;

    fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    fn bind(&mut self, uniforms: &[Value], given: &Given) -> Result<(), Error> {
        self.uniforms = uniforms.to_vec();
        self.given = given.clone();
        self.environments.clear();
        Ok(())
    }

    fn upload(&mut self, records: Vec<u32>, nets: Vec<[f32; 4]>) -> Result<Chunk, Error> {
        let layout = &self.plan.tables.layout;
        let len = records.len() / layout.record_words;
        if !layout.is_curve() {
            return Ok(Chunk { records, nets, len, before: 0, behind: len });
        }
        let mut chunk = self.pool.take(len);
        chunk.own_mut(layout).copy_from_slice(&records);
        Ok(chunk)
    }

    fn read(&mut self, chunk: &Chunk) -> Result<Modules, Error> {
        let layout = &self.plan.tables.layout;
        Ok((chunk.own(layout).to_vec(), chunk.nets[..chunk.len * layout.net_points()].to_vec()))
    }

    fn len(&self, chunk: &Chunk) -> usize {
        chunk.len
    }

    /// 128 MiB of nets, as on a GPU with default limits: smaller chunks are freed earlier.
    fn most_modules(&self) -> usize {
        let layout = &self.plan.tables.layout;
        (128 << 20) / layout.net_bytes().max(layout.record_bytes()) as usize - 2 * layout.halo()
    }

    fn split(&mut self, chunk: Chunk, most: usize) -> Result<Vec<Chunk>, Error> {
        let layout = &self.plan.tables.layout;
        let (words, points) = (layout.record_words, layout.net_points());
        let piece = |start: usize| {
            let len = most.min(chunk.len - start);
            // With as many records on either side, which are not yet those that stand there.
            let end = start + len + 2 * layout.halo();
            Chunk {
                records: chunk.records[start * words..end * words].to_vec(),
                nets: chunk.nets[start * points..(start + len) * points].to_vec(),
                len,
                before: 0,
                behind: len,
            }
        };
        Ok((0..chunk.len).step_by(most).map(piece).collect())
    }

    fn join(&mut self, mut chunks: Vec<Chunk>, ring: bool) -> Result<Vec<Chunk>, Error> {
        let layout = self.plan.tables.layout;
        let (words, halo) = (layout.record_words, layout.halo());
        let lengths: Vec<usize> = chunks.iter().map(|chunk| chunk.len).collect();
        for (n, edges) in edges::edges(&lengths, ring).into_iter().enumerate() {
            for (k, edge) in edges.into_iter().enumerate().filter(|_| halo > 0) {
                let mut record = vec![0; words];
                match edge {
                    Some((chunk, module)) => {
                        record.copy_from_slice(&chunks[chunk].own(&layout)[module * words..][..words]);
                    }
                    None => record[0] = END,
                }
                let at = if k < halo { k } else { lengths[n] + k };
                chunks[n].records[at * words..][..words].copy_from_slice(&record);
            }
            chunks[n].before = lengths[..n].iter().sum();
            chunks[n].behind = lengths[n..].iter().sum();
        }
        Ok(chunks)
    }

    fn recycle(&mut self, chunk: Chunk) {
        self.pool.give(chunk);
    }

    fn finish(&mut self) -> Result<(), Error> {
        Ok(())
    }

    fn step(&mut self, id: StageId, clock: Clock, chunk: &Chunk, room: u64) -> Result<Outcome<Chunk>, Error> {
        self.entered = if chunk.before == 0 { Carried::default() } else { self.left };
        Ok(self.step_as(Sweep { id, clock, chunk, room, replayed: None }))
    }
}

impl Cpu {
    fn step_as(&mut self, sweep: Sweep) -> Outcome<Chunk> {
        let id = sweep.id;
        let environment = match self.environments.remove(&id) {
            Some(environment) => environment,
            None => self.plan.environment(id.of(&self.plan), &self.uniforms, &self.given),
        };
        let mut columns = std::mem::take(&mut self.columns);
        let mut attributes = std::mem::take(&mut self.attributes);
        columns.clear();
        attributes.clear();
        let outcome = self.sweep(sweep, &environment, &mut columns, &mut attributes);
        if let Some(trace) = &mut self.trace {
            *trace = Trace {
                attributes: attributes.clone(),
                rules: columns.rules.clone(),
                counts: columns.counts.clone(),
                offsets: columns.offsets.clone(),
                retired: columns.retired.clone(),
            };
        }
        self.columns = columns;
        self.attributes = attributes;
        self.environments.insert(id, environment);
        outcome
    }
}

impl Traced for Cpu {
    fn trace(&self) -> &Trace {
        self.trace.as_ref().unwrap_or(&UNTRACED)
    }
    fn set_traced(&mut self) {
        self.trace = Some(Trace::default());
    }
}

impl Replay for Cpu {
    fn window(&self, chunk: &Chunk) -> Vec<u32> {
        chunk.records.clone()
    }
    fn links(&self) -> Links {
        self.links.clone()
    }
    fn around(&self, chunk: &Chunk) -> [usize; 2] {
        [chunk.before, chunk.behind]
    }
    fn replay(
        &mut self,
        stage: StageId,
        clock: Clock,
        chunk: &Chunk,
        room: u64,
        trace: &Trace,
    ) -> Result<Outcome<Chunk>, Error> {
        Ok(self.step_as(Sweep { id: stage, clock, chunk, room, replayed: Some(trace) }))
    }
    fn environment(&self, stage: StageId) -> Vec<u32> {
        self.plan.environment(stage.of(&self.plan), &self.uniforms, &self.given)
    }
}

/// Derives the whole schedule on the CPU, with `threads` threads (0 = one for each core), and reads what came of it: a
/// word of what the axiom is of, nets or points, or one for each of several [`Words`](crate::curve::Words). How it went,
/// too.
///
/// # Errors
/// As [`derive`](derive::derive()).
pub fn derive<S: Start>(
    plan: &Plan,
    start: &S,
    options: &Options,
    threads: usize,
) -> Result<Derived<S, Chunk>, Error> {
    let mut cpu = Cpu::new(plan, threads)?;
    let derivation = derive::derive(start, options, &mut cpu)?;
    Ok((derive::collect(&mut cpu, &derivation)?, derivation))
}
