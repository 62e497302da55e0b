//! Meshes refined on a device, frame by frame.
//!
//! A frame is recorded into the caller's encoder: the points of the roots where faces are no quads, the rings, the roots'
//! tiles, then two levels a dispatch. Nothing is read back and nothing allocated; what does not depend on where vertices are
//! was uploaded once.

mod tables;

use super::kernels::{Binding, Bound, Kernel, groups};
use super::{Engine, Error, buffers, warm};
use crate::codegen::{self, Around, Levels};
use crate::mesh::Topology;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use tables::Tables;
use wgpu::BufferUsages;

/// Refines a mesh whose vertices move.
///
/// ```no_run
/// use burgeon::gpu::refine::{Faces, Refiner};
/// use burgeon::gpu::{Engine, Headless, Requirement};
/// use burgeon::mesh::{Mesh, Options, Topology};
/// # let mesh = Mesh::default();
///
/// let own = Headless::new(Requirement::Any)?; // or the device and queue of your renderer
/// let engine = Engine::new(&own.device, &own.queue);
/// let topology = Topology::new(&mesh, &Options::default())?;
/// let refiner = Refiner::new(&engine, &topology, &[4])?;
/// let indices = refiner.faces(4, Faces::Triangles)?; // once
///
/// refiner.set(&mesh.positions)?; // each frame, or a kernel of yours writes refiner.points()
/// let mut encoder = own.device.create_command_encoder(&Default::default());
/// refiner.encode(&mut encoder);
/// own.queue.submit([encoder.finish()]);
/// let vertices = refiner.vertices(4); // three floats a vertex, ready to draw
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Refiner {
    engine: Engine,
    topology: Arc<Topology>,
    points: wgpu::Buffer,
    levels: BTreeMap<u32, wgpu::Buffer>,
    dispatches: Vec<Dispatch>,
}

/// The faces of a level, as indices into its vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// Four a face.
    Quads,
    /// Six a face: it is parted from its first corner to the opposite one.
    Triangles,
}

#[derive(Debug)]
struct Dispatch {
    kernel: Kernel,
    group: wgpu::BindGroup,
    groups: [u32; 2],
}

/// What `wgsl/refine` is told of a dispatch.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Params {
    count: u32,
    zero: u32,
    n: u32,
    level: u32,
    first: u32,
    chunk: u32,
    fine: u32,
    coarse: u32,
}

impl Refiner {
    /// For these levels, all of which a frame writes.
    ///
    /// # Errors
    /// A level of more vertices than 32-bit indices can name, or than the device holds in one buffer; what the device says.
    pub fn new(engine: &Engine, topology: &Topology, levels: &[u32]) -> Result<Refiner, Error> {
        Refiner::in_chunks(engine, topology, levels, usize::MAX)
    }

    /// The same, where at most so many roots are refined at once: no result depends on it.
    ///
    /// # Errors
    /// As [`Refiner::new`].
    pub fn in_chunks(
        engine: &Engine,
        topology: &Topology,
        levels: &[u32],
        most_roots: usize,
    ) -> Result<Refiner, Error> {
        let topology = Arc::new(topology.clone());
        engine
            .checked("preparing a refinement", || Builder::new(engine, &topology, levels)?.build(most_roots))
    }

    /// Writes where the vertices of the mesh are.
    ///
    /// # Errors
    /// [`Error::Vertices`] if they are not as many as the mesh has.
    pub fn set(&self, positions: &[[f32; 3]]) -> Result<(), Error> {
        let expected = self.topology.mesh_vertices();
        if positions.len() != expected {
            return Err(Error::Vertices { found: positions.len(), expected });
        }
        let points: Vec<[f32; 4]> = positions.iter().map(|&[x, y, z]| [x, y, z, 1.0]).collect();
        self.engine.queue.write_buffer(&self.points, 0, bytemuck::cast_slice(&points));
        Ok(())
    }

    /// The vertices of the mesh, a vec4 each, of which the last number says nothing: storage that kernels and copies may
    /// write.
    pub fn points(&self) -> &wgpu::Buffer {
        &self.points
    }

    /// Records a frame.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("burgeon refinement"),
            timestamp_writes: None,
        });
        for Dispatch { kernel, group, groups } in &self.dispatches {
            kernel.record(&mut pass, group, &[*groups]);
        }
    }

    /// Dispatches of a frame.
    pub fn dispatches(&self) -> usize {
        self.dispatches.len()
    }

    /// Has the driver compile the kernels, and waits for them; else it may in the first frame.
    ///
    /// # Errors
    /// What the device says.
    pub fn warm_up(&self) -> Result<(), Error> {
        warm::warm(&self.engine, |encoder| self.encode(encoder))
    }

    /// The vertices of a level that is kept, three floats each: vertices, storage, and a source of copies.
    pub fn vertices(&self, level: u32) -> Option<&wgpu::Buffer> {
        self.levels.get(&level)
    }

    /// The vertices of a level that is kept, on the host. Waits for all that was submitted.
    ///
    /// # Errors
    /// [`Error::Lost`], or what the device says.
    pub fn read(&self, level: u32) -> Result<Vec<[f32; 3]>, Error> {
        let Some(buffer) = self.levels.get(&level) else { return Ok(Vec::new()) };
        let bytes = 12 * self.topology.counts(level).vertices;
        buffers::read(&self.engine, "reading a level", buffer, bytes)
    }

    /// The faces of a level without those of holes, made on the device, once a topology: an index buffer.
    ///
    /// # Errors
    /// More than the device holds in one buffer; what the device says.
    pub fn faces(&self, level: u32, faces: Faces) -> Result<wgpu::Buffer, Error> {
        let engine = &self.engine;
        engine.checked("numbering faces", || {
            let topology = &self.topology;
            let count = topology.counts(level).faces;
            let depth = level.saturating_sub(topology.first_level());
            let corners: u64 = if faces == Faces::Quads { 4 } else { 6 };
            let usage = BufferUsages::STORAGE | BufferUsages::INDEX;
            let out = large(engine, "burgeon faces", 4 * corners * count, usage)?;
            let kernels = codegen::refinement(topology.options.scheme, &engine.tuning, engine.edit.as_ref())?;
            let shader = if faces == Faces::Quads { &kernels.quads } else { &kernels.triangles };
            let bound = [Bound::Slot, Bound::Read, Bound::Read, Bound::Written];
            let kernel = Kernel::with_bindings(engine, shader, &bound, &["number_faces"]);
            let (sides, owned) = tables::sides(&topology.roots);
            let sides = uploaded(engine, "burgeon sides of roots", bytemuck::cast_slice(&sides))?;
            let owned = uploaded(engine, "burgeon corners of roots", bytemuck::cast_slice(&owned))?;
            // As many roots at once as one binding holds faces of.
            let a_root = (4 * corners) << (2 * depth);
            let most = engine.device.limits().max_storage_buffer_binding_size / a_root;
            let chunk = (most.max(1) as usize).next_power_of_two().min(1 << 24) / 2;
            let solid = topology.roots.solid;
            let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon faces") };
            let mut encoder = engine.device.create_command_encoder(&label);
            for first in (0..solid).step_by(chunk.max(1)) {
                let roots = chunk.max(1).min(solid - first);
                let count = (roots as u64) << (2 * depth);
                let params = [count as u32, 1 << depth, first as u32, 0];
                let params = buffers::uniform(engine, "burgeon parameters", &params)?;
                let part = Part::of(a_root * first as u64..a_root * (first + roots) as u64, engine);
                let bindings = [
                    Binding::whole(&params),
                    Binding::whole(&sides),
                    Binding::whole(&owned),
                    part.bind(&out),
                ];
                let group = kernel.bind(engine, &bindings);
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                kernel.record(&mut pass, &group, &[groups(count, engine.tuning.workgroup)]);
            }
            engine.queue.submit([encoder.finish()]);
            Ok(out)
        })
    }
}

/// A buffer that may be larger than what is bound of it at once.
fn large(
    engine: &Engine,
    label: &'static str,
    bytes: u64,
    usage: BufferUsages,
) -> Result<wgpu::Buffer, Error> {
    let size = bytes.max(16).next_multiple_of(256);
    let most = engine.device.limits().max_buffer_size;
    if size > most {
        return Err(Error::Binding { buffer: label, needed: size, most });
    }
    Ok(engine.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

fn uploaded(engine: &Engine, label: &'static str, bytes: &[u8]) -> Result<wgpu::Buffer, Error> {
    let buffer = buffers::storage(engine, label, bytes.len() as u64)?;
    engine.queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// A range of a large buffer, which is bound from a multiple of what the device asks for on.
struct Part {
    offset: u64,
    bytes: u64,
}

impl Part {
    fn of(range: Range<u64>, engine: &Engine) -> Part {
        let step = u64::from(engine.device.limits().min_storage_buffer_offset_alignment).max(4);
        let offset = range.start / step * step;
        Part { offset, bytes: (range.end - offset).max(16).next_multiple_of(4) }
    }

    fn bind<'a>(&self, buffer: &'a wgpu::Buffer) -> Binding<'a> {
        Binding { buffer, offset: self.offset, bytes: self.bytes.min(buffer.size() - self.offset) }
    }
}

/// What a refiner is made with.
struct Builder<'a> {
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
    fn new(engine: &'a Engine, topology: &'a Arc<Topology>, levels: &[u32]) -> Result<Builder<'a>, Error> {
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

    fn build(mut self, most_roots: usize) -> Result<Refiner, Error> {
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
