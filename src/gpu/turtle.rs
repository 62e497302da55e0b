//! The turtle of a sweep: its buffers, and how its dispatches are recorded.

use super::backend::{Gpu, GpuChunk};
use super::kernels::{self, Binding};
use super::{Engine, Error, buffers};
use crate::plan::derive::StageId;
use crate::plan::tables::Stage;
use crate::plan::turtle::{MOTION_WORDS, STILL};

const MOTION_BYTES: u64 = MOTION_WORDS as u64 * 4;

/// What the turtle keeps.
pub(super) struct Turtle {
    /// Its state behind the chunk before.
    carried: wgpu::Buffer,
    /// Motions of tiles; in words with links two of each module.
    motions: wgpu::Buffer,
    links: wgpu::Buffer,
}

impl Turtle {
    pub fn new(engine: &Engine) -> Result<Turtle, Error> {
        Ok(Turtle {
            carried: buffers::storage(engine, "burgeon turtle", MOTION_BYTES)?,
            motions: buffers::storage(engine, "burgeon motions", MOTION_BYTES)?,
            links: buffers::storage(engine, "burgeon turtle links", 16)?,
        })
    }
}

impl Gpu {
    fn linked(&self) -> bool {
        self.layout().link.is_some()
    }

    /// Bytes of the motions and of the links of so many modules.
    fn turtle_bytes(&self, n: u64) -> [u64; 2] {
        match self.linked() {
            true => [2 * n * MOTION_BYTES, 2 * n * 4],
            false => [n.div_ceil(self.engine.tuning.tile() as u64) * MOTION_BYTES, 0],
        }
    }

    /// Modules of which a turtle can hold the motions in one binding.
    pub(super) fn most_turtle(&self, binding: u64) -> u64 {
        let traces = self.plan.tables.rule_sets.iter().flat_map(|set| &set.stages).any(|s| s.row.turtle);
        if traces && self.linked() { binding / (2 * MOTION_BYTES) } else { u64::MAX }
    }

    /// Makes room for the motions of so many modules; at the start of a word the turtle stands at the origin.
    pub(super) fn room_for_turtle(&mut self, stage: &Stage, chunk: &GpuChunk) -> Result<(), Error> {
        if !stage.row.turtle {
            return Ok(());
        }
        let [motions, links] = self.turtle_bytes(chunk.len as u64);
        if self.turtle.motions.size() < motions {
            self.turtle.motions = buffers::storage(&self.engine, "burgeon motions", motions)?;
        }
        if self.turtle.links.size() < links {
            self.turtle.links = buffers::storage(&self.engine, "burgeon turtle links", links)?;
        }
        if chunk.before == 0 {
            self.engine.queue.write_buffer(&self.turtle.carried, 0, bytemuck::cast_slice(&STILL));
        }
        Ok(())
    }

    /// Records what writes the rows of a chunk.
    pub(super) fn turtle(&self, pass: &mut wgpu::ComputePass, id: StageId, chunk: &GpuChunk, slot: u64) {
        let Some(kernel) = &self.stages[&id].turtle else { return };
        let n = chunk.len as u64;
        let [motions, links] = self.turtle_bytes(n);
        let last = match self.linked() {
            true => Binding::new(&self.turtle.links, links),
            false => Binding::new(&self.turtle.carried, MOTION_BYTES),
        };
        let bound = [
            self.extent(slot),
            Binding::new(chunk.records(), self.layout().chunk_bytes(n)),
            self.attributes(id.of(&self.plan), n),
            Binding::new(&self.turtle.motions, motions),
            last,
        ];
        let group = kernel.bind(&self.engine, &bound);
        let tuning = self.engine.tuning();
        if !self.linked() {
            kernel.record(pass, &group, &kernels::scan_groups(n, tuning.tile()));
            return;
        }
        let each = kernels::groups(n, tuning.workgroup);
        let rounds = u64::BITS - n.saturating_sub(1).leading_zeros();
        let [begin, away, back, last] = [0, 1, 2, 3];
        let turns = (0..rounds.next_multiple_of(2)).map(|n| if n % 2 == 0 { away } else { back });
        for entry in [begin].into_iter().chain(turns).chain([last]) {
            kernel.record_entry(pass, &group, entry, each);
        }
    }

    /// The rows that a trace measures of these records, which are one chunk.
    ///
    /// # Errors
    /// What the device says.
    #[doc(hidden)]
    pub fn turtle_rows(&mut self, id: StageId, records: Vec<u32>) -> Result<Vec<u32>, Error> {
        use crate::plan::derive::Backend;
        let chunk = self.upload(records, Vec::new())?;
        self.compile_stage(id)?;
        let engine = self.engine.clone();
        let rows = engine.checked("tracing", || {
            let plan = self.plan.clone();
            self.room_for_attributes(id.of(&plan), chunk.len as u64)?;
            self.room_for_turtle(id.of(&plan), &chunk)?;
            self.write_count(&chunk);
            let mut encoder = self.encoder("burgeon turtle");
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some("burgeon turtle"),
                    timestamp_writes: None,
                });
                self.turtle(&mut pass, id, &chunk, 0);
            }
            engine.queue.submit([encoder.finish()]);
            self.read_attributes(id, chunk.len as u64)
        })?;
        self.recycle(chunk);
        Ok(rows)
    }
}
