//! A derivation that is recorded: the whole schedule in one encoder, again and again, without a wait.
//!
//! [`super::derive`] waits after each step to know how much room the next one takes. Where rules are to run each
//! frame, with other params, another view or control points that moved, [`Run::encode`] records all sweeps
//! into room that was made once; the device itself says from sweep to sweep how many modules there are
//! ([`crate::plan::turns`]).
//!
//! ```no_run
//! use burgeon::gpu::{Engine, run::{Options, Run}};
//! use burgeon::language::expr::Value;
//! # fn frames(device: &wgpu::Device, queue: &wgpu::Queue, plan: &burgeon::plan::Plan,
//! #     axiom: &burgeon::patch::Axiom) -> Result<(), burgeon::gpu::Error> {
//!
//! let engine = Engine::new(device, queue);
//! let mut run = Run::new(&engine, plan, axiom, &Options::default(), 100_000)?; // room for so many modules
//! run.warm_up()?; // else the driver may compile in the first frames
//!
//! // Each frame:
//! run.set(&[("bend".to_string(), Value::Float(0.3))])?;
//! let mut encoder = device.create_command_encoder(&Default::default());
//! run.encode(&mut encoder);
//! // … passes of the host's that read run.column(…) and the number of modules in run.progress() …
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```
//!
//! It begins with whatever [`derive`](crate::plan::derive::derive()) begins with: the axiom of a patch system or of a
//! curve, or several words at once. Modules stand in the order of the word. None is retired: a module on which no rule
//! can fire is copied at each step, so that the word is one piece in one buffer, in order.
//!
//! Where the word outgrows its room, or a net is halved more often than an address holds, there is no word: its
//! length is 0, nothing was written past the end, and [`Run::status`] says some frames later what was needed.
//! A [`Tessellator`](super::tessellate::Tessellator) of the run then goes on with the word before.

mod buffers;
mod starts;

use super::buffers as reading;
use super::kernels::{self, Bound, Kernel, Kernels};
use super::report::Report;
use super::{Engine, Error, warm};
use crate::codegen;
use crate::language::expr::Value;
use crate::patch::{self, Values};
use crate::plan::collect::Collected;
use crate::plan::columns::{Content, Stored};
use crate::plan::derive::{Asked, StageId, Start};
use crate::plan::program::Over;
use crate::plan::step::{Clock, Column, Extent};
use crate::plan::tables::rule_word;
use crate::plan::turns::{self, Progress, Turn, TurnWords};
use crate::plan::{self, Given, Plan, Settings, View};
use buffers::{Buffers, DISPATCH_BYTES, Groups, Room, SLOT, Stand, next};
use starts::Starts;

/// With what a run begins. All but a seed of its own may change from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Params by name.
    pub set: Vec<(String, Value)>,
    /// The values of queries without `=`, by name.
    pub bind: Vec<(String, Values)>,
    /// What `bbox_px` and `area_px` are seen through.
    pub view: Option<View>,
    /// What random numbers begin with; none: the param `seed` of the system, if it has one of type int, else 0.
    pub seed: Option<u32>,
}

impl Options {
    fn of_plan(&self) -> plan::Options<'static> {
        let Options { set, bind, view, seed } = self.clone();
        plan::Options { set, bind, view, seed, ..plan::Options::default() }
    }
}

/// A plan and what it starts from on a device, to be derived again and again.
pub struct Run<S = patch::Axiom> {
    engine: Engine,
    plan: Plan,
    start: S,
    /// Modules that it starts with.
    first: u32,
    options: Options,
    settings: Settings,
    /// Words derived at once; 0 where it is one alone.
    words: usize,
    given: Given,
    turns: Vec<Turn>,
    room: Room,
    rooms: u32,
    kernels: Kernels,
    proceed: Kernel,
    starts: Starts,
    buffers: Buffers,
    groups: Groups,
    report: Report<Progress>,
}

impl<S: Start + Clone> Run<S> {
    /// Compiles the kernels and makes room for words of so many modules, of the axiom's at least. Waits for nothing.
    ///
    /// # Errors
    /// What [`derive`](plan::derive::derive()) says of the start and the options; [`Error::Binding`] for room that the
    /// device cannot bind; a schedule of more than [`MOST_TURNS`](turns::MOST_TURNS) sweeps; several words at once that
    /// are traced, where nothing may be left of one; what the device says.
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        start: &S,
        options: &Options,
        modules: u32,
    ) -> Result<Run<S>, Error> {
        Run::with_column(engine, plan, start, options, modules, None)
    }

    /// The same from a column of the axiom that lies on the device already, if one is given.
    pub(super) fn with_column(
        engine: &Engine,
        plan: &Plan,
        start: &S,
        options: &Options,
        modules: u32,
        there: Option<(Stored, &wgpu::Buffer)>,
    ) -> Result<Run<S>, Error> {
        let asked = Asked::of(plan, start, &options.of_plan())?;
        let content = start.content(plan, &asked.settings, &asked.each)?;
        let turns = turns::turns(plan, &asked.schedule)?;
        kernels::fits(engine, plan)?;
        engine.checked("preparing a derivation", || {
            let layout = plan.tables.layout;
            let mut kernels = Kernels::new(engine);
            for id in plan.stages() {
                let words = environment(plan, id, &asked.settings.uniforms, &asked.given);
                kernels.compile(plan, id, &words, id.of(plan).program.recorded())?;
            }
            let shader = codegen::proceed_edited(engine.tuning(), engine.edit.as_ref())?;
            use Bound::{Read, Slot, Written};
            let bound = [Slot, Read, Written, Written, Written, Written];
            let proceed = Kernel::with_bindings(engine, &shader, &bound, &["start", "proceed"]);
            let first = layout.modules(&content) as u32;
            let mut axiom: Stand = [const { None }; Stored::COUNT];
            for column in layout.columns() {
                axiom[column as usize] = Some(match there {
                    Some((known, buffer)) if known == column => buffer.clone(),
                    _ => {
                        let bytes = layout.shape(column).chunk_bytes(first.into());
                        let buffer = reading::storage(engine, of_axiom(column), bytes)?;
                        write(engine, plan, &buffer, &content, column);
                        buffer
                    }
                });
            }
            let room =
                Room { modules: modules.max(first), given: asked.given.words.len(), turns: turns.len() };
            let starts = Starts::new(engine, plan)?;
            let buffers = Buffers::new(engine, plan, &room, axiom, None)?;
            let groups = Groups::new(engine, plan, &kernels, &proceed, &starts, &buffers);
            let run = Run {
                engine: engine.clone(),
                plan: plan.clone(),
                start: start.clone(),
                first,
                options: options.clone(),
                settings: asked.settings,
                words: asked.each.len(),
                given: asked.given,
                turns,
                room,
                rooms: 0,
                kernels,
                proceed,
                starts,
                buffers,
                groups,
                report: Report::new(engine),
            };
            run.write_given();
            run.write_turns();
            Ok(run)
        })
    }

    /// Other values of params: those named are replaced, all others stay. Holds from the next submission on.
    /// Nothing is compiled; buffers are made only where the schedule becomes longer than it ever was.
    ///
    /// # Errors
    /// As for [`Run::new`]; then nothing has changed.
    pub fn set(&mut self, params: &[(String, Value)]) -> Result<(), Error> {
        let mut options = self.options.clone();
        for (name, value) in params {
            options.set.retain(|(known, _)| known != name);
            options.set.push((name.clone(), value.clone()));
        }
        self.take(options)
    }

    /// Other values of a query without `=`. Buffers are made only where they are more than there ever were.
    ///
    /// # Errors
    /// As for [`Run::new`]; then nothing has changed.
    pub fn bind(&mut self, query: &str, values: Values) -> Result<(), Error> {
        let mut options = self.options.clone();
        options.bind.retain(|(name, _)| name != query);
        options.bind.push((query.to_string(), values));
        self.take(options)
    }

    /// What `bbox_px` and `area_px` are seen through from now on.
    ///
    /// # Errors
    /// What the device says.
    pub fn set_view(&mut self, view: View) -> Result<(), Error> {
        self.take(Options { view: Some(view), ..self.options.clone() })
    }

    fn take(&mut self, options: Options) -> Result<(), Error> {
        let asked = Asked::of(&self.plan, &self.start, &options.of_plan())?;
        let turns = turns::turns(&self.plan, &asked.schedule)?;
        let engine = self.engine.clone();
        let changed = self.settings.uniforms != asked.settings.uniforms;
        let content = match changed && self.start.reads_params() {
            true => Some(self.start.content(&self.plan, &asked.settings, &asked.each)?),
            false => None,
        };
        let wanted = Room { given: asked.given.words.len(), turns: turns.len(), modules: self.room.modules };
        if !self.room.holds(&wanted) {
            self.make_room(Room {
                given: wanted.given.max(self.room.given),
                turns: wanted.turns.max(self.room.turns),
                ..wanted
            })?;
        }
        // What else the axiom has the host may have written.
        if let (Some(content), Some(records)) = (content, self.axiom_column(Stored::Records)) {
            write(&engine, &self.plan, records, &content, Stored::Records);
        }
        self.kernels
            .set_environments(|id| environment(&self.plan, id, &asked.settings.uniforms, &asked.given));
        let others = self.given.words != asked.given.words;
        let reseeded = self.settings.seed != asked.settings.seed;
        (self.options, self.settings, self.given) = (options, asked.settings, asked.given);
        if others {
            self.write_given();
        }
        if others || reseeded || self.turns != turns {
            self.turns = turns;
            self.write_turns();
        }
        Ok(())
    }

    /// Room for other words, in new buffers but for the axiom's; what binds the others must be bound anew.
    ///
    /// # Errors
    /// [`Error::Binding`], and what the device says; then the old room is still there.
    pub fn set_capacity(&mut self, modules: u32) -> Result<(), Error> {
        self.make_room(Room { modules: modules.max(self.first), ..self.room })
    }

    fn make_room(&mut self, room: Room) -> Result<(), Error> {
        let engine = self.engine.clone();
        engine.checked("making room for a derivation", || {
            let axiom = self.buffers.places[0].clone();
            let buffers = Buffers::new(&engine, &self.plan, &room, axiom, Some(&self.buffers))?;
            let Run { plan, kernels, proceed, starts, .. } = &*self;
            self.groups = Groups::new(&engine, plan, kernels, proceed, starts, &buffers);
            (self.buffers, self.room) = (buffers, room);
            self.rooms += 1;
            self.report = Report::new(&engine);
            self.write_given();
            self.write_turns();
            Ok(())
        })
    }

    /// Has the driver compile every kernel of the rules, those of steps that only other params ask for among them, and
    /// waits for it, with a derivation that is thrown away; else it may in the first frames that need one
    /// ([how long](super::tessellate::Tessellator::warm_up)).
    ///
    /// # Errors
    /// What the device says.
    pub fn warm_up(&mut self) -> Result<(), Error> {
        let engine = self.engine.clone();
        warm::warm(&engine, |encoder| {
            self.encode(encoder);
            self.idle(&mut encoder.begin_compute_pass(&Default::default()));
        })
    }

    /// Dispatches all kernels over no workgroups.
    pub(super) fn idle(&self, pass: &mut wgpu::ComputePass) {
        for (id, [groups, ..]) in &self.groups.stages {
            for (work, group) in id.of(&self.plan).program.recorded().zip(groups) {
                warm::idle(pass, self.kernels.of(*id, work.pass), group);
            }
        }
        warm::idle(pass, &self.proceed, &self.groups.proceed);
        self.starts.idle(pass, &self.groups.starts);
    }

    /// Records the whole schedule: no submission, no wait, no buffer made.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder) {
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("burgeon derivation"),
                timestamp_writes: None,
            });
            self.record(&mut pass);
        }
        self.report.encode(encoder, &self.buffers.progress);
    }

    /// The same within a pass, and without word of it to the host.
    pub(super) fn record(&self, pass: &mut wgpu::ComputePass) {
        let b = &self.buffers;
        pass.set_bind_group(0, &self.groups.proceed, &[0]);
        pass.set_pipeline(&self.proceed.pipelines[0]);
        pass.dispatch_workgroups(1, 1, 1);
        let mut place = 0;
        for (index, turn) in self.turns.iter().enumerate() {
            let slot = index as u32 * SLOT as u32;
            let workgroups = index as u64 * DISPATCH_BYTES;
            self.starts.record(pass, &self.groups.starts, turn.stage.rule_set, next(place));
            let works = turn.stage.of(&self.plan).program.recorded();
            for (work, group) in works.zip(&self.groups.stages[&turn.stage][place]) {
                let kernel = self.kernels.of(turn.stage, work.pass);
                // How long the word is only the device knows: rounds are as many as the longest takes.
                kernel.run(pass, (group, slot), work, self.room.modules.into(), |pass, over| {
                    let at = match over {
                        Over::Each(_) => 0,
                        Over::Tiles(_) => 16,
                        Over::Children => 32,
                        Over::Group => return pass.dispatch_workgroups(1, 1, 1),
                    };
                    pass.dispatch_workgroups_indirect(&b.dispatches, workgroups + at);
                });
            }
            pass.set_bind_group(0, &self.groups.proceed, &[slot]);
            pass.set_pipeline(&self.proceed.pipelines[1]);
            pass.dispatch_workgroups(1, 1, 1);
            place = next(place);
        }
    }

    /// Where the word stands when all has run.
    fn place(&self) -> usize {
        match self.turns.len() {
            0 => 0,
            n => 2 - n % 2,
        }
    }

    /// A column of the word, in its order, after what stands beside it
    /// ([`Layout::shape`](crate::plan::layout::Layout::shape)); none of those that the word has not. Another buffer when
    /// the schedule has another number of sweeps.
    pub fn column(&self, column: Stored) -> Option<&wgpu::Buffer> {
        self.buffers.places[self.place()][column as usize].as_ref()
    }
    /// A column of the axiom, to be written by whoever moves it: of patches the control points of one root after the
    /// other in [`Stored::Nets`], four floats each; of curves the points in [`Stored::Records`], where their parameters
    /// stand.
    pub fn axiom_column(&self, column: Stored) -> Option<&wgpu::Buffer> {
        self.buffers.places[0][column as usize].as_ref()
    }
    /// [`Progress`], as the last derivation that has run left it: its first word is the number of modules.
    pub fn progress(&self) -> &wgpu::Buffer {
        &self.buffers.progress
    }
    /// The workgroups of the engine's size for an invocation a module, for an indirect dispatch, and where they
    /// stand in the buffer.
    pub(super) fn workgroups(&self) -> (&wgpu::Buffer, u64) {
        (&self.buffers.dispatches, self.turns.len() as u64 * DISPATCH_BYTES)
    }
    /// A column wherever a word may stand, and which of them it is now.
    pub(super) fn column_places(&self, column: Stored) -> (Vec<&wgpu::Buffer>, usize) {
        (
            self.buffers.places.iter().filter_map(|stand| stand[column as usize].as_ref()).collect(),
            self.place(),
        )
    }
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
    /// Params, values and view as they are now.
    pub fn options(&self) -> &Options {
        &self.options
    }
    /// What it starts from.
    pub fn start(&self) -> &S {
        &self.start
    }
    /// How often room was made: then what binds the buffers must be bound anew.
    pub(super) fn rooms(&self) -> u32 {
        self.rooms
    }
    /// Modules that there is room for.
    pub fn capacity(&self) -> u32 {
        self.room.modules
    }

    /// What the last derivation said of which the host knows, some frames late; none before the first. It comes
    /// when the device is polled.
    pub fn status(&self) -> Option<Progress> {
        self.report.last()
    }

    /// Reads the word of a derivation that was submitted, and waits for it: for tests, and whoever has time.
    ///
    /// # Errors
    /// What the device says.
    pub fn read(&self) -> Result<(Progress, S::Word), Error> {
        let (engine, layout) = (&self.engine, self.plan.tables.layout);
        let doing = "reading a derivation";
        let progress: Vec<Progress> =
            reading::read(engine, doing, self.progress(), size_of::<Progress>() as u64)?;
        let progress = progress.first().copied().unwrap_or_default();
        let n = u64::from(progress.modules.min(self.room.modules));
        let mut content = Content::default();
        for column in layout.columns() {
            let (shape, Some(buffer)) = (layout.shape(column), self.column(column)) else { continue };
            let (at, bytes) = (shape.halo_bytes(), n * shape.bytes());
            content[column] = reading::read_from(engine, doing, buffer, at, bytes)?;
        }
        Ok((progress, S::Word::of(&self.plan, progress.steps, self.words, vec![content])?))
    }

    fn write_given(&self) {
        let attributes = self.buffers.column(Column::Attributes);
        self.engine.queue.write_buffer(attributes, 0, bytemuck::cast_slice(&self.given.words));
    }

    /// The extents, as far as the host knows them, and the turns.
    fn write_turns(&self) {
        let (b, queue) = (&self.buffers, &self.engine.queue);
        let (tuning, layout) = (self.engine.tuning(), &self.plan.tables.layout);
        let slot_words = SLOT as usize / 4;
        let mut extents = vec![0u32; (self.turns.len() + 1) * slot_words];
        let mut turns = extents.clone();
        let writes = |turn: &Turn| {
            let stage = turn.stage.of(&self.plan);
            stage.program.writing.last().map(|work| (work.pass, stage))
        };
        for (index, turn) in self.turns.iter().enumerate() {
            let extent = Extent {
                count: self.first,
                capacity: self.room.modules,
                clock: Clock { step: turn.step, run_step: 0, seed: self.settings.seed },
                given: self.given.words.len() as u32,
                behind: self.first,
                ..Extent::default()
            };
            let next = self.turns.get(index + 1).and_then(writes);
            let children =
                next.map_or(1, |(pass, stage)| tuning.children_a_group(pass, stage, layout) as u32);
            let words = TurnWords { index: index as u32, growth: turn.growth, flags: turn.flags, children };
            let at = index * slot_words;
            let extent: [u32; size_of::<Extent>() / 4] = bytemuck::cast(extent);
            extents[at..at + extent.len()].copy_from_slice(&extent);
            turns[at..at + 4].copy_from_slice(bytemuck::cast_slice(&[words]));
        }
        // A schedule without sweeps has the axiom as its word.
        extents[0..2].copy_from_slice(&[self.first, self.room.modules]);
        queue.write_buffer(&b.extents, 0, bytemuck::cast_slice(&extents));
        queue.write_buffer(&b.turns, 0, bytemuck::cast_slice(&turns));
        let groups = |invocations: u64, workgroup: u32| {
            let [x, y] = super::kernels::groups(invocations, workgroup);
            [x, y, 1, 0]
        };
        let n = u64::from(self.first);
        let children = self.turns.first().and_then(writes);
        let children = children.map_or(n, |(pass, stage)| tuning.children(pass, n, stage, layout));
        let first =
            [groups(n, tuning.workgroup), groups(n, tuning.tile()), groups(children, tuning.workgroup)];
        queue.write_buffer(&b.dispatches, 0, bytemuck::cast_slice(&first));
    }
}

/// What a device calls a column of the axiom.
fn of_axiom(column: Stored) -> &'static str {
    match column {
        Stored::Records => "burgeon axiom",
        Stored::Nets => "burgeon control points",
    }
}

/// Writes a column of the axiom.
fn write(engine: &Engine, plan: &Plan, buffer: &wgpu::Buffer, content: &Content, column: Stored) {
    let at = plan.tables.layout.shape(column).halo_bytes();
    engine.queue.write_buffer(buffer, at, bytemuck::cast_slice(&content[column]));
}

/// The environment of a stage in which what could be retired is kept.
fn environment(plan: &Plan, id: StageId, uniforms: &[Value], given: &Given) -> Vec<u32> {
    let stage = id.of(plan);
    let mut words = plan.environment(stage, uniforms, given);
    if stage.may_retire() {
        words[stage.rule_table() + stage.retired() as usize] = rule_word(0, 1);
    }
    words
}
