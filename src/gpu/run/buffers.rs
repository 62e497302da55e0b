//! The buffers of a run, and what its kernels are bound to.

use super::super::buffers as making;
use super::super::kernels::{Binding, Kernel, SharedKernels, StageKernels};
use super::super::{Engine, Error};
use crate::plan::Plan;
use crate::plan::derive::StageId;
use crate::plan::step::{Extent, Status};
use crate::plan::turns::{Progress, TurnWords};
use std::collections::HashMap;
use wgpu::BufferUsages;

/// Uniforms of a buffer of several begin at multiples of this.
pub(super) const SLOT: u64 = 256;

/// Bytes of the workgroups of a sweep: for an invocation a module, for their scan, and for emit.
pub(super) const DISPATCH_BYTES: u64 = 48;

/// Where modules stand: the axiom, and two buffers that take turns.
pub(super) const PLACES: usize = 3;

/// The place that a sweep writes which reads this one.
pub(super) fn next(place: usize) -> usize {
    if place == 1 { 2 } else { 1 }
}

pub(super) struct Buffers {
    /// Of the axiom, which the host writes, then of the words.
    pub records: [wgpu::Buffer; PLACES],
    pub nets: [wgpu::Buffer; PLACES],
    pub rules: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    pub offsets: wgpu::Buffer,
    pub sums: wgpu::Buffer,
    /// The values given, then the attributes measured.
    pub attributes: wgpu::Buffer,
    /// Of every turn, and one slot more, of the word.
    pub extents: wgpu::Buffer,
    pub dispatches: wgpu::Buffer,
    pub turns: wgpu::Buffer,
    pub status: wgpu::Buffer,
    pub progress: wgpu::Buffer,
}

/// What a run wants room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    pub modules: u32,
    /// Words that the host gives.
    pub given: usize,
    pub turns: usize,
}

impl Room {
    /// Whether there is as much of it here.
    pub fn holds(&self, other: &Room) -> bool {
        self.modules >= other.modules && self.given >= other.given && self.turns >= other.turns
    }
}

impl Buffers {
    /// Around the records and nets of an axiom. The count of derivations goes on where there were buffers before.
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        room: &Room,
        axiom: [wgpu::Buffer; 2],
        before: Option<&Buffers>,
    ) -> Result<Buffers, Error> {
        let layout = plan.tables.layout;
        let make = |label: &'static str, bytes: u64, usage| making::make(engine, label, bytes, usage);
        let storage = BufferUsages::STORAGE;
        let n = u64::from(room.modules);
        let slots = room.turns as u64 + 1;
        let tiles = n.div_ceil(u64::from(engine.tuning().tile()));
        let measured = plan.tables.most_measured() as u64;
        let [records, nets] = axiom;
        let record = |label| make(label, n * layout.record_bytes(), storage);
        let net = |label| make(label, n * layout.net_bytes(), storage);
        Ok(Buffers {
            records: [records, record("burgeon records")?, record("burgeon records in turn")?],
            nets: [nets, net("burgeon nets")?, net("burgeon nets in turn")?],
            rules: make("burgeon rules", n * 4, storage)?,
            counts: make("burgeon counts", n * 4, storage)?,
            offsets: make("burgeon offsets", (n + 1) * 4, storage)?,
            sums: make("burgeon sums", (tiles + 1) * 4, storage)?,
            attributes: make("burgeon attributes", (room.given as u64 + n * measured) * 4, storage)?,
            extents: make("burgeon extents", slots * SLOT, storage | BufferUsages::UNIFORM)?,
            dispatches: make("burgeon workgroups", slots * DISPATCH_BYTES, storage | BufferUsages::INDIRECT)?,
            turns: make("burgeon turns", slots * SLOT, BufferUsages::UNIFORM)?,
            status: make("burgeon status", size_of::<Status>() as u64, storage)?,
            progress: match before {
                Some(before) => before.progress.clone(),
                None => make("burgeon progress", size_of::<Progress>() as u64, storage)?,
            },
        })
    }
}

/// What the kernels are bound to; those of a stage from each place.
pub(super) struct Groups {
    pub stages: HashMap<StageId, [StageGroups; PLACES]>,
    pub scan: wgpu::BindGroup,
    pub proceed: wgpu::BindGroup,
}

pub(super) struct StageGroups {
    pub measure: Option<wgpu::BindGroup>,
    pub matching: wgpu::BindGroup,
    pub count: wgpu::BindGroup,
    pub emit: wgpu::BindGroup,
}

impl Groups {
    pub fn new(
        engine: &Engine,
        stages: &HashMap<StageId, StageKernels>,
        shared: &SharedKernels,
        proceed: &Kernel,
        b: &Buffers,
    ) -> Groups {
        let extent = Binding { buffer: &b.extents, offset: 0, bytes: size_of::<Extent>() as u64 };
        let turn = Binding { buffer: &b.turns, offset: 0, bytes: size_of::<TurnWords>() as u64 };
        let [rules, counts, offsets, sums] = [&b.rules, &b.counts, &b.offsets, &b.sums].map(Binding::whole);
        let [attributes, status] = [&b.attributes, &b.status].map(Binding::whole);
        let of_stage = |kernels: &StageKernels, place: usize| {
            let environment = Binding::whole(&kernels.environment);
            let [records, nets] = [&b.records[place], &b.nets[place]].map(Binding::whole);
            let [next_records, next_nets] =
                [&b.records[next(place)], &b.nets[next(place)]].map(Binding::whole);
            let bind = |kernel: &Kernel, bound: &[Binding]| kernel.bind(engine, bound);
            StageGroups {
                measure: kernels
                    .measure
                    .as_ref()
                    .map(|kernel| bind(kernel, &[extent, environment, records, nets, attributes])),
                matching: bind(
                    &kernels.match_modules,
                    &[extent, environment, records, attributes, rules, status],
                ),
                count: bind(&kernels.count, &[extent, environment, rules, counts]),
                emit: bind(
                    &kernels.emit,
                    &[
                        extent,
                        environment,
                        records,
                        nets,
                        rules,
                        offsets,
                        attributes,
                        next_records,
                        next_nets,
                        status,
                    ],
                ),
            }
        };
        let from_each = |kernels| [0, 1, 2].map(|place| of_stage(kernels, place));
        let [extents, dispatches, progress] = [&b.extents, &b.dispatches, &b.progress].map(Binding::whole);
        Groups {
            stages: stages.iter().map(|(id, kernels)| (*id, from_each(kernels))).collect(),
            scan: shared.scan.bind(engine, &[extent, counts, offsets, sums]),
            proceed: proceed.bind(engine, &[turn, offsets, status, extents, dispatches, progress]),
        }
    }
}
