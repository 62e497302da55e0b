//! One sweep on a device: its columns, the recording of its passes, what is read of them.
//!
//! A sweep is two submissions: the passes of the stage's [program](crate::plan::program) that count; then, when the host
//! has read the totals and made exactly the room that they ask for, those that write. Where the growth is a closed form
//! only the second is made, and nothing is read or waited for.

use super::Error;
use super::backend::{EXTENT_STRIDE, Gpu, GpuChunk, READ_BYTES, STATUS_BYTES};
use super::buffers::{self, Pooled};
use super::kernels::{self, Binding, label};
use crate::plan::columns::{Content, Domain};
use crate::plan::compare::Trace;
use crate::plan::derive::{Backend, Outcome, StageId};
use crate::plan::layout::MAX_HALVINGS;
use crate::plan::program::{self, Over, Total, Work};
use crate::plan::step::{Clock, Column, Extent, Pass, Status};
use crate::plan::tables::Stage;

/// The columns that the passes of a sweep write, but for those that outlive it.
pub(super) struct Columns(Vec<(Column, Pooled)>);

impl Columns {
    fn get(&self, column: Column) -> Option<&wgpu::Buffer> {
        self.0.iter().find(|known| known.0 == column).map(|known| &known.1.buffer)
    }
}

/// Whether a column of a sweep is needed no more after it; else it outlives the sweep, and is the backend's.
fn ends_with_its_sweep(column: Column) -> bool {
    !matches!(column, Column::Attributes | Column::Status | Column::Carried)
}

/// Where modules go: a chunk, how many of it may be written, and how many there are to write.
#[derive(Clone, Copy)]
struct Target<'c> {
    chunk: &'c GpuChunk,
    capacity: usize,
    modules: usize,
}

impl<'c> Target<'c> {
    /// A chunk that was made for what comes.
    fn exact(chunk: &'c GpuChunk) -> Target<'c> {
        Target { chunk, capacity: chunk.len, modules: chunk.len }
    }
}

/// One sweep of the passes over a chunk.
#[derive(Clone, Copy)]
pub(super) struct Sweep<'c> {
    pub id: StageId,
    pub clock: Clock,
    pub chunk: &'c GpuChunk,
    pub columns: &'c Columns,
}

/// What the first submission says.
struct Totals {
    status: Status,
    modules: usize,
    retired: usize,
}

/// Which extent a pass reads: of those that count, of those that write, of those over what is retired.
const COUNTING: u64 = 0;
const WRITING: u64 = 1;
const RETIRING: u64 = 2;

/// What the passes of a submission are bound to.
#[derive(Clone, Copy)]
struct Bound<'c> {
    sweep: Sweep<'c>,
    slot: u64,
    /// Elements that they run over.
    count: u64,
    next: Option<Target<'c>>,
    finished: Option<Target<'c>>,
}

impl Gpu {
    /// Room for what the passes of a stage write of `n` modules.
    pub(super) fn columns(&mut self, id: StageId, n: u64) -> Result<Columns, Error> {
        let plan = self.plan.clone();
        let stage: &Stage = id.of(&plan);
        let (given, tile) = (self.given.words.len(), self.engine.tuning.tile());
        let mut columns = Vec::new();
        for &(column, _) in stage.program.works().flat_map(|work| &work.bindings).filter(|bound| bound.1) {
            let Some(size) = program::size(column, stage, given) else { continue };
            let bytes = size.bytes(n, tile);
            if column == Column::Attributes && self.attributes.size() < bytes {
                self.attributes = self.pool.take(&self.engine, label(column), bytes)?.buffer;
                self.write_given();
            }
            let new = columns.iter().all(|known: &(Column, _)| known.0 != column);
            if new && ends_with_its_sweep(column) {
                columns.push((column, self.pool.take(&self.engine, label(column), bytes)?));
            }
        }
        Ok(Columns(columns))
    }

    pub(super) fn give_columns(&mut self, columns: Columns) {
        columns.0.into_iter().for_each(|(_, column)| self.pool.give(column));
    }

    /// What all dispatches over a chunk have in common.
    fn extent_of(&self, sweep: Sweep) -> Extent {
        Extent {
            count: sweep.chunk.len as u32,
            wanted: sweep.id.of(&self.plan).retired(),
            clock: sweep.clock,
            given: self.given.words.len() as u32,
            before: sweep.chunk.before as u32,
            behind: sweep.chunk.behind as u32,
            made: self.made,
            ..Extent::default()
        }
    }

    fn write_extent(&self, slot: u64, extent: Extent) {
        self.engine.queue.write_buffer(&self.extents, slot * EXTENT_STRIDE, bytemuck::bytes_of(&extent));
    }

    pub(super) fn write_given(&self) {
        self.engine.queue.write_buffer(&self.attributes, 0, bytemuck::cast_slice(&self.given.words));
    }

    /// What a pass binds as a column.
    fn binding<'b>(&'b self, column: Column, bound: &Bound<'b>) -> Binding<'b> {
        let Sweep { id, chunk, columns, .. } = bound.sweep;
        let (layout, stage, n) = (self.layout(), id.of(&self.plan), chunk.len as u64);
        let nothing = Binding::whole(&self.nothing);
        let of_chunk = |chunk: Option<&'b GpuChunk>, column| {
            let buffer = chunk.and_then(|chunk| Some((chunk.column(column)?, chunk.len as u64)));
            buffer
                .map_or(nothing, |(buffer, len)| Binding::new(buffer, layout.shape(column).chunk_bytes(len)))
        };
        let buffer = match column {
            Column::Before(stored) => return of_chunk(Some(chunk), stored),
            Column::After(stored) => return of_chunk(bound.next.map(|target| target.chunk), stored),
            Column::Finished(stored) => return of_chunk(bound.finished.map(|target| target.chunk), stored),
            Column::Environment => return self.kernels.environment(id),
            Column::Extent => {
                let (offset, bytes) = (bound.slot * EXTENT_STRIDE, size_of::<Extent>() as u64);
                return Binding { buffer: &self.extents, offset, bytes };
            }
            Column::Attributes => &self.attributes,
            Column::Status => &self.status,
            Column::Carried => &self.carried,
            other => match columns.get(other) {
                Some(buffer) => buffer,
                None => return nothing,
            },
        };
        let size = program::size(column, stage, self.given.words.len());
        Binding::new(buffer, size.map_or(0, |size| size.bytes(n, self.engine.tuning.tile())))
    }

    /// Records passes.
    fn record(&self, pass: &mut wgpu::ComputePass, works: &[Work], bound: Bound) {
        let (tuning, id) = (*self.engine.tuning(), bound.sweep.id);
        let (stage, layout, n) = (id.of(&self.plan), self.layout(), bound.count);
        for work in works {
            let kernel = self.kernels.of(id, work.pass);
            let columns: Vec<Binding> =
                work.bindings.iter().map(|&(column, _)| self.binding(column, &bound)).collect();
            let group = kernel.bind(&self.engine, &columns);
            let groups = |over| match over {
                Over::Each(_) => kernels::groups(n, tuning.workgroup),
                Over::Tiles(_) => kernels::groups(n, tuning.tile()),
                Over::Group => [1, 1],
                Over::Children => {
                    kernels::groups(tuning.children(work.pass, n, stage, &layout), tuning.workgroup)
                }
            };
            kernel.run(pass, (&group, 0), work, n, |pass, over| {
                let [x, y] = groups(over);
                pass.dispatch_workgroups(x, y, 1);
            });
        }
    }

    /// The passes that count; then what they have counted, read.
    fn totals(&mut self, sweep: Sweep) -> Result<Totals, Error> {
        let Sweep { id, chunk, columns, .. } = sweep;
        let plan = self.plan.clone();
        let program = &id.of(&plan).program;
        let n = chunk.len as u64;
        self.write_extent(COUNTING, self.extent_of(sweep));
        let status = Status { claimed: self.claimed, ..Status::default() };
        self.engine.queue.write_buffer(&self.status, 0, bytemuck::bytes_of(&status));
        let label = "burgeon count";
        let mut encoder = self.encoder(label);
        {
            let mut pass = compute_pass(&mut encoder, label);
            let bound = Bound { sweep, slot: COUNTING, count: n, next: None, finished: None };
            self.record(&mut pass, &program.counting, bound);
        }
        encoder.copy_buffer_to_buffer(&self.status, 0, &self.staging, 0, STATUS_BYTES);
        let counted: Vec<(Total, Column)> = program.counting.iter().filter_map(Work::total).collect();
        let tiles = n.div_ceil(u64::from(self.engine.tuning.tile()));
        for (k, (_, column)) in counted.iter().enumerate() {
            let sums = columns.get(*column).unwrap_or(&self.nothing);
            encoder.copy_buffer_to_buffer(sums, tiles * 4, &self.staging, STATUS_BYTES + 4 * k as u64, 4);
        }
        self.engine.queue.submit([encoder.finish()]);
        let words: Vec<u32> = buffers::mapped(
            &self.engine,
            "reading the totals of a step",
            &self.staging,
            READ_BYTES,
            |bytes| bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect(),
        )?;
        let (status, words) = words.split_at(STATUS_BYTES as usize / 4);
        let status: Status = bytemuck::pod_read_unaligned(bytemuck::cast_slice(status));
        self.claimed = status.claimed;
        let of = |total: Total| counted.iter().zip(words).find(|(known, _)| known.0 == total);
        let [modules, retired] = [Total::New(Domain::Module), Total::Retired(Domain::Module)]
            .map(|total| of(total).map_or(0, |(_, &word)| word as usize));
        Ok(Totals { status, modules, retired })
    }

    /// The passes that write what comes, and those that copy what is retired.
    fn write(&mut self, sweep: Sweep, next: Option<Target>, finished: Option<Target>) {
        let program = &sweep.id.of(&self.plan).program;
        let label = "burgeon write";
        let mut encoder = self.encoder(label);
        {
            let mut pass = compute_pass(&mut encoder, label);
            let common = self.extent_of(sweep);
            let bound = Bound { sweep, slot: WRITING, count: sweep.chunk.len as u64, next, finished };
            if let Some(Target { capacity, .. }) = next {
                self.write_extent(WRITING, Extent { capacity: capacity as u32, ..common });
                self.record(&mut pass, &program.writing, bound);
            }
            if let Some(Target { capacity, modules, .. }) = finished {
                let (count, capacity) = (modules as u32, capacity as u32);
                self.write_extent(RETIRING, Extent { count, capacity, ..common });
                let bound = Bound { slot: RETIRING, count: modules as u64, ..bound };
                self.record(&mut pass, &program.retiring, bound);
            }
        }
        self.engine.queue.submit([encoder.finish()]);
    }

    fn read_status(&self) -> Result<Status, Error> {
        let words: Vec<u32> = buffers::read(&self.engine, "reading the status", &self.status, STATUS_BYTES)?;
        Ok(bytemuck::pod_read_unaligned(bytemuck::cast_slice(&words)))
    }

    fn totals_or_closed(&mut self, sweep: Sweep) -> Result<Totals, Error> {
        let Sweep { id, chunk, .. } = sweep;
        match id.of(&self.plan).closed {
            Some(growth) => Ok(Totals {
                status: Status { fired: 1, ..Status::default() },
                modules: chunk.len * growth as usize,
                retired: 0,
            }),
            None => self.totals(sweep),
        }
    }

    /// One sweep into chunks that are there already, of which so many modules may be written.
    ///
    /// # Errors
    /// [`Error::Capacity`] where that is too few; what fits is written and nothing behind it.
    #[doc(hidden)]
    pub fn step_into(
        &mut self,
        id: StageId,
        clock: Clock,
        chunk: &GpuChunk,
        next: (&GpuChunk, usize),
        finished: (&GpuChunk, usize),
    ) -> Result<(), Error> {
        self.compile_stage(id)?;
        let engine = self.engine.clone();
        engine.checked("rewriting a chunk into buffers of the caller", || {
            let columns = self.columns(id, chunk.len as u64)?;
            let sweep = Sweep { id, clock, chunk, columns: &columns };
            let totals = self.totals_or_closed(sweep)?;
            let target = |(chunk, capacity): (_, usize), modules| {
                (modules > 0).then_some(Target { chunk, capacity, modules })
            };
            let (next, finished) = (target(next, totals.modules), target(finished, totals.retired));
            engine.queue.write_buffer(&self.status, 0, bytemuck::bytes_of(&Status::default()));
            self.write(sweep, next, finished);
            self.give_columns(columns);
            let status = self.read_status()?;
            let room = |buffer, target: Option<Target>, needed: u32| match target {
                Some(t) if needed != 0 => {
                    Err(Error::Capacity { buffer, needed: needed as u64, capacity: t.capacity as u64 })
                }
                _ => Ok(()),
            };
            room("the new chunk", next, status.needed)?;
            room("the finished chunk", finished, status.needed_finished)
        })
    }

    /// The passes of a sweep into chunks made for what comes, if they may take `room` bytes.
    pub(super) fn sweep(&mut self, sweep: Sweep, room: u64) -> Result<Outcome<GpuChunk>, Error> {
        let Sweep { id, chunk, columns, .. } = sweep;
        let plan = self.plan.clone();
        let stage: &Stage = id.of(&plan);
        let totals = self.totals_or_closed(sweep)?;
        self.keep_trace(id, chunk.len as u64, totals.retired, columns)?;
        if totals.status.too_deep != 0 {
            return Ok(Outcome::TooDeep);
        }
        let modules = (totals.modules + totals.retired) as u64;
        if modules * self.layout().module_bytes() > room {
            return Ok(Outcome::NoRoom { needed: modules * self.layout().module_bytes(), modules });
        }
        let halvings = chunk.halvings + 1;
        let next = (totals.modules > 0).then(|| self.take(totals.modules, halvings)).transpose()?;
        let finished = (totals.retired > 0).then(|| self.take(totals.retired, chunk.halvings)).transpose()?;
        // Where match_modules did not run, emit is the first to see an address that is full.
        let may_be_too_deep = stage.closed.is_some() && halvings > MAX_HALVINGS as u32;
        if may_be_too_deep {
            self.engine.queue.write_buffer(&self.status, 0, bytemuck::bytes_of(&Status::default()));
        }
        self.made = if chunk.before == 0 { 0 } else { self.made };
        let targets = [&next, &finished].map(|chunk| chunk.as_ref().map(Target::exact));
        self.write(sweep, targets[0], targets[1]);
        self.made = self.made.wrapping_add(totals.modules as u32);
        // Where the growth is closed, it is the second submission that measures.
        if stage.closed.is_some() && self.trace.is_some() {
            let attributes = self.read_attributes(id, chunk.len as u64)?;
            self.trace = Some(Trace { attributes, ..Trace::default() });
        }
        if may_be_too_deep && self.read_status()?.too_deep != 0 {
            return Ok(Outcome::TooDeep);
        }
        let retired = finished.map(|c| (c, totals.status.retired_symbols));
        Ok(Outcome::Done { next, retired, fired: totals.status.fired != 0 })
    }

    fn keep_trace(&mut self, id: StageId, n: u64, retired: usize, columns: &Columns) -> Result<(), Error> {
        if self.trace.is_none() {
            return Ok(());
        }
        let mut trace = Trace::default();
        if id.of(&self.plan).closed.is_none() {
            let read = |column: Column, words: u64| match columns.get(column).filter(|_| words > 0) {
                Some(buffer) => buffers::read::<u32>(&self.engine, "reading a pass", buffer, words * 4),
                None => Ok(Vec::new()),
            };
            trace = Trace {
                attributes: self.read_attributes(id, n)?,
                rules: read(Column::Rules, n)?,
                counts: read(Column::Counts, n)?,
                offsets: read(Column::Offsets, n + 1)?,
                retired: read(Column::Retired, retired as u64)?,
            };
        }
        self.trace = Some(trace);
        Ok(())
    }

    /// What was measured of so many modules.
    pub(super) fn read_attributes(&self, id: StageId, n: u64) -> Result<Vec<u32>, Error> {
        let row = id.of(&self.plan).row.words as u64;
        if row == 0 {
            return Ok(Vec::new());
        }
        let words = self.given.words.len() as u64 + n * row;
        let mut words: Vec<u32> =
            buffers::read(&self.engine, "reading the attributes", &self.attributes, words * 4)?;
        words.drain(..self.given.words.len());
        Ok(words)
    }

    /// The rows that a trace measures of these records, which are one chunk.
    ///
    /// # Errors
    /// What the device says.
    #[doc(hidden)]
    pub fn turtle_rows(&mut self, id: StageId, records: Vec<u32>) -> Result<Vec<u32>, Error> {
        let chunk = self.upload(Content::of_records(records))?;
        self.compile_stage(id)?;
        let engine = self.engine.clone();
        let rows = engine.checked("tracing", || {
            let columns = self.columns(id, chunk.len as u64)?;
            let sweep = Sweep { id, clock: Clock::default(), chunk: &chunk, columns: &columns };
            self.write_extent(COUNTING, self.extent_of(sweep));
            let label = "burgeon turtle";
            let mut encoder = self.encoder(label);
            {
                let mut pass = compute_pass(&mut encoder, label);
                let bound =
                    Bound { sweep, slot: COUNTING, count: chunk.len as u64, next: None, finished: None };
                let turtle = |work: &&Work| matches!(work.pass, Pass::Turtle | Pass::TurtleLinked);
                let works: Vec<Work> = id.of(&self.plan).program.works().filter(turtle).cloned().collect();
                self.record(&mut pass, &works, bound);
            }
            engine.queue.submit([encoder.finish()]);
            let rows = self.read_attributes(id, chunk.len as u64);
            self.give_columns(columns);
            rows
        })?;
        self.recycle(chunk);
        Ok(rows)
    }
}

fn compute_pass<'e>(encoder: &'e mut wgpu::CommandEncoder, label: &'static str) -> wgpu::ComputePass<'e> {
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None })
}
