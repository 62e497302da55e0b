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
pub mod join;
mod lanes;
pub mod link;
pub mod match_modules;
pub mod measure;
pub mod motion;
pub mod program;
pub mod refine;
pub mod retire;
pub mod scan;
pub mod stencil;
mod sums;
mod sweep;
pub mod tessellate;
mod tiles;
pub mod turtle;
pub mod turtle_linked;

use crate::language::expr::Value;
use crate::plan::columns::{Content, Stored};
use crate::plan::compare::{Replay, Trace, Traced, UNTRACED};
use crate::plan::derive::{self, Backend, Derived, Options, Outcome, StageId, Start};
use crate::plan::given::Given;
use crate::plan::layout::Layout;
use crate::plan::links::Links;
use crate::plan::step::{Clock, Status};
use crate::plan::{Error, Plan};
use std::collections::HashMap;
use std::sync::Arc;
use sweep::{Carried, Columns, Sweep};

/// Modules that one task of a pass works on.
pub const BLOCK: usize = 1024;

/// The columns of a chunk, records with those beside them. The vectors come from a pool and may be longer than the chunk.
pub struct Chunk {
    columns: [Vec<u32>; Stored::COUNT],
    len: usize,
    /// Modules of the word before it, and from its first to the end, where modules have neighbours.
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
    /// What the chunk before left for this one, and what this one leaves: a chunk may be done again.
    entered: Carried,
    left: Carried,
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
            .map_err(|e| Error::Value(format!("the CPU backend could not start its threads: {e}"), None))?;
        Ok(Cpu {
            plan: Arc::new(plan.clone()),
            uniforms: plan.defaults(),
            given: Given::default(),
            environments: HashMap::new(),
            threads,
            pool: Pool { layout: plan.tables.layout, chunks: Vec::new() },
            trace: None,
            columns: Columns::default(),
            entered: Carried::default(),
            left: Carried::default(),
        })
    }

    /// One sweep of the passes over a chunk, with what another backend measured and matched if that is given.
    fn sweep(
        &mut self,
        id: StageId,
        clock: Clock,
        chunk: &Chunk,
        room: u64,
        replayed: Option<&Trace>,
    ) -> Outcome<Chunk> {
        let environment = match self.environments.remove(&id) {
            Some(environment) => environment,
            None => self.plan.environment(id.of(&self.plan), &self.uniforms, &self.given),
        };
        let (plan, module_bytes) = (self.plan.clone(), self.plan.tables.layout.module_bytes());
        let mut sweep = Sweep {
            plan: &plan,
            id,
            clock,
            chunk,
            environment: &environment,
            given: &self.given,
            threads: &self.threads,
            replayed,
            columns: &mut self.columns,
            entered: self.entered,
            left: self.left,
            status: Status::default(),
            next: None,
            finished: None,
        };
        let (total, retired) = sweep.count();
        let modules = (total + retired) as u64;
        let outcome = if sweep.status.too_deep != 0 {
            Outcome::TooDeep
        } else if modules * module_bytes > room {
            Outcome::NoRoom { needed: modules * module_bytes, modules }
        } else {
            [sweep.next, sweep.finished] = [total, retired].map(|len| (len > 0).then(|| self.pool.take(len)));
            sweep.write();
            let retired = sweep.finished.take().map(|chunk| (chunk, sweep.status.retired_symbols));
            match sweep.status.too_deep {
                0 => Outcome::Done { next: sweep.next.take(), retired, fired: sweep.status.fired != 0 },
                _ => Outcome::TooDeep,
            }
        };
        self.left = sweep.left;
        if let Some(trace) = &mut self.trace {
            *trace = self.columns.trace();
        }
        self.environments.insert(id, environment);
        outcome
    }
}

impl Chunk {
    fn size(&self) -> usize {
        self.columns.iter().map(Vec::len).sum()
    }
    /// A column without what stands beside the chunk.
    fn own(&self, layout: &Layout, column: Stored) -> &[u32] {
        let shape = layout.shape(column);
        &self.columns[column as usize][shape.halo * shape.words..][..self.len * shape.words]
    }
    fn own_mut(&mut self, layout: &Layout, column: Stored) -> &mut [u32] {
        let shape = layout.shape(column);
        &mut self.columns[column as usize][shape.halo * shape.words..][..self.len * shape.words]
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
        let words = Stored::ALL.map(|column| self.layout.shape(column).chunk_words(len));
        let fits = |c: &Chunk| c.columns.iter().zip(words).all(|(column, words)| column.len() >= words);
        let smallest =
            (0..self.chunks.len()).filter(|&i| fits(&self.chunks[i])).min_by_key(|&i| self.chunks[i].size());
        match smallest {
            Some(i) => Chunk { len, ..self.chunks.swap_remove(i) },
            None => Chunk { columns: words.map(|words| vec![0; words]), len, before: 0, behind: len },
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

    fn upload(&mut self, mut content: Content) -> Result<Chunk, Error> {
        let layout = &self.plan.tables.layout;
        let len = layout.modules(&content);
        if layout.halo() == 0 {
            let columns = Stored::ALL.map(|column| std::mem::take(&mut content[column]));
            return Ok(Chunk { columns, len, before: 0, behind: len });
        }
        let mut chunk = self.pool.take(len);
        for column in layout.columns() {
            chunk.own_mut(layout, column).copy_from_slice(&content[column]);
        }
        Ok(chunk)
    }

    fn read(&mut self, chunk: &Chunk) -> Result<Content, Error> {
        let layout = &self.plan.tables.layout;
        let mut content = Content::default();
        for column in layout.columns() {
            content[column] = chunk.own(layout, column).to_vec();
        }
        Ok(content)
    }

    fn len(&self, chunk: &Chunk) -> usize {
        chunk.len
    }

    /// 128 MiB of the widest column, as on a GPU with default limits: smaller chunks are freed earlier.
    fn most_modules(&self) -> usize {
        self.plan.tables.layout.most_modules(128 << 20) as usize
    }

    fn split(&mut self, chunk: Chunk, most: usize) -> Result<Vec<Chunk>, Error> {
        let layout = &self.plan.tables.layout;
        let piece = |start: usize| {
            let len = most.min(chunk.len - start);
            // With as many elements on either side, which are not yet those that stand there.
            let part = |column: Stored| {
                let shape = layout.shape(column);
                chunk.columns[column as usize][start * shape.words..][..shape.chunk_words(len)].to_vec()
            };
            Chunk { columns: Stored::ALL.map(part), len, before: 0, behind: len }
        };
        Ok((0..chunk.len).step_by(most).map(piece).collect())
    }

    fn join(&mut self, chunks: Vec<Chunk>, ring: bool) -> Result<Vec<Chunk>, Error> {
        Ok(join::join(&self.plan.tables.layout, chunks, ring))
    }

    fn recycle(&mut self, chunk: Chunk) {
        self.pool.give(chunk);
    }

    fn finish(&mut self) -> Result<(), Error> {
        Ok(())
    }

    fn step(&mut self, id: StageId, clock: Clock, chunk: &Chunk, room: u64) -> Result<Outcome<Chunk>, Error> {
        self.entered = if chunk.before == 0 { Carried::default() } else { self.left };
        Ok(self.sweep(id, clock, chunk, room, None))
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
        chunk.columns[Stored::Records as usize].clone()
    }
    fn links(&self) -> Links {
        self.columns.links.clone()
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
        Ok(self.sweep(stage, clock, chunk, room, Some(trace)))
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
