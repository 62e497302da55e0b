//! From tables to WGSL: what the rules say is generated, all else is a file of `wgsl/`.
//!
//! Every module is parsed and validated by naga before a device sees it, with the capabilities of
//! WebGPU's core alone. Errors are traced back to the file, or to the rule, that they come from.

mod generate;
mod link;
mod refine;
mod tessellation;
mod unroll;

#[doc(hidden)]
pub use link::{Edit, GENERATED};
pub use refine::{Around, Levels, Refinement, levels, refinement};
pub use tessellation::{Tessellation, TessellationShaders, tessellation, tessellation_edited, vertices};

use crate::language::Span;
use crate::plan::Plan;
use crate::plan::derive::StageId;
use crate::plan::layout::Layout;
use crate::plan::program::{Over, Work};
use crate::plan::step::Pass;
use crate::plan::tables::Stage;

/// How `emit` is laid out over invocations; the bits that come out are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mapping {
    /// An invocation a net, all of it in registers: fewest loads, no barrier. For nets of degrees up
    /// to 4; others, for which drivers would compile long and spill, are taken by lines. `wgsl/emit.wgsl`.
    NetPerInvocation,
    /// An invocation a control point, nets in workgroup memory: every access coalesced. For bicubic
    /// nets; others are taken by lines. `wgsl/emit_by_point.wgsl`.
    PointPerInvocation,
    /// An invocation a row or column, which it holds in registers; halves in workgroup memory.
    /// `wgsl/emit_by_line.wgsl`.
    LinePerInvocation,
}

impl Mapping {
    /// The kernel's file.
    fn kernel(self) -> &'static str {
        match self {
            Mapping::NetPerInvocation => "emit",
            Mapping::PointPerInvocation => "emit_by_point",
            Mapping::LinePerInvocation => "emit_by_line",
        }
    }
}

/// Sizes that a device wants; they change no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tuning {
    /// Invocations a workgroup of `match_modules`, `count`, `emit` and `retire`: a multiple of 16 where
    /// a mapping shares nets among invocations.
    pub workgroup: u32,
    /// Invocations a workgroup of `scan` and `compact`, a power of two.
    pub scan_workgroup: u32,
    /// Elements an invocation of these, a multiple of 32.
    pub scan_items: u32,
    pub mapping: Mapping,
}

impl Tuning {
    /// For drivers that run on the CPU: barriers and loads are dear, threads are few.
    pub const CPU_DRIVER: Tuning =
        Tuning { workgroup: 64, scan_workgroup: 64, scan_items: 256, mapping: Mapping::NetPerInvocation };
    /// For GPUs.
    pub const GPU: Tuning =
        Tuning { workgroup: 64, scan_workgroup: 256, scan_items: 32, mapping: Mapping::PointPerInvocation };

    /// The file of a pass's kernel.
    fn kernel(&self, pass: Pass, layout: &Layout) -> &'static str {
        match pass {
            Pass::Emit => self.mapping_of(layout).kernel(),
            _ => pass.row().kernel,
        }
    }

    /// How `emit` is laid out for nets of this layout.
    fn mapping_of(&self, layout: &Layout) -> Mapping {
        match self.mapping {
            Mapping::NetPerInvocation if lines(layout) > 5 => Mapping::LinePerInvocation,
            Mapping::PointPerInvocation if layout.net != Some([3, 3]) => Mapping::LinePerInvocation,
            mapping => mapping,
        }
    }

    /// Points of a curve that an invocation of `emit_word` takes where one production fires on all: a driver on the CPU
    /// loads every lane by itself, and neighbours share what they read; a GPU wants its lanes side by side.
    pub fn points_each(&self) -> usize {
        if self.mapping == Mapping::NetPerInvocation { 4 } else { 1 }
    }

    /// Invocations that write the children of so many modules.
    pub fn children(&self, pass: Pass, modules: u64, stage: &Stage, layout: &Layout) -> u64 {
        match (pass, self.mapping_of(layout)) {
            (Pass::EmitWord, _) => match generate::only_production(stage) {
                Some(_) => modules.div_ceil(self.points_each() as u64),
                None => modules,
            },
            (_, Mapping::NetPerInvocation) => modules,
            (_, Mapping::PointPerInvocation) => modules * layout.net_points() as u64,
            (_, Mapping::LinePerInvocation) => {
                modules.div_ceil(self.nets_by_line(layout) as u64) * self.workgroup as u64
            }
        }
    }

    /// Modules whose children a workgroup writes.
    pub fn children_a_group(&self, pass: Pass, stage: &Stage, layout: &Layout) -> u64 {
        let group = u64::from(self.workgroup);
        match (pass, self.mapping_of(layout)) {
            (Pass::EmitWord, _) => match generate::only_production(stage) {
                Some(_) => group * self.points_each() as u64,
                None => group,
            },
            (_, Mapping::NetPerInvocation) => group,
            (_, Mapping::PointPerInvocation) => group / layout.net_points() as u64,
            (_, Mapping::LinePerInvocation) => self.nets_by_line(layout) as u64,
        }
    }

    /// Nets that a workgroup takes by lines: as many as it has invocations for, and memory for both
    /// halves of each.
    fn nets_by_line(&self, layout: &Layout) -> usize {
        let memory = WORKGROUP_BYTES / (2 * layout.net_bytes() as usize).max(16);
        (self.workgroup as usize / lines(layout)).min(memory).max(1)
    }

    /// Elements of a tile of `scan` and `compact`.
    pub fn tile(&self) -> u32 {
        self.scan_workgroup * self.scan_items
    }
}

/// Workgroup memory that WebGPU gives.
const WORKGROUP_BYTES: usize = 16 << 10;

/// Rows or columns, whichever are more.
fn lines(layout: &Layout) -> usize {
    let [rows, columns] = layout.net_sides();
    rows.max(columns).max(1)
}

/// A linked and validated WGSL module.
#[derive(Clone, Debug)]
pub struct Shader {
    /// The kernel's file, without `.wgsl`.
    pub name: &'static str,
    pub source: String,
    pub module: naga::Module,
}

/// A module that naga refuses.
#[derive(Debug, thiserror::Error)]
#[error("kernel {kernel}, {place}: {message}")]
pub struct Error {
    pub kernel: &'static str,
    /// The file and line of `wgsl/`, or the rule.
    pub place: String,
    pub message: String,
    /// The rule whose generated code it is.
    pub rule: Option<Span>,
}

/// Generates, links and validates the kernels of a stage, in the order in which its passes first run: those that depend on
/// its rules.
pub fn stage(plan: &Plan, id: StageId, tuning: &Tuning) -> Result<Vec<Shader>, Error> {
    let works = kernels(id.of(plan).program.works()).filter(|work| work.pass.row().of_rules);
    works.map(|work| kernel(plan, id, work, tuning, None)).collect()
}

/// Those that know only the layout, of all stages of a plan.
pub fn shared(plan: &Plan, tuning: &Tuning) -> Result<Vec<Shader>, Error> {
    let stages = plan.stages();
    let programs = stages.iter().flat_map(|id| {
        let program = &id.of(plan).program;
        program.joining.iter().chain(program.works()).map(move |work| (*id, work))
    });
    let mut known: Vec<Pass> = Vec::new();
    let mut shaders = Vec::new();
    for (id, work) in programs.filter(|(_, work)| !work.pass.row().of_rules) {
        if !known.contains(&work.pass) {
            known.push(work.pass);
            shaders.push(kernel(plan, id, work, tuning, None)?);
        }
    }
    Ok(shaders)
}

/// The first pass of each kernel.
fn kernels<'w>(works: impl Iterator<Item = &'w Work>) -> impl Iterator<Item = &'w Work> {
    let mut known = Vec::new();
    works.filter(move |work| {
        let kernel = work.pass.row().kernel;
        let new = !known.contains(&kernel);
        known.push(kernel);
        new
    })
}

/// The kernel of a pass as a stage runs it, with a text replaced on purpose if that is given.
#[doc(hidden)]
pub fn kernel(
    plan: &Plan,
    id: StageId,
    work: &Work,
    tuning: &Tuning,
    edit: Option<&Edit>,
) -> Result<Shader, Error> {
    let (stage, layout, tables) = (id.of(plan), &plan.tables.layout, &plan.tables);
    let scans = work.calls.iter().any(|call| matches!(call.over, Over::Tiles(_)));
    let mut constants = if scans { scan_constants(tuning) } else { workgroup_constant(tuning) };
    constants.push_str(&layout_constants(layout, tuning));
    constants.push_str(&format!("const RING = {};\n", layout.ring));
    if work.pass.row().of_rules {
        constants.push_str(&stage_constants(plan, stage, tuning));
    }
    let parts = |part: &str| {
        Some(match part {
            "record" => generate::record(layout),
            "write_record" => generate::write_record(layout),
            "measures" => generate::measures(&stage.row),
            "ignored" => generate::ignored(tables),
            "searches" => generate::searches(tables),
            "commands" => generate::commands(&tables.turtle, layout),
            "matching" => generate::matching(stage),
            "successors" => generate::successors(stage, layout),
            "only_children" => generate::only_children(stage, tuning.points_each()),
            _ => return None,
        })
    };
    build(tuning.kernel(work.pass, layout), &constants, &parts, edit)
}

/// `scan` and `compact` by themselves.
#[doc(hidden)]
pub fn scans(tuning: &Tuning, edit: Option<&Edit>) -> Result<[Shader; 2], Error> {
    let constants = scan_constants(tuning);
    Ok([build("scan", &constants, NOTHING, edit)?, build("compact", &constants, NOTHING, edit)?])
}

/// The kernel between the sweeps of a derivation that is recorded.
#[doc(hidden)]
pub fn proceed_edited(tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    let constants = format!("{}const TILE = {}u;\n", workgroup_constant(tuning), tuning.tile());
    build("proceed", &constants, NOTHING, edit)
}

/// The kernel that writes where a turtle starts.
#[doc(hidden)]
pub fn start_word_edited(layout: &Layout, edit: Option<&Edit>) -> Result<Shader, Error> {
    let constants =
        format!("const QUADS = {}u;\nconst HALO = {}u;\n", layout.record_words / 4, layout.halo());
    build("start_word", &constants, NOTHING, edit)
}

/// The kernel that applies a table of stencils.
pub fn stencil(tuning: &Tuning) -> Result<Shader, Error> {
    stencil_edited(tuning, None)
}

/// The same, with a text replaced on purpose.
#[doc(hidden)]
pub fn stencil_edited(tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    build("stencil", &workgroup_constant(tuning), NOTHING, edit)
}

/// The kernels that measure the device: `copy` and `expand`.
pub fn measures(tuning: &Tuning) -> Result<[Shader; 2], Error> {
    let constants = workgroup_constant(tuning);
    Ok([build("copy", &constants, NOTHING, None)?, build("expand", &constants, NOTHING, None)?])
}

/// Of kernels that import nothing generated.
const NOTHING: link::Parts = &|_| None;

fn workgroup_constant(tuning: &Tuning) -> String {
    format!("const WORKGROUP = {}u;\n", tuning.workgroup)
}

fn layout_constants(layout: &Layout, tuning: &Tuning) -> String {
    format!(
        "const QUADS = {}u;\nconst HALO = {}u;\nconst LINK = {}u;\nconst WORD = {}u;\nconst POINTS = {}u;\nconst ROWS = {}u;\n\
         const COLUMNS = {}u;\nconst LINES = {}u;\nconst NETS = {}u;\n",
        layout.record_words / 4,
        layout.halo(),
        layout.link.unwrap_or(0),
        layout.word.unwrap_or(0),
        layout.net_points(),
        layout.net_sides()[0],
        layout.net_sides()[1],
        lines(layout),
        tuning.nets_by_line(layout),
    )
}

fn stage_constants(plan: &Plan, stage: &Stage, tuning: &Tuning) -> String {
    format!(
        "{}const TRACED = {};\nconst BEFORE = {};\nconst ONLY = {};\nconst EACH = {}u;\nconst CLOSED = {}u;\n\
         const MEASURED = {}u;\nconst CELLS = {}u;\nconst RATIONAL = {};\nconst READS_NETS = {};\nconst VIEW = {}u;\n",
        rule_constants(stage),
        stage.roots,
        plan.tables.turtle.before,
        generate::only_production(stage).is_some(),
        tuning.points_each(),
        stage.closed.unwrap_or(0),
        stage.row.words,
        generate::cells(stage),
        plan.rational(),
        stage.row.reads_nets(),
        plan.tables.given.view(),
    )
}

/// Where the rule table stands.
fn rule_constants(stage: &Stage) -> String {
    let table = stage.rule_table();
    let words = (table + stage.productions.len() + 2).next_multiple_of(4);
    format!(
        "const ENVIRONMENT_QUADS = {}u;\nconst RULE_TABLE = {table}u;\nconst KEEP = {}u;\n\
         const ONLY_RULE_WORD = {}u;\n",
        words / 4,
        stage.keep(),
        only_rule_word(stage),
    )
}

/// The word of all rules that can fire, where it is one; 0 where it is not.
fn only_rule_word(stage: &Stage) -> u32 {
    if stage.closed.is_none() {
        return 0;
    }
    let firing = (0..stage.by_symbol.len()).filter_map(|symbol| stage.first_production(symbol));
    let mut words = firing.map(|production| stage.productions[production].word());
    let first = words.next().unwrap_or(0);
    if words.all(|w| w == first) { first } else { 0 }
}

fn scan_constants(tuning: &Tuning) -> String {
    format!(
        "const WORKGROUP = {}u;\nconst ITEMS = {}u;\nconst ITEM_WORDS = {}u;\nconst TILE = {}u;\n",
        tuning.scan_workgroup,
        tuning.scan_items,
        tuning.scan_items.div_ceil(32),
        tuning.tile()
    )
}

fn build(
    name: &'static str,
    constants: &str,
    parts: link::Parts,
    edit: Option<&Edit>,
) -> Result<Shader, Error> {
    let linked = link::link(name, constants, parts, edit);
    let module = link::validate(name, &linked)?;
    Ok(Shader { name, source: linked.source, module })
}
