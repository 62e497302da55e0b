//! The backend on a device: its chunks, its kernels, and the buffers it keeps. How a sweep goes
//! stands in `sweep.rs`.

use super::buffers::{self, Pool, Pooled};
use super::kernels::{self, Kernels};
use super::sweep::Sweep;
use super::{Engine, Error};
use crate::language::expr::Value;
use crate::plan::Plan;
use crate::plan::columns::{Content, Stored};
use crate::plan::compare::{Trace, Traced, UNTRACED};
use crate::plan::derive::{self, Backend, Derived, Options, Outcome, StageId, Start};
use crate::plan::edges;
use crate::plan::given::Given;
use crate::plan::layout::{END, HALO, Layout};
use crate::plan::program::{self, Length};
use crate::plan::step::{Clock, Column, Status};
use crate::plan::turtle::MOTION_WORDS;
use std::sync::Arc;

/// The columns of a chunk, on the device.
#[derive(Debug)]
pub struct GpuChunk {
    columns: [Option<Pooled>; Stored::COUNT],
    pub(super) len: usize,
    /// No net in it was halved more often along one direction.
    pub(super) halvings: u32,
    /// Modules of the word before it, and from its first to the end, where modules have neighbours.
    pub(super) before: usize,
    pub(super) behind: usize,
}

impl GpuChunk {
    /// The buffer of records: [`Layout::record_bytes`] each, after those of [`Layout::halo`] modules.
    pub fn records(&self) -> Option<&wgpu::Buffer> {
        self.column(Stored::Records)
    }
    /// The buffer of nets, where modules have any: [`Layout::net_bytes`] each.
    pub fn nets(&self) -> Option<&wgpu::Buffer> {
        self.column(Stored::Nets)
    }
    /// Those that there are.
    pub(super) fn buffers(&self) -> impl Iterator<Item = (Stored, &wgpu::Buffer)> {
        Stored::ALL.into_iter().filter_map(|column| Some((column, self.column(column)?)))
    }
    /// The buffer of a column; none of those that the word has not.
    pub fn column(&self, column: Stored) -> Option<&wgpu::Buffer> {
        self.columns[column as usize].as_ref().map(|pooled| &pooled.buffer)
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
    pub(super) kernels: Kernels,
    pub(super) pool: Pool,
    /// Extents at multiples of 256 bytes: of the passes that count, of those that write, of retire.
    pub(super) extents: wgpu::Buffer,
    pub(super) status: wgpu::Buffer,
    /// Where the turtle stands after the chunk before.
    pub(super) carried: wgpu::Buffer,
    /// Bound where a pass reads a column that nothing has written, and does not look at it.
    pub(super) nothing: wgpu::Buffer,
    pub(super) staging: wgpu::Buffer,
    pub(super) trace: Option<Trace>,
    /// Modules of the next chunk that a rule of the last has claimed.
    pub(super) claimed: u32,
    /// Modules that the chunks before have become.
    pub(super) made: u32,
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
                kernels: Kernels::new(engine),
                plan: Arc::new(plan.clone()),
                uniforms: plan.defaults(),
                given: Given::default(),
                attributes: buffers::storage(engine, "burgeon attributes", 16)?,
                pool: Pool::default(),
                extents,
                status: buffers::storage(engine, "burgeon status", STATUS_BYTES)?,
                staging: buffers::staging(engine, READ_BYTES),
                trace: None,
                claimed: 0,
                made: 0,
                carried: buffers::storage(engine, "burgeon turtle", MOTION_WORDS as u64 * 4)?,
                nothing: buffers::storage(engine, "burgeon nothing", 16)?,
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
        self.plan.stages().into_iter().try_for_each(|id| self.compile_stage(id))
    }

    pub(super) fn compile_stage(&mut self, id: StageId) -> Result<(), Error> {
        if self.kernels.has(id) {
            return Ok(());
        }
        let environment = self.plan.environment(id.of(&self.plan), &self.uniforms, &self.given);
        let engine = self.engine.clone();
        engine.checked("compiling kernels", || {
            let plan = self.plan.clone();
            self.kernels.compile(&plan, id, &environment, id.of(&plan).program.works())
        })
    }

    pub(super) fn layout(&self) -> Layout {
        self.plan.tables.layout
    }

    /// A chunk with room for `len` modules; what it holds is anything.
    pub(super) fn take(&mut self, len: usize, halvings: u32) -> Result<GpuChunk, Error> {
        let layout = self.layout();
        let mut columns = [const { None }; Stored::COUNT];
        for column in layout.columns() {
            let bytes = layout.shape(column).chunk_bytes(len as u64);
            columns[column as usize] =
                Some(self.pool.take(&self.engine, kernels::label(Column::Before(column)), bytes)?);
        }
        Ok(GpuChunk { columns, len, halvings, before: 0, behind: len })
    }

    fn give(&mut self, chunk: GpuChunk) {
        chunk.columns.into_iter().flatten().for_each(|column| self.pool.give(column));
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
            let words = |id: StageId| self.plan.environment(id.of(&self.plan), &self.uniforms, given);
            self.kernels.set_environments(words);
            Ok(())
        })
    }

    fn upload(&mut self, content: Content) -> Result<GpuChunk, Error> {
        let layout = self.layout();
        let engine = self.engine.clone();
        engine.checked("uploading the axiom", || {
            let chunk = self.take(layout.modules(&content), 0)?;
            for (column, buffer) in chunk.buffers() {
                let at = layout.shape(column).halo_bytes();
                engine.queue.write_buffer(buffer, at, bytemuck::cast_slice(&content[column]));
            }
            Ok(chunk)
        })
    }

    fn read(&mut self, chunk: &GpuChunk) -> Result<Content, Error> {
        let layout = self.layout();
        let mut content = Content::default();
        for (column, buffer) in chunk.buffers() {
            let shape = layout.shape(column);
            let (at, bytes) = (shape.halo_bytes(), chunk.len as u64 * shape.bytes());
            content[column] = buffers::read_from(&self.engine, "reading a word", buffer, at, bytes)?;
        }
        Ok(content)
    }

    fn len(&self, chunk: &GpuChunk) -> usize {
        chunk.len
    }

    /// What fits into one binding, of the columns of the word and of those that its passes write.
    fn most_modules(&self) -> usize {
        let binding = self.engine.device.limits().max_storage_buffer_binding_size;
        let (plan, tile) = (&self.plan, u64::from(self.engine.tuning.tile()));
        let mut most = self.layout().most_modules(binding);
        for stage in plan.stages().into_iter().map(|id| id.of(plan)) {
            let written = stage.program.works().flat_map(|work| &work.bindings).filter(|bound| bound.1);
            for size in written.filter_map(|bound| program::size(bound.0, stage, self.given.words.len())) {
                let room = binding.saturating_sub(4 * size.more as u64);
                let elements = room.checked_div(4 * size.words as u64).unwrap_or(u64::MAX);
                most = most.min(match size.of {
                    Length::Each(_) => elements,
                    Length::Tiles(_) => elements.saturating_mul(tile),
                    Length::One => u64::MAX,
                });
            }
        }
        most as usize
    }

    fn split(&mut self, chunk: GpuChunk, most: usize) -> Result<Vec<GpuChunk>, Error> {
        let engine = self.engine.clone();
        let layout = self.layout();
        engine.checked("splitting a chunk", || {
            let mut encoder = self.encoder("burgeon split");
            let mut pieces = Vec::new();
            for start in (0..chunk.len).step_by(most) {
                let piece = self.take(most.min(chunk.len - start), chunk.halvings)?;
                for ((column, from), (_, to)) in chunk.buffers().zip(piece.buffers()) {
                    let shape = layout.shape(column);
                    let (at, halo) = (start as u64 * shape.bytes(), shape.halo_bytes());
                    encoder.copy_buffer_to_buffer(
                        from,
                        halo + at,
                        to,
                        halo,
                        piece.len as u64 * shape.bytes(),
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
            let before = layout.shape(Stored::Records).halo_bytes();
            let records: Vec<&wgpu::Buffer> = chunks.iter().filter_map(GpuChunk::records).collect();
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
                    let from = before + module as u64 * bytes;
                    let (records, gathered) = (records[chunk], &gathered.buffer);
                    encoder.copy_buffer_to_buffer(records, from, gathered, at, run as u64 * bytes);
                    k += run;
                }
            }
            for (n, chunk) in chunks.iter().enumerate() {
                let (at, half) = (n as u64 * beside, halo * bytes);
                let end = before + chunk.len as u64 * bytes;
                encoder.copy_buffer_to_buffer(&gathered.buffer, at, records[n], 0, half);
                encoder.copy_buffer_to_buffer(&gathered.buffer, at + half, records[n], end, half);
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
            let columns = self.columns(id, chunk.len as u64)?;
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
