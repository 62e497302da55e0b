//! The backend on a device: its chunks, its kernels, and the buffers it keeps. How a sweep goes
//! stands in `sweep.rs`.

use super::buffers::{self, Pool, Pooled};
use super::kernels::{self, SharedKernels, StageKernels};
use super::sweep::Sweep;
use super::turtle::Turtle;
use super::{Engine, Error};
use crate::language::expr::Value;
use crate::plan::Plan;
use crate::plan::compare::{Trace, Traced, UNTRACED};
use crate::plan::derive::{self, Backend, Derived, Modules, Options, Outcome, StageId, Start};
use crate::plan::edges;
use crate::plan::given::Given;
use crate::plan::layout::{END, HALO, Layout};
use crate::plan::step::{Clock, Status};
use std::collections::HashMap;
use std::sync::Arc;

/// Records and nets of a chunk, on the device.
#[derive(Debug)]
pub struct GpuChunk {
    records: Pooled,
    nets: Pooled,
    pub(super) len: usize,
    /// No net in it was halved more often along one direction.
    pub(super) halvings: u32,
    /// Modules of a curve's word before it, and from its first to the end.
    pub(super) before: usize,
    pub(super) behind: usize,
}

impl GpuChunk {
    /// The buffer of records: [`Layout::record_bytes`] each.
    pub fn records(&self) -> &wgpu::Buffer {
        &self.records.buffer
    }
    /// The buffer of nets: [`Layout::net_bytes`] each.
    pub fn nets(&self) -> &wgpu::Buffer {
        &self.nets.buffer
    }
}

/// The backend. One belongs to one plan.
pub struct Gpu {
    pub(super) engine: Engine,
    pub(super) plan: Arc<Plan>,
    pub(super) uniforms: Vec<Value>,
    pub(super) given: Given,
    /// The values given, then the measured attributes of a chunk.
    pub(super) attributes: wgpu::Buffer,
    pub(super) stages: HashMap<StageId, StageKernels>,
    pub(super) shared: SharedKernels,
    pub(super) pool: Pool,
    /// Extents at multiples of 256 bytes: of the first submission, of emit, of retire.
    pub(super) extents: wgpu::Buffer,
    pub(super) status: wgpu::Buffer,
    pub(super) staging: wgpu::Buffer,
    pub(super) trace: Option<Trace>,
    /// Modules of the next chunk that a rule of the last has claimed.
    pub(super) claimed: u32,
    /// Modules that the chunks before have become.
    pub(super) made: u32,
    pub(super) turtle: Turtle,
}

/// Where the extents stand.
pub(super) const EXTENT_STRIDE: u64 = 256;
/// Bytes of a status, and where the totals of scan and compact stand behind it when read.
pub(super) const STATUS_BYTES: u64 = size_of::<Status>() as u64;
pub(super) const READ_BYTES: u64 = STATUS_BYTES + 8;

impl Gpu {
    /// A backend on the engine's device. Kernels are compiled when a stage first runs.
    ///
    /// # Errors
    /// [`Error::Uniforms`] for consts that the device cannot bind; what the device says.
    pub fn new(engine: &Engine, plan: &Plan) -> Result<Gpu, Error> {
        kernels::fits(engine, plan)?;
        engine.checked("preparing the kernels", || {
            let uniform = wgpu::BufferUsages::UNIFORM;
            let extents = buffers::make(engine, "burgeon extents", 3 * EXTENT_STRIDE, uniform)?;
            Ok(Gpu {
                shared: SharedKernels::new(engine, &plan.tables.layout)?,
                plan: Arc::new(plan.clone()),
                uniforms: plan.defaults(),
                given: Given::default(),
                attributes: buffers::storage(engine, "burgeon attributes", 16)?,
                stages: HashMap::new(),
                pool: Pool::default(),
                extents,
                status: buffers::storage(engine, "burgeon status", STATUS_BYTES)?,
                staging: buffers::staging(engine, READ_BYTES),
                trace: None,
                claimed: 0,
                made: 0,
                turtle: Turtle::new(engine)?,
                engine: engine.clone(),
            })
        })
    }

    /// Makes the pipelines of every stage now. Drivers that compile a kernel when it is first dispatched do so in the
    /// first step that needs it.
    ///
    /// # Errors
    /// What the device says.
    pub fn compile(&mut self) -> Result<(), Error> {
        for (rule_set, set) in self.plan.clone().tables.rule_sets.iter().enumerate() {
            for stage in 0..set.stages.len() {
                self.compile_stage(StageId { rule_set, stage })?;
            }
        }
        Ok(())
    }

    pub(super) fn compile_stage(&mut self, id: StageId) -> Result<(), Error> {
        if self.stages.contains_key(&id) {
            return Ok(());
        }
        let environment = self.plan.environment(id.of(&self.plan), &self.uniforms, &self.given);
        let engine = self.engine.clone();
        let kernels = engine
            .checked("compiling kernels", || StageKernels::new(&engine, &self.plan, id, &environment))?;
        self.stages.insert(id, kernels);
        Ok(())
    }

    pub(super) fn layout(&self) -> Layout {
        self.plan.tables.layout
    }

    /// A chunk with room for `len` modules; what it holds is anything.
    pub(super) fn take(&mut self, len: usize, halvings: u32) -> Result<GpuChunk, Error> {
        let layout = self.layout();
        let records = self.pool.take(&self.engine, "burgeon records", layout.chunk_bytes(len as u64))?;
        let nets = self.pool.take(&self.engine, "burgeon nets", len as u64 * layout.net_bytes())?;
        Ok(GpuChunk { records, nets, len, halvings, before: 0, behind: len })
    }

    fn give(&mut self, chunk: GpuChunk) {
        self.pool.give(chunk.records);
        self.pool.give(chunk.nets);
    }

    pub(super) fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        self.engine.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) })
    }
}

impl Backend for Gpu {
    type Chunk = GpuChunk;
    type Error = Error;

    fn plan(&self) -> &Arc<Plan> {
        &self.plan
    }

    fn bind(&mut self, uniforms: &[Value], given: &Given) -> Result<(), Error> {
        let engine = self.engine.clone();
        engine.checked("giving the kernels their values", || {
            self.uniforms = uniforms.to_vec();
            self.given = given.clone();
            let bytes = (given.words.len() as u64 * 4).max(16);
            if self.attributes.size() < bytes {
                self.attributes = buffers::storage(&self.engine, "burgeon attributes", bytes)?;
            }
            self.write_given();
            for (id, kernels) in &self.stages {
                let words = self.plan.environment(id.of(&self.plan), &self.uniforms, given);
                engine.queue.write_buffer(&kernels.environment, 0, bytemuck::cast_slice(&words));
            }
            Ok(())
        })
    }

    fn upload(&mut self, records: Vec<u32>, nets: Vec<[f32; 4]>) -> Result<GpuChunk, Error> {
        let len = records.len() / self.layout().record_words;
        let engine = self.engine.clone();
        engine.checked("uploading the axiom", || {
            let chunk = self.take(len, 0)?;
            let at = self.layout().halo_bytes();
            engine.queue.write_buffer(chunk.records(), at, bytemuck::cast_slice(&records));
            engine.queue.write_buffer(chunk.nets(), 0, bytemuck::cast_slice(&nets));
            Ok(chunk)
        })
    }

    fn read(&mut self, chunk: &GpuChunk) -> Result<Modules, Error> {
        let (layout, len) = (self.layout(), chunk.len as u64);
        let (at, bytes) = (layout.halo_bytes(), len * layout.record_bytes());
        let records = buffers::read_from(&self.engine, "reading records", chunk.records(), at, bytes)?;
        let nets = buffers::read(&self.engine, "reading nets", chunk.nets(), len * layout.net_bytes())?;
        Ok((records, nets))
    }

    fn len(&self, chunk: &GpuChunk) -> usize {
        chunk.len
    }

    fn most_modules(&self) -> usize {
        let most = self.engine.device.limits().max_storage_buffer_binding_size;
        let row = self.plan.tables.most_measured() as u64 * 4;
        let given = self.given.words.len() as u64 * 4;
        let by_attributes = (most - given.min(most)).checked_div(row).unwrap_or(u64::MAX);
        let layout = self.layout();
        let modules = most / layout.net_bytes().max(layout.record_bytes()) - 2 * layout.halo() as u64;
        modules.min(by_attributes).min(self.most_turtle(most)) as usize
    }

    fn split(&mut self, chunk: GpuChunk, most: usize) -> Result<Vec<GpuChunk>, Error> {
        let engine = self.engine.clone();
        let layout = self.layout();
        engine.checked("splitting a chunk", || {
            let mut encoder = self.encoder("burgeon split");
            let mut pieces = Vec::new();
            for start in (0..chunk.len).step_by(most) {
                let piece = self.take(most.min(chunk.len - start), chunk.halvings)?;
                for (from, to, bytes, halo) in [
                    (chunk.records(), piece.records(), layout.record_bytes(), layout.halo_bytes()),
                    (chunk.nets(), piece.nets(), layout.net_bytes(), 0),
                ] {
                    encoder.copy_buffer_to_buffer(
                        from,
                        halo + start as u64 * bytes,
                        to,
                        halo,
                        piece.len as u64 * bytes,
                    );
                }
                pieces.push(piece);
            }
            engine.queue.submit([encoder.finish()]);
            self.give(chunk);
            Ok(pieces)
        })
    }

    /// What stands beside a chunk is gathered first, since no buffer may be copied to itself.
    fn join(&mut self, mut chunks: Vec<GpuChunk>, ring: bool) -> Result<Vec<GpuChunk>, Error> {
        let engine = self.engine.clone();
        engine.checked("joining chunks", || {
            let layout = self.layout();
            let (bytes, halo) = (layout.record_bytes(), HALO as u64);
            let lengths: Vec<usize> = chunks.iter().map(|chunk| chunk.len).collect();
            let beside = 2 * halo * bytes;
            let gathered = self.pool.take(&engine, "burgeon edges", beside * chunks.len() as u64)?;
            let mut beyond = vec![0u32; layout.record_words];
            beyond[0] = END;
            let mut encoder = self.encoder("burgeon edges");
            let edges = edges::edges(&lengths, ring);
            for (n, edges) in edges.iter().enumerate() {
                let mut k = 0;
                while k < edges.len() {
                    let at = n as u64 * beside + k as u64 * bytes;
                    let Some((chunk, module)) = edges[k] else {
                        engine.queue.write_buffer(&gathered.buffer, at, bytemuck::cast_slice(&beyond));
                        k += 1;
                        continue;
                    };
                    // Records that follow each other there as they do here, in one piece.
                    let follows = |run: &usize| edges.get(k + run) == Some(&Some((chunk, module + run)));
                    let run = (1..edges.len() - k).take_while(follows).count() + 1;
                    let from = layout.halo_bytes() + module as u64 * bytes;
                    let records = chunks[chunk].records();
                    encoder.copy_buffer_to_buffer(records, from, &gathered.buffer, at, run as u64 * bytes);
                    k += run;
                }
            }
            for (n, chunk) in chunks.iter().enumerate() {
                let (at, half) = (n as u64 * beside, halo * bytes);
                let end = layout.halo_bytes() + chunk.len as u64 * bytes;
                encoder.copy_buffer_to_buffer(&gathered.buffer, at, chunk.records(), 0, half);
                encoder.copy_buffer_to_buffer(&gathered.buffer, at + half, chunk.records(), end, half);
            }
            engine.queue.submit([encoder.finish()]);
            self.pool.give(gathered);
            for (n, chunk) in chunks.iter_mut().enumerate() {
                chunk.before = lengths[..n].iter().sum();
                chunk.behind = lengths[n..].iter().sum();
            }
            Ok(chunks)
        })
    }

    fn recycle(&mut self, chunk: GpuChunk) {
        self.give(chunk);
    }

    fn finish(&mut self) -> Result<(), Error> {
        match self.engine.device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(_) => Err(Error::Lost { doing: "waiting for the device" }),
        }
    }

    fn step(
        &mut self,
        id: StageId,
        clock: Clock,
        chunk: &GpuChunk,
        room: u64,
    ) -> Result<Outcome<GpuChunk>, Error> {
        self.compile_stage(id)?;
        let engine = self.engine.clone();
        engine.checked("rewriting a chunk", || {
            let n = chunk.len as u64;
            let plan = self.plan.clone();
            let stage = id.of(&plan);
            self.room_for_attributes(stage, n)?;
            self.room_for_turtle(stage, chunk)?;
            // Where the growth is closed no column is read: any buffer will do.
            let columns = self.columns(if stage.closed.is_some() { 1 } else { n })?;
            let outcome = self.sweep(Sweep { id, clock, chunk, columns: &columns }, room)?;
            self.give_columns(columns);
            Ok(outcome)
        })
    }
}

impl Traced for Gpu {
    fn trace(&self) -> &Trace {
        self.trace.as_ref().unwrap_or(&UNTRACED)
    }
    fn set_traced(&mut self) {
        self.trace = Some(Trace::default());
    }
}

/// Derives the whole schedule on the engine's device and reads what came of it: a word of what the axiom is of, nets or
/// points, or one for each of several [`Words`](crate::curve::Words). How it went, too.
///
/// # Errors
/// As [`derive`](derive::derive()); what the device says.
pub fn derive<S: Start>(
    engine: &Engine,
    plan: &Plan,
    start: &S,
    options: &Options,
) -> Result<Derived<S, GpuChunk>, Error> {
    let mut gpu = Gpu::new(engine, plan)?;
    let derivation = derive::derive(start, options, &mut gpu)?;
    Ok((derive::collect(&mut gpu, &derivation)?, derivation))
}
