//! Watertight tessellation on the device: [`Tessellator::encode`] records a frame and does nothing else.
//!
//! Nothing is read back, waited for or allocated between frames: every count stays on the device, and the
//! number of triangles is in the arguments of an indirect draw. Where the room runs out nothing is written
//! past its end; how much it would have taken is told a frame or so later ([`Tessellator::status`]).
//!
//! Who wants a mesh on the host and no frames takes [`Tessellator::complete`], which waits, and makes room
//! until all fits.
//!
//! # Embedding
//!
//! Once, the patches go to a device that the engine borrows (default limits, no features):
//!
//! ```no_run
//! use burgeon::gpu::{Engine, tessellate::{Capacity, Tessellator}};
//! use burgeon::tessellate::{Camera, Level, Options};
//! # fn prepare(device: &wgpu::Device, queue: &wgpu::Queue, nets: &[burgeon::patch::Net], camera: Camera)
//! #     -> Result<Tessellator, burgeon::gpu::Error> {
//!
//! let engine = Engine::new(device, queue);
//! let level = Level { hysteresis: 0.25, ..Level::pixels(0.5, camera) };
//! let room = Capacity::for_vertices(50_000);
//! let mut tessellator = Tessellator::new(&engine, nets, &level, &Options::default(), &room)?;
//! tessellator.warm_up()?; // else the driver may compile in the first frames
//! # Ok(tessellator)
//! # }
//! ```
//!
//! Each frame it is recorded before the pass that draws it, in the same encoder or in one that is submitted
//! earlier:
//!
//! ```no_run
//! # use burgeon::gpu::tessellate::Tessellator;
//! # use burgeon::tessellate::Level;
//! # fn frame(tessellator: &mut Tessellator, encoder: &mut wgpu::CommandEncoder, level: &Level,
//! #     begin: impl Fn(&mut wgpu::CommandEncoder) -> wgpu::RenderPass<'_>) -> Result<(), burgeon::gpu::Error> {
//! tessellator.set_level(level)?; // where the camera moved
//! tessellator.encode(encoder);
//!
//! let mut pass = begin(encoder); // with the host's own pipeline
//! pass.set_vertex_buffer(0, tessellator.vertices().slice(..));
//! pass.set_index_buffer(tessellator.indices().slice(..), wgpu::IndexFormat::Uint32);
//! pass.draw_indexed_indirect(tessellator.draw_args(), 0);
//! # Ok(())
//! # }
//! ```
//!
//! The pipeline reads vertices as [`Tessellator::vertex_layout`] says: by default position, normal and uv in floats,
//! 32 bytes ([`Format`]). Triangles run counter-clockwise seen from the side that the normals point to. Complete programs are in
//! the folder `examples/`: `own_device.rs`, `animated.rs`, `growing.rs` and, with another library on the same
//! device, `beside_egui/`.
//!
//! - **A frame** allocates no buffer, bind group or pipeline, waits for nothing, and reads nothing but
//!   its status, when that comes. [`Tessellator::set_level`] and [`Tessellator::set_points`] write through
//!   the queue, so they hold for the next submission and all after it: with several frames in one
//!   submission the last word holds for all.
//! - **Points that move** are written to [`Tessellator::points`] by a pass of the host's, or by
//!   [`Tessellator::set_points`]. Where nets met with equal control points, these must stay equal, to the
//!   bit.
//! - **Rules** that are derived with the frame: [`Tessellator::of_rules`]. Params, bound values, the view and the
//!   control points may be others each frame; nothing is compiled or allocated for it, and the surface's cells
//!   and holes follow. [`Tessellator::reload`] takes other rules, or says what is wrong with them and goes on with
//!   those that are there.
//! - **Slabs**: a renderer that keeps many meshes in one buffer gives ranges of it to [`Tessellator::set_slab`].
//! - **Overflow**: without room for nodes some cells stay coarser, and the mesh is still closed. Without
//!   room for vertices or indices the frame before is drawn again. Either is in [`Tessellator::status`],
//!   some frames late, as [`Status::complete`]; then [`Tessellator::set_capacity`] makes new buffers, of
//!   [`Capacity::grown`]: below cells without room nothing was counted. What binds the old ones must be bound
//!   anew, but for the control points; what was drawn is drawn until a frame has run.
//! - **A budget** of triangles, [`Level::budget`], is kept on the device by a higher tolerance.
//! - **Hysteresis** keeps cells split until their error is clearly below the tolerance, so that none
//!   flickers at the limit.
//! - **[Freezing](Tessellator::freeze)** keeps the triangles as they are while the camera goes on, to look
//!   at them from the side; points may still move.
//! - **Displacement**: [`Tessellator::displace`] moves the vertices by the `place` that ends the run of a system
//!   ([reference](crate::language#displacement)), and [`Tessellator::set_params`] gives its params other values from
//!   frame to frame. Tolerances bound the smooth surface: where the displacement is finer, raise the least
//!   [`Level::depth`]. Packed positions are shares of a box that must hold the displaced surface.
//! - **Seams**: patches share the vertices of their common curves, with the normal and uv of one of them.
//!   Where each is to have its own, as a texture or a crease wants, take [`Options::seams`]; positions are
//!   then equal to the bit, and there is still no crack.

mod buffers;
mod capacity;
mod kernels;
mod layout;
mod placement;
mod read;
mod rules;
mod slab;

use super::report::Report;
use super::run::Run;
use super::{Engine, Error, warm};
use crate::codegen::Tessellation;
use crate::patch::{Net, Word};
use crate::plan::{Displacement, Stored};
use crate::tessellate::budget::ROUNDS;
use crate::tessellate::lattice::Node;
use crate::tessellate::level::Target;
use crate::tessellate::passes::{DrawArgs, Status};
use crate::tessellate::vertex::Format;
use crate::tessellate::word::{self, Table};
use crate::tessellate::{Camera, Level, Measure, Options, Topology};
use buffers::{ALL, Buffers, DISPATCH_BYTES, Input, LEVELS, SLOT};
pub use capacity::Capacity;
use kernels::{Groups, Kernels, Pass};
pub use layout::VertexLayout;
pub use read::Frame;
use rules::{Rewriting, Rules};
pub use slab::Slab;

/// A set of patches, and the buffers of its tessellation.
///
/// The vertex buffer lies as its [`Format`] says; it, the indices (`u32`) and the draw's arguments are ready
/// for `set_vertex_buffer`, `set_index_buffer` and `draw_indexed_indirect`.
pub struct Tessellator {
    engine: Engine,
    kernels: Kernels,
    buffers: Buffers,
    groups: [Groups; 2],
    /// Which of the two groups the next frame takes.
    turn: usize,
    what: Tessellation,
    topology: Topology,
    points: usize,
    start: Vec<Node>,
    level: Level,
    target: Target,
    /// Levels that a frame may split.
    levels: u32,
    /// Halvings that some root needs.
    least: u32,
    frozen: bool,
    report: Report<Status>,
    /// Where the word is derived with the frame.
    rules: Option<Rules>,
    displacement: Option<Displacement>,
}

impl Tessellator {
    /// For these nets; each begins as one cell. Waits for nothing.
    ///
    /// # Errors
    /// [`Error::Patches`] where the nets are no set, [`Error::Binding`] for room that the device cannot bind, and what the
    /// device says.
    pub fn new(
        engine: &Engine,
        nets: &[Net],
        level: &Level,
        options: &Options,
        capacity: &Capacity,
    ) -> Result<Tessellator, Error> {
        let topology = Topology::new(nets)?;
        let start = topology.start();
        Tessellator::with_start(engine, nets, topology, start, None, level, options, capacity)
    }

    /// For the leaves of a word, whose roots are these nets; `hole` is the symbol of erased cells, as
    /// [`Plan::keeping_holes`](crate::plan::Plan::keeping_holes) gives it.
    ///
    /// # Errors
    /// The same, and [`Error::Word`] where the leaves are no partition of the roots.
    pub fn of_word(
        engine: &Engine,
        nets: &[Net],
        word: &Word,
        hole: Option<usize>,
        level: &Level,
        options: &Options,
        capacity: &Capacity,
    ) -> Result<Tessellator, Error> {
        let topology = Topology::new(nets)?;
        let start = word::nodes(word, &topology, hole)?;
        Tessellator::with_start(engine, nets, topology, start, None, level, options, capacity)
    }

    #[allow(clippy::too_many_arguments)]
    fn with_start(
        engine: &Engine,
        nets: &[Net],
        topology: Topology,
        start: Vec<Node>,
        rewriting: Option<Rewriting>,
        level: &Level,
        options: &Options,
        capacity: &Capacity,
    ) -> Result<Tessellator, Error> {
        let points: Vec<[f32; 4]> = nets.iter().flat_map(|net| net.points.iter().copied()).collect();
        let table = (!word::are_roots(&start)).then(|| Table::new(&start));
        let derived = rewriting.map(|rewriting| rewriting.derived(capacity.modules));
        let what = Tessellation {
            degree: nets.first().map_or([3, 3], |net| net.degree),
            rational: points.iter().any(|p| p[3] != 1.0),
            word: table.is_some() || rewriting.is_some(),
            derived: rewriting.is_some(),
            options: *options,
        };
        let mut tessellator = engine.checked("preparing a tessellation", || {
            let kernels = Kernels::new(engine, &what)?;
            let input = Input {
                nets: &points,
                topology: topology.words(),
                table: table.as_ref().map_or(&[0], |t| t.words()),
                start: &start,
                format: &options.format,
                derived,
                slab: None,
            };
            let buffers = Buffers::new(engine, &input, capacity, None)?;
            let run = |rewriting: Rewriting| {
                let Rewriting { plan, axiom, options } = rewriting;
                Run::with_column(
                    engine,
                    plan,
                    axiom,
                    options,
                    capacity.modules,
                    Some((Stored::Nets, &buffers.nets)),
                )
            };
            let run = rewriting.map(run).transpose()?;
            let rules = run.map(|run| Rules { groups: kernels.derived_groups(engine, &buffers, &run), run });
            let groups = [0, 1].map(|now| kernels.groups(engine, &buffers, now));
            let roots = 0..topology.roots() as u32;
            let least = roots.map(|r| crate::tessellate::topology::least_depth(topology.words(), r));
            Ok(Tessellator {
                engine: engine.clone(),
                kernels,
                buffers,
                groups,
                turn: 0,
                what,
                least: least.max().unwrap_or(0),
                topology,
                points: points.len(),
                start,
                level: level.clone(),
                target: level.target()?,
                levels: 0,
                frozen: false,
                report: Report::new(engine),
                rules,
                displacement: None,
            })
        })?;
        tessellator.set_level(level)?;
        Ok(tessellator)
    }

    /// Other room, in new buffers, but for [`Tessellator::points`]: what binds the others must be bound anew. What is
    /// drawn is copied where there is more room than before and attributes are interleaved, so that the last frame
    /// that fitted stays to be drawn; else nothing is drawn until a frame has run. What hysteresis remembers is
    /// forgotten, and [`Tessellator::status`] is none until a frame has run in the new room.
    ///
    /// # Errors
    /// As for [`Tessellator::new`]; then the old room is still there.
    pub fn set_capacity(&mut self, capacity: &Capacity) -> Result<(), Error> {
        self.make_room(capacity, self.buffers.slab.clone())
    }

    /// From now on vertices, indices and the draw's arguments go to a slab of the caller's, of which they take as much
    /// as `capacity` says; nothing is drawn of it until a frame has run.
    ///
    /// # Errors
    /// [`Error::Slab`] where the buffers do not hold it or lack a usage, [`Error::Binding`], and what the device says;
    /// then all is as before.
    pub fn set_slab(&mut self, slab: &Slab, capacity: &Capacity) -> Result<(), Error> {
        self.make_room(capacity, Some(slab.clone()))?;
        let zeros = [0u8; size_of::<DrawArgs>()];
        let (engine, draw) = (&self.engine, &self.buffers.draw);
        engine.checked("emptying a draw", || {
            engine.queue.write_buffer(&draw.buffer, draw.at, &zeros);
            Ok(())
        })
    }

    fn make_room(&mut self, capacity: &Capacity, slab: Option<Slab>) -> Result<(), Error> {
        let engine = self.engine.clone();
        engine.checked("making room for a tessellation", || {
            let input = Input {
                nets: &[],
                topology: self.topology.words(),
                table: &[],
                start: &self.start,
                format: &self.what.options.format,
                derived: self.rules.as_ref().map(|rules| Rewriting::of(&rules.run).derived(capacity.modules)),
                slab: slab.as_ref(),
            };
            let buffers = Buffers::new(&engine, &input, capacity, Some(&self.buffers))?;
            if let Some(rules) = &mut self.rules {
                rules.run.set_capacity(capacity.modules)?;
            }
            let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon new room") };
            let mut encoder = engine.device.create_command_encoder(&label);
            buffers.copy_drawn(&mut encoder, &self.buffers, self.format());
            engine.queue.submit([encoder.finish()]);
            self.groups = [0, 1].map(|now| self.kernels.groups(&engine, &buffers, now));
            self.buffers = buffers;
            self.report = Report::new(&engine);
            self.bind_rules();
            Ok(())
        })
    }

    /// The room that there is.
    pub fn capacity(&self) -> Capacity {
        Capacity {
            modules: self.rules.as_ref().map_or(0, |rules| rules.run.capacity()),
            ..self.buffers.capacity
        }
    }

    /// How fine the next frames are to be. Nothing is compiled or allocated.
    ///
    /// # Errors
    /// [`Error::Level`] for numbers out of range.
    pub fn set_level(&mut self, level: &Level) -> Result<(), Error> {
        self.target = level.target()?;
        self.level = level.clone();
        self.engine.queue.write_buffer(&self.buffers.target, 0, bytemuck::bytes_of(&self.target));
        // Leaves of a word that are short along one direction may be split beyond the most.
        self.levels = (self.target.most + self.least + 1).min(LEVELS);
        Ok(())
    }

    /// What the next frames are seen with, where the tolerance is in pixels; else it is from now on.
    ///
    /// # Errors
    /// As for [`Tessellator::set_level`].
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), Error> {
        self.set_level(&Level { measure: Measure::Pixels(camera), ..self.level.clone() })
    }

    /// Other control points, those of one root after the other as the nets had them, of patches that meet
    /// as before. They may as well be written on the device, to [`Tessellator::points`].
    ///
    /// # Errors
    /// [`Error::Points`] when they are not as many as before.
    pub fn set_points(&self, points: &[[f32; 4]]) -> Result<(), Error> {
        if points.len() != self.points {
            return Err(Error::Points { found: points.len(), expected: self.points });
        }
        self.engine.queue.write_buffer(&self.buffers.nets, 0, bytemuck::cast_slice(points));
        Ok(())
    }

    /// While frozen the triangles stay what they are, wherever the camera goes; only their vertices are
    /// computed anew.
    pub fn freeze(&mut self, frozen: bool) {
        self.frozen = frozen;
    }

    /// Records a frame: no submission, no wait, no buffer made.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) {
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("burgeon tessellation"),
                timestamp_writes: None,
            });
            self.record(&mut pass);
        }
        self.report.encode(encoder, &self.buffers.status);
    }

    fn record(&mut self, pass: &mut wgpu::ComputePass) {
        if self.frozen {
            // The children that stand are those of the frame before.
            return self.part(pass, Part::Vertices, 1 - self.turn);
        }
        self.part(pass, Part::Derive, self.turn);
        let g = &self.groups[self.turn];
        pass.set_pipeline(self.kernels.of(Pass::Begin));
        pass.set_bind_group(0, &g.begin, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        let rounds = if self.target.budget == 0 { 1 } else { ROUNDS };
        for _ in 0..rounds {
            self.part(pass, Part::Refine, self.turn);
            self.part(pass, Part::Stitch, self.turn);
            if rounds > 1 {
                self.one(pass, Pass::Afford, &g.afford, ALL, Workgroups::One);
            }
        }
        self.one(pass, Pass::Finish, &g.finish, ALL, Workgroups::One);
        self.part(pass, Part::Vertices, self.turn);
        self.part(pass, Part::Triangles, self.turn);
        self.turn = 1 - self.turn;
    }

    /// Records a part of a frame by itself, over what the parts before it left: to measure it.
    pub fn encode_part(&self, encoder: &mut wgpu::CommandEncoder, part: Part) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("burgeon part of a tessellation"),
            timestamp_writes: None,
        });
        self.part(&mut pass, part, 1 - self.turn);
    }

    fn part(&self, pass: &mut wgpu::ComputePass, part: Part, turn: usize) {
        let g = &self.groups[turn];
        match part {
            Part::Derive => self.derive(pass),
            Part::Refine => {
                for level in 0..self.levels {
                    self.one(pass, Pass::Decide, &g.decide, level, Workgroups::Nodes);
                    self.scan(pass, &g.scan[0], level);
                    self.one(pass, Pass::Split, &g.split, level, Workgroups::Nodes);
                    self.one(pass, Pass::Advance, &g.advance, level, Workgroups::One);
                }
            }
            Part::Stitch => {
                self.one(pass, Pass::Mark, &g.mark, ALL, Workgroups::Nodes);
                self.one(pass, Pass::Tally, &g.tally, ALL, Workgroups::Nodes);
                self.scan(pass, &g.scan[0], ALL);
                self.scan(pass, &g.scan[1], ALL);
            }
            Part::Vertices => self.one(pass, Pass::Vertices, &g.vertices, ALL, Workgroups::Last),
            Part::Triangles => self.one(pass, Pass::Triangles, &g.triangles, ALL, Workgroups::Last),
        }
    }

    fn one(
        &self,
        pass: &mut wgpu::ComputePass,
        which: Pass,
        group: &wgpu::BindGroup,
        range: u32,
        groups: Workgroups,
    ) {
        pass.set_pipeline(self.kernels.of(which));
        pass.set_bind_group(0, group, &[range * SLOT as u32]);
        match groups {
            Workgroups::One => pass.dispatch_workgroups(1, 1, 1),
            Workgroups::Nodes => {
                pass.dispatch_workgroups_indirect(&self.buffers.dispatches, u64::from(range) * DISPATCH_BYTES)
            }
            Workgroups::Last => pass.dispatch_workgroups_indirect(&self.buffers.last, 0),
        }
    }

    fn scan(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, range: u32) {
        let at = u64::from(range) * DISPATCH_BYTES + 16;
        pass.set_bind_group(0, group, &[range * SLOT as u32]);
        for (n, pipeline) in self.kernels.scan.pipelines.iter().enumerate() {
            pass.set_pipeline(pipeline);
            match n {
                1 => pass.dispatch_workgroups(1, 1, 1),
                _ => pass.dispatch_workgroups_indirect(&self.buffers.dispatches, at),
            }
        }
    }

    /// Has the driver compile every kernel that a frame may dispatch, those of rules and of a placement among them, and
    /// waits for it: with a frame that is thrown away, and dispatches of no workgroups for what it did not need. Without
    /// it drivers that compile a kernel when it is first dispatched do so in the first frames: lavapipe takes seconds,
    /// unless its cache on the disk has them.
    ///
    /// It is for the beginning, and for another thread where the host's own must go on. [`Tessellator::displace`] and
    /// [`Tessellator::reload`] make kernels, so it may be called again after them; what is compiled already takes no
    /// time. The pipelines that draw the frame are the host's to warm.
    ///
    /// # Errors
    /// What the device says.
    pub fn warm_up(&mut self) -> Result<(), Error> {
        let engine = self.engine.clone();
        warm::warm(&engine, |encoder| {
            self.encode(encoder);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            self.kernels.idle(&mut pass, &self.groups[self.turn]);
            if let Some(rules) = &self.rules {
                rules.run.idle(&mut pass);
            }
        })
    }

    /// Control points, one root after the other, four floats each: storage, to be copied to.
    pub fn points(&self) -> &wgpu::Buffer {
        &self.buffers.nets
    }
    /// As [`Tessellator::format`] says, from the first vertex of the [`Slab`] on, if there is one.
    pub fn vertices(&self) -> &wgpu::Buffer {
        &self.buffers.vertices.buffer
    }
    /// `u32`, three a triangle.
    pub fn indices(&self) -> &wgpu::Buffer {
        &self.buffers.indices.buffer
    }
    /// [`DrawArgs`].
    pub fn draw_args(&self) -> &wgpu::Buffer {
        &self.buffers.draw.buffer
    }
    /// For each triangle the node whose surface it is, `u32`.
    pub fn cells(&self) -> &wgpu::Buffer {
        &self.buffers.cells
    }
    /// The cells of all levels, [`Node`]s.
    pub fn nodes(&self) -> &wgpu::Buffer {
        &self.buffers.nodes
    }
    /// [`Status`], as the last frame that has run left it.
    pub fn status_buffer(&self) -> &wgpu::Buffer {
        &self.buffers.status
    }
    /// The vertices, as a render pipeline reads them.
    pub fn vertex_layout(&self) -> VertexLayout {
        VertexLayout::new(self.format())
    }
    pub fn format(&self) -> &Format {
        &self.what.options.format
    }
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// What the last frame said of which the host knows, some frames late; none before the first. It comes
    /// when the device is polled, as a submission and a presented picture do.
    pub fn status(&self) -> Option<Status> {
        self.report.last()
    }
}

/// A part of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The word, where rules are derived with the frame, and its leaves.
    Derive,
    /// The trees: decide, scan, split and advance, level by level.
    Refine,
    /// Who owns which vertex and makes which triangle: mark, tally, scan.
    Stitch,
    Vertices,
    Triangles,
}

/// Workgroups of a dispatch.
#[derive(Clone, Copy)]
enum Workgroups {
    One,
    Nodes,
    Last,
}
