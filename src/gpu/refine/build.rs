//! What a refiner records: buffers, kernels and dispatches, made once.

use super::super::kernels::{Binding, Bound, Kernel, groups};
use super::super::{Engine, Error, buffers};
use super::tables::{self, Tables};
use super::{Dispatch, Params, Part, Refiner, large, uploaded};
use crate::codegen::{self, Around, Levels};
use crate::mesh::Topology;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use wgpu::BufferUsages;

/// What a refiner is made with.
pub struct Builder<'a> {
    engine: &'a Engine,
    topology: &'a Arc<Topology>,
    /// Levels counted from the roots.
    kept: Vec<u32>,
    levels: BTreeMap<u32, wgpu::Buffer>,
    mesh: wgpu::Buffer,
    /// The points of the roots: those of the mesh where these are its faces.
    points: wgpu::Buffer,
    roots: wgpu::Buffer,
    extras: wgpu::Buffer,
    rings: wgpu::Buffer,
    weights: wgpu::Buffer,
    /// Stand where nothing is written: no two in one dispatch may be the same.
    unused: [wgpu::Buffer; 3],
    tables: Tables,
    /// Parameters of all dispatches.
    params: Vec<Params>,
    kernels: codegen::Refinement,
}

/// What is recorded, before its parameters have a buffer: a kernel, its bindings without these, and over how much.
type Planned<'a> = (Kernel, Vec<(wgpu::Buffer, Part)>, u64);

impl<'a> Builder<'a> {
    pub fn new(
        engine: &'a Engine,
        topology: &'a Arc<Topology>,
        levels: &[u32],
    ) -> Result<Builder<'a>, Error> {
        let last = levels.iter().copied().max().unwrap_or(0);
        let creases = topology.creases(last)?;
        let first = topology.first_level();
        let storage = |label, bytes: u64| buffers::storage(engine, label, bytes);
        let mut buffers = BTreeMap::new();
        for &level in levels {
            let usage = BufferUsages::STORAGE | BufferUsages::VERTEX;
            let bytes = 12 * topology.counts(level).vertices;
            buffers.insert(level, large(engine, "burgeon vertices", bytes, usage)?);
        }
        let mesh = storage("burgeon points of a mesh", 16 * topology.mesh_vertices() as u64)?;
        let points = match &topology.first {
            None => mesh.clone(),
            Some(first) => storage("burgeon points of roots", 16 * first.len() as u64)?,
        };
        let tables = Tables::new(topology, &creases);
        let ring_points = topology.rings.points.len() as u64 * (creases.levels() as u64 + 1);
        let unused = || storage("burgeon nothing", 16);
        Ok(Builder {
            engine,
            topology,
            kept: levels.iter().filter_map(|level| level.checked_sub(first)).collect(),
            levels: buffers,
            mesh,
            points,
            roots: uploaded(engine, "burgeon roots", bytemuck::cast_slice(&tables.roots))?,
            extras: uploaded(engine, "burgeon special roots", bytemuck::cast_slice(&tables.extras))?,
            rings: storage("burgeon rings", 16 * ring_points)?,
            weights: uploaded(engine, "burgeon weights of creases", bytemuck::cast_slice(creases.weights()))?,
            unused: [unused()?, unused()?, unused()?],
            tables,
            params: Vec::new(),
            kernels: codegen::refinement(topology.options.scheme, &engine.tuning, engine.edit.as_ref())?,
        })
    }

    pub fn build(mut self, most_roots: usize) -> Result<Refiner, Error> {
        let mut planned = Vec::new();
        planned.extend(self.first()?);
        planned.extend(self.rings()?);
        self.tiles(most_roots, &mut planned)?;
        let engine = self.engine;
        // Slots of one buffer, each where the device lets one begin.
        let step = u64::from(engine.device.limits().min_uniform_buffer_offset_alignment).max(32);
        let mut bytes = vec![0u8; (step as usize) * self.params.len().max(1)];
        for (slot, params) in bytes.chunks_mut(step as usize).zip(&self.params) {
            slot[..size_of::<Params>()].copy_from_slice(bytemuck::bytes_of(params));
        }
        let params = buffers::make(engine, "burgeon parameters", bytes.len() as u64, BufferUsages::UNIFORM)?;
        engine.queue.write_buffer(&params, 0, &bytes);
        let dispatch = |(n, (kernel, bound, count)): (usize, Planned)| {
            let slot =
                Binding { buffer: &params, offset: n as u64 * step, bytes: size_of::<Params>() as u64 };
            let bindings: Vec<Binding> =
                std::iter::once(slot).chain(bound.iter().map(|(buffer, part)| part.bind(buffer))).collect();
            let group = kernel.bind(engine, &bindings);
            Dispatch { group, groups: groups(count, engine.tuning.workgroup), kernel }
        };
        let dispatches = planned.into_iter().enumerate().map(dispatch).collect();
        Ok(Refiner {
            engine: engine.clone(),
            topology: self.topology.clone(),
            points: self.mesh,
            levels: self.levels,
            dispatches,
        })
    }

    fn whole(buffer: &wgpu::Buffer) -> (wgpu::Buffer, Part) {
        (buffer.clone(), Part { offset: 0, bytes: buffer.size() })
    }

    /// The points of roots that are no faces of the mesh.
    fn first(&mut self) -> Result<Option<Planned<'a>>, Error> {
        let Some(first) = &self.topology.first else { return Ok(None) };
        let engine = self.engine;
        let terms: Vec<[u32; 2]> = first
            .points
            .iter()
            .zip(&first.weights)
            .map(|(&point, weight)| [point, weight.to_bits()])
            .collect();
        let starts = uploaded(engine, "burgeon rows of points", bytemuck::cast_slice(&first.starts))?;
        let terms = uploaded(engine, "burgeon terms of points", bytemuck::cast_slice(&terms))?;
        let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Read, Bound::Written];
        let kernel = Kernel::with_bindings(engine, &self.kernels.first, &bound, &["first"]);
        let count = first.len() as u64;
        self.params.push(Params { count: count as u32, ..Params::default() });
        Ok(Some((kernel, [&self.mesh, &starts, &terms, &self.points].map(Self::whole).into(), count)))
    }

    fn rings(&mut self) -> Result<Option<Planned<'a>>, Error> {
        let rings = &self.topology.rings;
        if rings.rings.is_empty() {
            return Ok(None);
        }
        let engine = self.engine;
        let list = uploaded(engine, "burgeon list of rings", bytemuck::cast_slice(&self.tables.rings))?;
        let numbers = uploaded(engine, "burgeon points of rings", bytemuck::cast_slice(&rings.points))?;
        let plans = uploaded(engine, "burgeon plans of rings", bytemuck::cast_slice(&self.tables.plans))?;
        let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Read, Bound::Read, Bound::Written];
        let kernel = Kernel::with_bindings(engine, &self.kernels.rings, &bound, &["refine_rings"]);
        let count = rings.rings.len() as u64;
        let levels = self.kept.iter().copied().max().unwrap_or(0);
        // The third word is how many levels there are.
        self.params.push(Params { count: count as u32, n: levels, ..Params::default() });
        let buffers = [&self.points, &list, &numbers, &plans, &self.rings];
        Ok(Some((kernel, buffers.map(Self::whole).into(), count)))
    }

    /// The steps in which tiles are refined: from which level, and how many at once.
    fn steps(&self) -> Vec<(u32, u32)> {
        let last = self.kept.iter().copied().max().unwrap_or(0);
        if last == 0 {
            return vec![(0, 0)];
        }
        // A single level first, where tiles are small.
        let mut steps = if last % 2 == 1 { vec![(0, 1)] } else { Vec::new() };
        steps.extend((last % 2..last).step_by(2).map(|level| (level, 2)));
        if self.kept.contains(&0) {
            steps.insert(0, (0, 0));
        }
        steps
    }

    fn tiles(&mut self, most_roots: usize, planned: &mut Vec<Planned<'a>>) -> Result<(), Error> {
        if self.kept.is_empty() {
            return Ok(());
        }
        let (engine, topology) = (self.engine, self.topology);
        let roots = &topology.roots;
        let steps = self.steps();
        let bytes_of = |level: u32| 16 * ((1u64 << level) + 3).pow(2);
        // Bytes of a root, in the largest tile and among vertices.
        let tile = steps.iter().map(|(level, _)| bytes_of(*level)).max().unwrap_or(16);
        let last = self.kept.iter().copied().max().unwrap_or(0);
        let grid = 12 * ((1u64 << last) + 1).pow(2);
        let most = engine
            .device
            .limits()
            .max_storage_buffer_binding_size
            .min(engine.device.limits().max_buffer_size);
        let fits = (most / 2 / tile.max(grid)).max(1) as usize;
        let chunk = most_roots.min(fits).clamp(1, roots.len().max(1));
        let tiles =
            [0, 1].map(|_| large(engine, "burgeon tiles", chunk as u64 * tile, BufferUsages::STORAGE));
        let [a, b] = tiles;
        let tiles = [a?, b?];
        let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Read, Bound::Read, Bound::Written];
        let gather = Kernel::with_bindings(engine, &self.kernels.gather, &bound, &["gather"]);
        for begin in (0..roots.len()).step_by(chunk) {
            let chunk = begin..(begin + chunk).min(roots.len());
            let count = chunk.len() as u64;
            let (first, at) = (chunk.start as u32, chunk.start as u32);
            self.params.push(Params { count: count as u32, n: 1, first, chunk: at, ..Params::default() });
            let buffers = [&self.points, &self.roots, &self.extras, &self.rings, &tiles[0]];
            planned.push((gather.clone(), buffers.map(Self::whole).into(), count));
            let mut place = 0;
            for (n, &step) in steps.iter().enumerate() {
                let is_last = n + 1 == steps.len();
                // Writing the roots themselves makes no tile.
                let goes_on = !is_last && step.1 > 0;
                for (around, run) in tables::runs(roots) {
                    let run = run.start.max(chunk.start)..run.end.min(chunk.end);
                    if !run.is_empty() {
                        let tiles = [&tiles[place], &tiles[1 - place]];
                        planned.push(self.level(step, around, run, chunk.start, goes_on, tiles)?);
                    }
                }
                if goes_on {
                    place = 1 - place;
                }
            }
        }
        Ok(())
    }

    /// One step of some roots.
    fn level(
        &mut self,
        (from, levels): (u32, u32),
        around: Around,
        run: Range<usize>,
        chunk: usize,
        goes_on: bool,
        [tiles, next]: [&wgpu::Buffer; 2],
    ) -> Result<Planned<'a>, Error> {
        let (engine, roots) = (self.engine, &self.topology.roots);
        let [unused_next, unused_fine, unused_coarse] = &self.unused;
        let kept = |depth: u32| self.kept.contains(&depth);
        let (fine, coarse) = (from + levels, from + 1);
        let what =
            Levels { levels, around, tile: goes_on, fine: kept(fine), coarse: levels == 2 && kept(coarse) };
        let shader =
            codegen::levels(self.topology.options.scheme, &what, &engine.tuning, engine.edit.as_ref())?;
        let bound = [
            Bound::Slot,
            Bound::Read,
            Bound::Read,
            Bound::Read,
            Bound::Read,
            Bound::Read,
            Bound::Written,
            Bound::Written,
            Bound::Written,
        ];
        let kernel = Kernel::with_bindings(engine, &shader, &bound, &["refine"]);
        let out = |is: bool, depth: u32, unused: &wgpu::Buffer| match is {
            false => Self::whole(unused),
            true => {
                let s = 1usize << depth;
                let range = 12 * roots.base(run.start, s) as u64..12 * roots.base(run.end, s) as u64;
                let level = depth + self.topology.first_level();
                (self.levels[&level].clone(), Part::of(range, engine))
            }
        };
        let (fine, coarse) = (out(what.fine, fine, unused_fine), out(what.coarse, coarse, unused_coarse));
        let count = (run.len() as u64) << (2 * from);
        self.params.push(Params {
            count: count as u32,
            zero: 0,
            n: 1 << from,
            level: from,
            first: run.start as u32,
            chunk: chunk as u32,
            fine: (fine.1.offset / 4) as u32,
            coarse: (coarse.1.offset / 4) as u32,
        });
        let next = if goes_on { next } else { unused_next };
        let buffers = [tiles, &self.roots, &self.extras, &self.rings, &self.weights, next];
        let bound: Vec<(wgpu::Buffer, Part)> =
            buffers.map(Self::whole).into_iter().chain([fine, coarse]).collect();
        Ok((kernel, bound, count))
    }
}
