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
//! // … passes of the host's that read run.records(), run.nets() and the number of modules in run.progress() …
//! queue.submit([encoder.finish()]);
//! # Ok(())
//! # }
//! ```
//!
//! Modules stand in the order of the derivation tree. None is retired: a module on which no rule can fire is
//! copied at each step, so that the word is one piece in one buffer, in order.
//!
//! Where the word outgrows its room, or a net is halved more often than an address holds, there is no word: its
//! length is 0, nothing was written past the end, and [`Run::status`] says some frames later what was needed.
//! A [`Tessellator`](super::tessellate::Tessellator) of the run then goes on with the word before.

mod buffers;

use super::buffers as reading;
use super::kernels::{self, Bound, Kernel, SharedKernels, StageKernels};
use super::report::Report;
use super::{Engine, Error, warm};
use crate::codegen;
use crate::language::expr::Value;
use crate::patch::{self, Values};
use crate::plan::collect;
use crate::plan::derive::StageId;
use crate::plan::given::Given;
use crate::plan::step::{Clock, Extent};
use crate::plan::tables::rule_word;
use crate::plan::turns::{self, Progress, Turn, TurnWords};
use crate::plan::{Plan, Settings, View, schedule};
use buffers::{Buffers, DISPATCH_BYTES, Groups, Room, SLOT, next};
use std::collections::HashMap;

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

/// A plan and an axiom on a device, to be derived again and again.
pub struct Run {
    engine: Engine,
    plan: Plan,
    axiom: patch::Axiom,
    options: Options,
    settings: Settings,
    given: Given,
    turns: Vec<Turn>,
    room: Room,
    rooms: u32,
    stages: HashMap<StageId, StageKernels>,
    shared: SharedKernels,
    proceed: Kernel,
    buffers: Buffers,
    groups: Groups,
    report: Report<Progress>,
}

impl Run {
    /// Compiles the kernels and makes room for words of so many modules, of the axiom's at least. Waits for nothing.
    ///
    /// # Errors
    /// What [`Plan::uniforms`], [`Given::new`], [`Plan::axiom`] and the schedule say of the options;
    /// [`Error::Binding`] for room that the device cannot bind; a schedule of more than
    /// [`MOST_TURNS`](turns::MOST_TURNS) sweeps; what the device says.
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        axiom: &patch::Axiom,
        options: &Options,
        modules: u32,
    ) -> Result<Run, Error> {
        Run::with_points(engine, plan, axiom, options, modules, None)
    }

    /// The same from control points that lie on the device.
    pub(super) fn with_points(
        engine: &Engine,
        plan: &Plan,
        axiom: &patch::Axiom,
        options: &Options,
        modules: u32,
        points: Option<&wgpu::Buffer>,
    ) -> Result<Run, Error> {
        let asked = Asked::of(plan, axiom, options)?;
        let (records, nets) = plan.axiom(axiom, &asked.settings.uniforms)?;
        kernels::fits(engine, plan)?;
        engine.checked("preparing a derivation", || {
            let layout = plan.tables.layout;
            let mut stages = HashMap::new();
            for (rule_set, set) in plan.tables.rule_sets.iter().enumerate() {
                for stage in 0..set.stages.len() {
                    let id = StageId { rule_set, stage };
                    let words = environment(plan, id, &asked.settings.uniforms, &asked.given);
                    stages.insert(id, StageKernels::new(engine, plan, id, &words)?);
                }
            }
            let shared = SharedKernels::new(engine, &layout)?;
            let shader = codegen::proceed_edited(&layout, engine.tuning(), engine.edit.as_ref())?;
            use Bound::{Read, Slot, Written};
            let bound = [Slot, Read, Written, Written, Written, Written];
            let proceed = Kernel::with_bindings(engine, &shader, &bound, &["start", "proceed"]);
            let made = |label, bytes: &[u8]| {
                let buffer = reading::storage(engine, label, bytes.len() as u64)?;
                engine.queue.write_buffer(&buffer, 0, bytes);
                Ok::<_, Error>(buffer)
            };
            let records = made("burgeon axiom", bytemuck::cast_slice(&records))?;
            let nets = match points {
                Some(points) => points.clone(),
                None => made("burgeon control points", bytemuck::cast_slice(&nets))?,
            };
            let room = Room {
                modules: modules.max(axiom.roots.len() as u32),
                given: asked.given.words.len(),
                turns: asked.turns.len(),
            };
            let buffers = Buffers::new(engine, plan, &room, [records, nets], None)?;
            let groups = Groups::new(engine, &stages, &shared, &proceed, &buffers);
            let run = Run {
                engine: engine.clone(),
                plan: plan.clone(),
                axiom: axiom.clone(),
                options: options.clone(),
                settings: asked.settings,
                given: asked.given,
                turns: asked.turns,
                room,
                rooms: 0,
                stages,
                shared,
                proceed,
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
        let asked = Asked::of(&self.plan, &self.axiom, &options)?;
        let engine = self.engine.clone();
        let changed = self.settings.uniforms != asked.settings.uniforms;
        let records = match changed && self.axiom.roots.iter().any(|root| !root.args.is_empty()) {
            true => Some(self.plan.axiom(&self.axiom, &asked.settings.uniforms)?.0),
            false => None,
        };
        let wanted =
            Room { given: asked.given.words.len(), turns: asked.turns.len(), modules: self.room.modules };
        if !self.room.holds(&wanted) {
            self.make_room(Room {
                given: wanted.given.max(self.room.given),
                turns: wanted.turns.max(self.room.turns),
                ..wanted
            })?;
        }
        if let Some(records) = records {
            engine.queue.write_buffer(&self.buffers.records[0], 0, bytemuck::cast_slice(&records));
        }
        for (id, kernels) in &self.stages {
            let words = environment(&self.plan, *id, &asked.settings.uniforms, &asked.given);
            engine.queue.write_buffer(&kernels.environment, 0, bytemuck::cast_slice(&words));
        }
        let others = self.given.words != asked.given.words;
        let reseeded = self.settings.seed != asked.settings.seed;
        (self.options, self.settings, self.given) = (options, asked.settings, asked.given);
        if others {
            self.write_given();
        }
        if others || reseeded || self.turns != asked.turns {
            self.turns = asked.turns;
            self.write_turns();
        }
        Ok(())
    }

    /// Room for other words, in new buffers but for the axiom's; what binds the others must be bound anew.
    ///
    /// # Errors
    /// [`Error::Binding`], and what the device says; then the old room is still there.
    pub fn set_capacity(&mut self, modules: u32) -> Result<(), Error> {
        let modules = modules.max(self.axiom.roots.len() as u32);
        self.make_room(Room { modules, ..self.room })
    }

    fn make_room(&mut self, room: Room) -> Result<(), Error> {
        let engine = self.engine.clone();
        engine.checked("making room for a derivation", || {
            let axiom = [&self.buffers.records[0], &self.buffers.nets[0]].map(Clone::clone);
            let buffers = Buffers::new(&engine, &self.plan, &room, axiom, Some(&self.buffers))?;
            self.groups = Groups::new(&engine, &self.stages, &self.shared, &self.proceed, &buffers);
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
        for (id, kernels) in &self.stages {
            let Some([groups, ..]) = self.groups.stages.get(id) else { continue };
            if let (Some(kernel), Some(group)) = (&kernels.measure, &groups.measure) {
                warm::idle(pass, kernel, group);
            }
            warm::idle(pass, &kernels.match_modules, &groups.matching);
            warm::idle(pass, &kernels.count, &groups.count);
            warm::idle(pass, &kernels.emit, &groups.emit);
        }
        warm::idle(pass, &self.shared.scan, &self.groups.scan);
        warm::idle(pass, &self.proceed, &self.groups.proceed);
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
            let (kernels, groups) = (&self.stages[&turn.stage], &self.groups.stages[&turn.stage][place]);
            let slot = [index as u32 * SLOT as u32];
            let workgroups = index as u64 * DISPATCH_BYTES;
            let one = |pass: &mut wgpu::ComputePass, kernel: &Kernel, group: &wgpu::BindGroup, at: u64| {
                pass.set_bind_group(0, group, &slot);
                pass.set_pipeline(&kernel.pipelines[0]);
                pass.dispatch_workgroups_indirect(&b.dispatches, workgroups + at);
            };
            if let (Some(kernel), Some(group)) = (&kernels.measure, &groups.measure) {
                one(pass, kernel, group, 0);
            }
            if turn.growth == 0 {
                one(pass, &kernels.match_modules, &groups.matching, 0);
                one(pass, &kernels.count, &groups.count, 0);
                pass.set_bind_group(0, &self.groups.scan, &slot);
                for (n, pipeline) in self.shared.scan.pipelines.iter().enumerate() {
                    pass.set_pipeline(pipeline);
                    match n {
                        1 => pass.dispatch_workgroups(1, 1, 1),
                        _ => pass.dispatch_workgroups_indirect(&b.dispatches, workgroups + 16),
                    }
                }
            }
            one(pass, &kernels.emit, &groups.emit, 32);
            pass.set_bind_group(0, &self.groups.proceed, &slot);
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

    /// Records of the word, in the order of the derivation tree:
    /// [`Layout::record_bytes`](crate::plan::layout::Layout::record_bytes) each. Another buffer when the schedule
    /// has another number of sweeps.
    pub fn records(&self) -> &wgpu::Buffer {
        &self.buffers.records[self.place()]
    }
    /// Nets of the word, in the same order: [`Layout::net_bytes`](crate::plan::layout::Layout::net_bytes) each.
    pub fn nets(&self) -> &wgpu::Buffer {
        &self.buffers.nets[self.place()]
    }
    /// Control points of the axiom, one root after the other, four floats each: to be written by whoever moves them.
    pub fn points(&self) -> &wgpu::Buffer {
        &self.buffers.nets[0]
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
    /// The records wherever a word may stand, and which of them it is now.
    pub(super) fn record_places(&self) -> (&[wgpu::Buffer], usize) {
        (&self.buffers.records, self.place())
    }
    pub fn plan(&self) -> &Plan {
        &self.plan
    }
    /// Params, values and view as they are now.
    pub fn options(&self) -> &Options {
        &self.options
    }
    pub fn axiom(&self) -> &patch::Axiom {
        &self.axiom
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
    pub fn read(&self) -> Result<(Progress, patch::Word), Error> {
        let (engine, layout) = (&self.engine, self.plan.tables.layout);
        let doing = "reading a derivation";
        let progress: Vec<Progress> =
            reading::read(engine, doing, self.progress(), size_of::<Progress>() as u64)?;
        let progress = progress.first().copied().unwrap_or_default();
        let n = u64::from(progress.modules.min(self.room.modules));
        let records = reading::read(engine, doing, self.records(), n * layout.record_bytes())?;
        let nets = reading::read(engine, doing, self.nets(), n * layout.net_bytes())?;
        Ok((progress, collect::word(&self.plan, progress.steps, &records, nets)?))
    }

    fn write_given(&self) {
        self.engine.queue.write_buffer(&self.buffers.attributes, 0, bytemuck::cast_slice(&self.given.words));
    }

    /// The extents, as far as the host knows them, and the turns.
    fn write_turns(&self) {
        let (b, queue) = (&self.buffers, &self.engine.queue);
        let count = self.axiom.roots.len() as u32;
        let layout = &self.plan.tables.layout;
        let slot_words = SLOT as usize / 4;
        let mut extents = vec![0u32; (self.turns.len() + 1) * slot_words];
        let mut turns = extents.clone();
        for (index, turn) in self.turns.iter().enumerate() {
            let extent = Extent {
                count,
                capacity: self.room.modules,
                clock: Clock { step: turn.step, run_step: 0, seed: self.settings.seed },
                given: self.given.words.len() as u32,
                ..Extent::default()
            };
            let words =
                TurnWords { index: index as u32, growth: turn.growth, flags: turn.flags, reserved: 0 };
            let at = index * slot_words;
            extents[at..at + 8].copy_from_slice(bytemuck::cast_slice(&[extent]));
            turns[at..at + 4].copy_from_slice(bytemuck::cast_slice(&[words]));
        }
        // A schedule without sweeps has the axiom as its word.
        extents[0..2].copy_from_slice(&[count, self.room.modules]);
        queue.write_buffer(&b.extents, 0, bytemuck::cast_slice(&extents));
        queue.write_buffer(&b.turns, 0, bytemuck::cast_slice(&turns));
        let tuning = self.engine.tuning();
        let groups = |invocations: u64, workgroup: u32| {
            let [x, y] = super::kernels::groups(invocations, workgroup);
            [x, y, 1, 0]
        };
        let n = u64::from(count);
        let first = [
            groups(n, tuning.workgroup),
            groups(n, tuning.tile()),
            groups(tuning.emit_invocations(n, layout), tuning.workgroup),
        ];
        queue.write_buffer(&b.dispatches, 0, bytemuck::cast_slice(&first));
    }
}

/// What options come to.
struct Asked {
    settings: Settings,
    given: Given,
    turns: Vec<Turn>,
}

impl Asked {
    fn of(plan: &Plan, axiom: &patch::Axiom, options: &Options) -> Result<Asked, Error> {
        let settings = plan.settings(&options.set, options.seed)?;
        let given = Given::new(&plan.system, axiom.roots.len(), &options.bind, options.view)?;
        let turns = turns::turns(plan, &schedule::unroll(plan, &settings.uniforms)?)?;
        Ok(Asked { settings, given, turns })
    }
}

/// The environment of a stage in which what could be retired is kept.
fn environment(plan: &Plan, id: StageId, uniforms: &[Value], given: &Given) -> Vec<u32> {
    let stage = id.of(plan);
    let mut words = plan.environment(stage, uniforms, given);
    words[stage.rule_table() + stage.retired() as usize] = rule_word(0, 1);
    words
}
