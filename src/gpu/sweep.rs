//! One sweep on a device: its columns, the recording of its passes, what is read of them.
//!
//! A sweep is two submissions: measure, match, count, scan and compact; then, when the host has read
//! the three totals and allocated exactly what they ask for, emit and retire. Where the growth is a
//! closed form only the second is made, and nothing is read or waited for.

use super::Error;
use super::backend::{EXTENT_STRIDE, Gpu, GpuChunk, READ_BYTES, STATUS_BYTES};
use super::buffers::{self, Pooled};
use super::kernels::{self, Binding};
use crate::plan::compare::Trace;
use crate::plan::derive::{Outcome, StageId};
use crate::plan::layout::MAX_HALVINGS;
use crate::plan::step::{Clock, Extent, Status};
use crate::plan::tables::Stage;

/// Columns of a sweep.
pub(super) struct Columns {
    rules: Pooled,
    counts: Pooled,
    offsets: Pooled,
    sums: Pooled,
    retired: Pooled,
    retired_sums: Pooled,
    links: Pooled,
}

/// A column, or as much of it as there is: where the growth is closed nobody reads it.
fn bound_column(column: &Pooled, bytes: u64) -> Binding<'_> {
    Binding::new(&column.buffer, bytes.min(column.buffer.size()))
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

impl Gpu {
    pub(super) fn columns(&mut self, n: u64) -> Result<Columns, Error> {
        let sums = (n.div_ceil(self.engine.tuning.tile() as u64) + 1) * 4;
        // Sections of the column of links.
        let links = if self.layout().link.is_some() { 4 * 4 * n } else { 4 };
        let mut take = |label, bytes| self.pool.take(&self.engine, label, bytes);
        Ok(Columns {
            rules: take("burgeon rules", n * 4)?,
            counts: take("burgeon counts", n * 4)?,
            offsets: take("burgeon offsets", n * 4 + 4)?,
            sums: take("burgeon sums", sums)?,
            retired: take("burgeon retired", n * 4)?,
            retired_sums: take("burgeon retired sums", sums)?,
            links: take("burgeon links", links)?,
        })
    }

    pub(super) fn give_columns(&mut self, columns: Columns) {
        let Columns { rules, counts, offsets, sums, retired, retired_sums, links } = columns;
        [rules, counts, offsets, sums, retired, retired_sums, links]
            .into_iter()
            .for_each(|c| self.pool.give(c));
    }

    /// What a dispatch over a chunk needs that reads its modules alone.
    pub(super) fn write_count(&self, chunk: &GpuChunk) {
        let (count, given) = (chunk.len as u32, self.given.words.len() as u32);
        self.write_extent(0, Extent { count, given, ..Extent::default() });
    }

    fn write_extent(&self, slot: u64, extent: Extent) {
        self.engine.queue.write_buffer(&self.extents, slot * EXTENT_STRIDE, bytemuck::bytes_of(&extent));
    }

    pub(super) fn extent(&self, slot: u64) -> Binding<'_> {
        Binding { buffer: &self.extents, offset: slot * EXTENT_STRIDE, bytes: size_of::<Extent>() as u64 }
    }

    /// Makes room for the attributes that the stage reads of so many modules, behind what is given.
    pub(super) fn room_for_attributes(&mut self, stage: &Stage, n: u64) -> Result<(), Error> {
        let given = self.given.words.len() as u64;
        let bytes = (given + n * stage.row.words as u64) * 4;
        if self.attributes.size() < bytes {
            self.attributes = self.pool.take(&self.engine, "burgeon attributes", bytes)?.buffer;
            self.write_given();
        }
        Ok(())
    }

    pub(super) fn write_given(&self) {
        self.engine.queue.write_buffer(&self.attributes, 0, bytemuck::cast_slice(&self.given.words));
    }

    /// The words given and the attributes of so many modules.
    pub(super) fn attributes(&self, stage: &Stage, n: u64) -> Binding<'_> {
        let words = self.given.words.len() as u64 + n * stage.row.words as u64;
        Binding::new(&self.attributes, words * 4)
    }

    /// The attributes that the rules read, into room that is there.
    fn measure(&self, pass: &mut wgpu::ComputePass, id: StageId, chunk: &GpuChunk, slot: u64) {
        let (stage, layout, n) = (id.of(&self.plan), self.layout(), chunk.len as u64);
        self.turtle(pass, id, chunk, slot);
        let kernels = &self.stages[&id];
        let Some(kernel) = &kernels.measure else { return };
        let bound = [
            self.extent(slot),
            Binding::new(&kernels.environment, kernels.environment.size()),
            Binding::new(chunk.records(), layout.chunk_bytes(n)),
            Binding::new(chunk.nets(), n * layout.net_bytes()),
            self.attributes(stage, n),
        ];
        let group = kernel.bind(&self.engine, &bound);
        kernel.record(pass, &group, &[kernels::groups(n, self.engine.tuning().workgroup)]);
    }

    /// measure → match → count → scan, and compact; then the totals, read.
    fn totals(&mut self, sweep: Sweep) -> Result<Totals, Error> {
        let Sweep { id, clock, chunk, columns } = sweep;
        let plan = self.plan.clone();
        let stage: &Stage = id.of(&plan);
        let n = chunk.len as u64;
        let given = self.given.words.len() as u32;
        let curve = self.layout().is_curve();
        let wanted = if curve { chunk.behind as u32 } else { stage.retired() };
        let claimed = if chunk.before == 0 { 0 } else { self.claimed };
        self.write_extent(0, Extent { count: n as u32, wanted, clock, given, ..Extent::default() });
        let status = Status { claimed, ..Status::default() };
        self.engine.queue.write_buffer(&self.status, 0, bytemuck::bytes_of(&status));
        let mut encoder = self.encoder("burgeon match, count, scan");
        let tuning = *self.engine.tuning();
        let tiles = n.div_ceil(tuning.tile() as u64);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("burgeon match, count, scan"),
                timestamp_writes: None,
            });
            let one_each = [kernels::groups(n, tuning.workgroup)];
            self.measure(&mut pass, id, chunk, 0);
            let kernels = &self.stages[&id];
            let environment = Binding::new(&kernels.environment, kernels.environment.size());
            let records = Binding::new(chunk.records(), self.layout().chunk_bytes(n));
            let rules = Binding::new(&columns.rules.buffer, n * 4);
            let counts = Binding::new(&columns.counts.buffer, n * 4);
            let sums = |b| Binding::new(b, (tiles + 1) * 4);
            let status = Binding::new(&self.status, STATUS_BYTES);
            let attributes = self.attributes(stage, n);
            let links = Binding::whole(&columns.links.buffer);
            let linking = kernels.link.as_ref().map(|link| {
                (link, link.bind(&self.engine, &[self.extent(0), environment, records, rules, links]))
            });
            let ignoring = self.plan.tables.ignored.contains(&true);
            if let Some((link, group)) = &linking {
                let calls = kernels::link_calls(n, stage.sees_branches(), ignoring);
                link.record_entries(&mut pass, group, &calls, one_each[0]);
            }
            let mut bound = vec![self.extent(0), environment, records, attributes, rules, status];
            bound.extend(kernels.link.as_ref().map(|_| links));
            let group = kernels.match_modules.bind(&self.engine, &bound);
            kernels.match_modules.record(&mut pass, &group, &one_each);
            if let Some(claim) = &kernels.claim {
                let bound = [self.extent(0), environment, rules, sums(&columns.sums.buffer), status];
                let group = claim.bind(&self.engine, &bound);
                claim.record(&mut pass, &group, &kernels::scan_groups(n, tuning.tile()));
            }
            if let Some((link, group)) = &linking {
                let calls = kernels::hang_calls(n, stage.unhangs());
                link.record_entries(&mut pass, group, &calls, one_each[0]);
            }
            let group = kernels.count.bind(&self.engine, &[self.extent(0), environment, rules, counts]);
            kernels.count.record(&mut pass, &group, &one_each);
            let offsets = Binding::new(&columns.offsets.buffer, n * 4 + 4);
            let bound = [self.extent(0), counts, offsets, sums(&columns.sums.buffer)];
            let group = self.shared.scan.bind(&self.engine, &bound);
            self.shared.scan.record(&mut pass, &group, &kernels::scan_groups(n, tuning.tile()));
            if stage.may_retire() {
                let retired = Binding::new(&columns.retired.buffer, n * 4);
                let bound = [self.extent(0), rules, retired, sums(&columns.retired_sums.buffer)];
                let group = self.shared.compact.bind(&self.engine, &bound);
                self.shared.compact.record(&mut pass, &group, &kernels::scan_groups(n, tuning.tile()));
            }
        }
        encoder.copy_buffer_to_buffer(&self.status, 0, &self.staging, 0, STATUS_BYTES);
        encoder.copy_buffer_to_buffer(&columns.sums.buffer, tiles * 4, &self.staging, STATUS_BYTES, 4);
        encoder.copy_buffer_to_buffer(
            &columns.retired_sums.buffer,
            tiles * 4,
            &self.staging,
            STATUS_BYTES + 4,
            4,
        );
        self.engine.queue.submit([encoder.finish()]);
        let words: Vec<u32> = buffers::mapped(
            &self.engine,
            "reading the totals of a step",
            &self.staging,
            READ_BYTES,
            |bytes| bytes.chunks_exact(4).map(bytemuck::pod_read_unaligned).collect(),
        )?;
        let status: Status = bytemuck::pod_read_unaligned(bytemuck::cast_slice(&words[..8]));
        self.claimed = status.claimed;
        let retired = if stage.may_retire() { words[9] as usize } else { 0 };
        Ok(Totals { status, modules: words[8] as usize, retired })
    }

    /// emit, and retire where modules are retired.
    fn write(&mut self, sweep: Sweep, next: Option<Target>, finished: Option<Target>) {
        let Sweep { id, clock, chunk, columns } = sweep;
        let layout = self.layout();
        let n = chunk.len as u64;
        let tuning = *self.engine.tuning();
        let extent = |count: usize, capacity: usize| Extent {
            count: count as u32,
            capacity: capacity as u32,
            wanted: self.made,
            clock,
            given: self.given.words.len() as u32,
            ..Extent::default()
        };
        let mut encoder = self.encoder("burgeon emit, retire");
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("burgeon emit, retire"),
                timestamp_writes: None,
            });
            let kernels = &self.stages[&id];
            let status = Binding::new(&self.status, STATUS_BYTES);
            let records = |c: &'_ GpuChunk| layout.chunk_bytes(c.len as u64);
            let nets = |c: &'_ GpuChunk| c.len as u64 * layout.net_bytes();
            if let Some(Target { chunk: next, capacity, .. }) = next {
                self.write_extent(1, extent(chunk.len, capacity));
                let stage = id.of(&self.plan);
                if stage.closed.is_some() {
                    self.measure(&mut pass, id, chunk, 1);
                }
                let bound = [
                    self.extent(1),
                    Binding::new(&kernels.environment, kernels.environment.size()),
                    Binding::new(chunk.records(), records(chunk)),
                    Binding::new(chunk.nets(), nets(chunk)),
                    bound_column(&columns.rules, n * 4),
                    bound_column(&columns.offsets, n * 4 + 4),
                    self.attributes(stage, n),
                    Binding::new(next.records(), records(next)),
                    Binding::new(next.nets(), nets(next)),
                    status,
                ];
                // Curves have no nets.
                let mut curve = [0, 1, 2, 4, 5, 6, 7, 9].map(|n| bound[n]).to_vec();
                curve.extend(kernels.link.as_ref().map(|_| Binding::whole(&columns.links.buffer)));
                let bound = if layout.is_curve() { &curve[..] } else { &bound[..] };
                let group = kernels.emit.bind(&self.engine, bound);
                let invocations = match layout.is_curve() {
                    true => tuning.word_invocations(n, stage),
                    false => tuning.emit_invocations(n, &layout),
                };
                kernels.emit.record(&mut pass, &group, &[kernels::groups(invocations, tuning.workgroup)]);
            }
            if let Some(Target { chunk: finished, capacity, modules }) = finished {
                self.write_extent(2, extent(modules, capacity));
                let bound = [
                    self.extent(2),
                    Binding::new(chunk.records(), records(chunk)),
                    Binding::new(chunk.nets(), nets(chunk)),
                    Binding::new(&columns.retired.buffer, n * 4),
                    Binding::new(finished.records(), records(finished)),
                    Binding::new(finished.nets(), nets(finished)),
                    status,
                ];
                let group = self.shared.retire.bind(&self.engine, &bound);
                let groups = [kernels::groups(modules as u64, tuning.workgroup)];
                self.shared.retire.record(&mut pass, &group, &groups);
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
            let plan = self.plan.clone();
            self.room_for_attributes(id.of(&plan), chunk.len as u64)?;
            self.room_for_turtle(id.of(&plan), chunk)?;
            let columns = self.columns(chunk.len as u64)?;
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
            let read = |c: &Pooled, words: u64| {
                if words == 0 {
                    return Ok(Vec::new());
                }
                buffers::read::<u32>(&self.engine, "reading a pass", &c.buffer, words * 4)
            };
            trace = Trace {
                attributes: self.read_attributes(id, n)?,
                rules: read(&columns.rules, n)?,
                counts: read(&columns.counts, n)?,
                offsets: read(&columns.offsets, n + 1)?,
                retired: read(&columns.retired, retired as u64)?,
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
}
