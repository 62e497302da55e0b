//! The buffers of a run, and what its kernels are bound to.

use super::super::buffers as making;
use super::super::kernels::{Binding, Kernel, Kernels, label};
use super::super::{Engine, Error};
use super::starts::{StartGroups, Starts};
use crate::plan::Plan;
use crate::plan::columns::Stored;
use crate::plan::derive::StageId;
use crate::plan::program;
use crate::plan::step::{Column, Extent};
use crate::plan::turns::{Progress, TurnWords};
use std::collections::HashMap;
use wgpu::BufferUsages;

/// Uniforms of a buffer of several begin at multiples of this.
pub(super) const SLOT: u64 = 256;

/// Bytes of the workgroups of a sweep: for an invocation a module, for their scan, and for their children.
pub(super) const DISPATCH_BYTES: u64 = 48;

/// Where modules stand: the axiom, and two buffers that take turns.
pub(super) const PLACES: usize = 3;

/// The place that a sweep writes which reads this one.
pub(super) fn next(place: usize) -> usize {
    if place == 1 { 2 } else { 1 }
}

/// The columns of a word; none of those that it has not.
pub(super) type Stand = [Option<wgpu::Buffer>; Stored::COUNT];

pub(super) struct Buffers {
    /// Of the axiom, which the host writes, then of the words.
    pub places: [Stand; PLACES],
    /// What sweeps write besides, as large as that of any stage; the values given stand before the attributes.
    columns: HashMap<Column, wgpu::Buffer>,
    /// Bound where a pass reads a column that nothing has written, and does not look at it.
    nothing: wgpu::Buffer,
    /// Of every turn, and one slot more, of the word.
    pub extents: wgpu::Buffer,
    pub dispatches: wgpu::Buffer,
    pub turns: wgpu::Buffer,
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
    /// Around the columns of an axiom. The count of derivations goes on where there were buffers before.
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        room: &Room,
        axiom: Stand,
        before: Option<&Buffers>,
    ) -> Result<Buffers, Error> {
        let layout = plan.tables.layout;
        let make = |label: &'static str, bytes: u64, usage| making::make(engine, label, bytes, usage);
        let storage = BufferUsages::STORAGE;
        let (n, tile) = (u64::from(room.modules), engine.tuning().tile());
        let slots = room.turns as u64 + 1;
        let stand = || {
            let mut stand: Stand = [const { None }; Stored::COUNT];
            for column in layout.columns() {
                let bytes = layout.shape(column).chunk_bytes(n);
                stand[column as usize] = Some(make(label(Column::Before(column)), bytes, storage)?);
            }
            Ok::<_, Error>(stand)
        };
        // What is given, and what is read between sweeps, those of closed growth among them.
        let given = (room.given as u64 * 4).max(16);
        let mut sizes = vec![(Column::Attributes, given), (Column::Offsets, 32), (Column::Status, 32)];
        for stage in plan.stages().into_iter().map(|id| id.of(plan)) {
            let written = stage.program.recorded().flat_map(|work| &work.bindings).filter(|bound| bound.1);
            for &(column, _) in written {
                let Some(size) = program::size(column, stage, room.given) else { continue };
                let bytes = size.bytes(n, tile);
                match sizes.iter_mut().find(|known| known.0 == column) {
                    Some((_, most)) => *most = bytes.max(*most),
                    None => sizes.push((column, bytes)),
                }
            }
        }
        let mut columns = HashMap::new();
        for (column, bytes) in sizes {
            columns.insert(column, make(label(column), bytes, storage)?);
        }
        Ok(Buffers {
            places: [axiom, stand()?, stand()?],
            columns,
            nothing: make("burgeon nothing", 16, storage)?,
            extents: make("burgeon extents", slots * SLOT, storage | BufferUsages::UNIFORM)?,
            dispatches: make("burgeon workgroups", slots * DISPATCH_BYTES, storage | BufferUsages::INDIRECT)?,
            turns: make("burgeon turns", slots * SLOT, BufferUsages::UNIFORM)?,
            progress: match before {
                Some(before) => before.progress.clone(),
                None => make("burgeon progress", size_of::<Progress>() as u64, storage)?,
            },
        })
    }

    /// A column of the sweeps.
    pub fn column(&self, column: Column) -> &wgpu::Buffer {
        self.columns.get(&column).unwrap_or(&self.nothing)
    }

    /// What a pass binds as a column that reads this place.
    fn binding<'b>(&'b self, kernels: &'b Kernels, id: StageId, column: Column, place: usize) -> Binding<'b> {
        let stands = |place: usize, stored: Stored| self.places[place][stored as usize].as_ref();
        Binding::whole(match column {
            Column::Before(stored) => stands(place, stored).unwrap_or(&self.nothing),
            Column::After(stored) => stands(next(place), stored).unwrap_or(&self.nothing),
            Column::Environment => return kernels.environment(id),
            Column::Extent => {
                let bytes = size_of::<Extent>() as u64;
                return Binding { buffer: &self.extents, offset: 0, bytes };
            }
            other => self.column(other),
        })
    }
}

/// What the kernels are bound to.
pub(super) struct Groups {
    /// Of a stage from each place, one for each pass of its program.
    pub stages: HashMap<StageId, [Vec<wgpu::BindGroup>; PLACES]>,
    pub proceed: wgpu::BindGroup,
    pub starts: StartGroups,
}

impl Groups {
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        kernels: &Kernels,
        proceed: &Kernel,
        starts: &Starts,
        b: &Buffers,
    ) -> Groups {
        let turn = Binding { buffer: &b.turns, offset: 0, bytes: size_of::<TurnWords>() as u64 };
        let from = |id: StageId, place: usize| {
            id.of(plan)
                .program
                .recorded()
                .map(|work| {
                    let columns = work.bindings.iter();
                    let bound: Vec<Binding> =
                        columns.map(|&(column, _)| b.binding(kernels, id, column, place)).collect();
                    kernels.of(id, work.pass).bind(engine, &bound)
                })
                .collect()
        };
        let [extents, dispatches, progress] = [&b.extents, &b.dispatches, &b.progress].map(Binding::whole);
        let [offsets, status] = [Column::Offsets, Column::Status].map(|c| Binding::whole(b.column(c)));
        let stages = plan.stages().into_iter().map(|id| (id, [0, 1, 2].map(|place| from(id, place))));
        Groups {
            stages: stages.collect(),
            proceed: proceed.bind(engine, &[turn, offsets, status, extents, dispatches, progress]),
            starts: starts.groups(engine, b),
        }
    }
}
