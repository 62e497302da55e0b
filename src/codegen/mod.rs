//! From tables to WGSL: what the rules say is generated, all else is a file of `wgsl/`.
//!
//! Every module is parsed and validated by naga before a device sees it, with the capabilities of
//! WebGPU's core alone. Errors are traced back to the file, or to the rule, that they come from.

mod generate;
mod link;
mod tessellation;
mod unroll;

#[doc(hidden)]
pub use link::{Edit, GENERATED};
pub use tessellation::{Tessellation, TessellationShaders, tessellation, tessellation_edited, vertices};

use crate::language::Span;
use crate::plan::Plan;
use crate::plan::derive::StageId;
use crate::plan::layout::Layout;
use crate::plan::measure::MEASURES;
use crate::plan::tables::{Production, Stage};

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

    /// The kernel that writes children.
    fn emit_kernel(&self, layout: &Layout) -> &'static str {
        if layout.is_curve() { "emit_word" } else { self.mapping_of(layout).kernel() }
    }

    /// How `emit` is laid out for nets of this layout.
    fn mapping_of(&self, layout: &Layout) -> Mapping {
        match self.mapping {
            Mapping::NetPerInvocation if lines(layout) > 5 => Mapping::LinePerInvocation,
            Mapping::PointPerInvocation if layout.degree != [3, 3] => Mapping::LinePerInvocation,
            mapping => mapping,
        }
    }

    /// Points of a curve that an invocation of `emit_word` takes where one production fires on all: a driver on the CPU
    /// loads every lane by itself, and neighbours share what they read; a GPU wants its lanes side by side.
    pub fn points_each(&self) -> usize {
        if self.mapping == Mapping::NetPerInvocation { 4 } else { 1 }
    }

    /// Invocations of `emit_word` for so many points.
    pub fn word_invocations(&self, points: u64, stage: &Stage) -> u64 {
        match generate::only_production(stage) {
            Some(_) => points.div_ceil(self.points_each() as u64),
            None => points,
        }
    }

    /// Invocations of `emit` for so many nets.
    pub fn emit_invocations(&self, nets: u64, layout: &Layout) -> u64 {
        if layout.is_curve() {
            return nets;
        }
        match self.mapping_of(layout) {
            Mapping::NetPerInvocation => nets,
            Mapping::PointPerInvocation => nets * layout.net_points() as u64,
            Mapping::LinePerInvocation => {
                nets.div_ceil(self.nets_by_line(layout) as u64) * self.workgroup as u64
            }
        }
    }

    /// Nets that a workgroup of `emit` takes.
    fn emit_nets(&self, layout: &Layout) -> usize {
        if layout.is_curve() {
            return self.workgroup as usize;
        }
        match self.mapping_of(layout) {
            Mapping::NetPerInvocation => self.workgroup as usize,
            Mapping::PointPerInvocation => self.workgroup as usize / layout.net_points(),
            Mapping::LinePerInvocation => self.nets_by_line(layout),
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
    layout.degree[0].max(layout.degree[1]) as usize + 1
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

/// The kernels of a stage that depend on its rules.
pub struct StageShaders {
    /// Where the rules read attributes of nets.
    pub measure: Option<Shader>,
    /// Where words are linked.
    pub link: Option<Shader>,
    /// Where the word is traced: `turtle`, or `turtle_linked`.
    pub turtle: Option<Shader>,
    pub match_modules: Shader,
    /// Where rules replace several modules.
    pub claim: Option<Shader>,
    pub count: Shader,
    pub emit: Shader,
}

/// Generates, links and validates the kernels of a stage.
pub fn stage(plan: &Plan, id: StageId, tuning: &Tuning) -> Result<StageShaders, Error> {
    stage_edited(plan, id, tuning, None)
}

/// The same, with a text replaced on purpose.
#[doc(hidden)]
pub fn stage_edited(
    plan: &Plan,
    id: StageId,
    tuning: &Tuning,
    edit: Option<&Edit>,
) -> Result<StageShaders, Error> {
    let stage = id.of(plan);
    let constants = stage_constants(plan, stage, tuning);
    let layout = plan.tables.layout;
    let mut matching = generate::searches(&plan.tables);
    matching.append(generate::matching(stage));
    let mut match_parts = generate::record(&layout, false);
    match_parts.append(matching.clone());
    let mut emit_parts = generate::record(&layout, true);
    emit_parts.append(matching);
    emit_parts.append(generate::successors(stage, &layout));
    if layout.is_curve() {
        emit_parts.append(generate::only_children(stage, tuning.points_each()));
    }
    let turtle = match stage.row.turtle {
        true => Some(turtle(plan, stage, tuning, edit)?),
        false => None,
    };
    let measure = match stage.row.words {
        0 => None,
        _ if stage.row.turtle => None,
        _ => {
            let constants = format!("{constants}{}", measure_constants(plan, stage));
            Some(build("measure", &constants, generate::record(&layout, false), edit)?)
        }
    };
    let claim = match stage.claims() {
        true => {
            let constants = format!("{}{}", rule_constants(stage), scan_constants(tuning));
            Some(build("claim", &constants, generate::Text::default(), edit)?)
        }
        false => None,
    };
    let link = match layout.link {
        Some(_) => {
            let mut parts = generate::record(&layout, false);
            parts.append(generate::ignored(&plan.tables));
            Some(build("link", &constants, parts, edit)?)
        }
        None => None,
    };
    Ok(StageShaders {
        measure,
        link,
        turtle,
        claim,
        match_modules: build("match_modules", &constants, match_parts, edit)?,
        count: build("count", &constants, generate::Text::default(), edit)?,
        emit: build(tuning.emit_kernel(&layout), &constants, emit_parts, edit)?,
    })
}

/// What finds where the turtle stands.
fn turtle(plan: &Plan, stage: &Stage, tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    let (layout, turtle) = (&plan.tables.layout, &plan.tables.turtle);
    let linked = layout.link.is_some();
    let workgroup = format!("const WORKGROUP = {}u;\n", tuning.workgroup);
    let constants = format!(
        "{}const QUADS = {}u;\nconst HALO = {}u;\nconst MEASURED = {}u;\nconst BEFORE = {};\n",
        if linked { workgroup } else { scan_constants(tuning) },
        layout.record_words / 4,
        layout.halo(),
        stage.row.words,
        turtle.before,
    );
    let mut parts = generate::record(layout, false);
    parts.append(generate::commands(turtle, layout));
    build(if linked { "turtle_linked" } else { "turtle" }, &constants, parts, edit)
}

/// The kernels that know only the layout.
pub struct SharedShaders {
    pub scan: Shader,
    pub compact: Shader,
    pub retire: Shader,
}

/// Links and validates the kernels that know only the layout.
pub fn shared(layout: &Layout, tuning: &Tuning) -> Result<SharedShaders, Error> {
    shared_edited(layout, tuning, None)
}

/// The same, with a text replaced on purpose.
#[doc(hidden)]
pub fn shared_edited(layout: &Layout, tuning: &Tuning, edit: Option<&Edit>) -> Result<SharedShaders, Error> {
    let nothing = generate::Text::default;
    Ok(SharedShaders {
        scan: build("scan", &scan_constants(tuning), nothing(), edit)?,
        compact: build("compact", &scan_constants(tuning), nothing(), edit)?,
        retire: build("retire", &layout_constants(layout, tuning), nothing(), edit)?,
    })
}

/// The kernel between the sweeps of a derivation that is recorded.
#[doc(hidden)]
pub fn proceed_edited(layout: &Layout, tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    let constants = format!(
        "const WORKGROUP = {}u;\nconst TILE = {}u;\nconst EMIT_NETS = {}u;\n",
        tuning.workgroup,
        tuning.tile(),
        tuning.emit_nets(layout)
    );
    build("proceed", &constants, generate::Text::default(), edit)
}

/// The kernel that applies a table of stencils.
pub fn stencil(tuning: &Tuning) -> Result<Shader, Error> {
    stencil_edited(tuning, None)
}

/// The same, with a text replaced on purpose.
#[doc(hidden)]
pub fn stencil_edited(tuning: &Tuning, edit: Option<&Edit>) -> Result<Shader, Error> {
    let constants = format!("const WORKGROUP = {}u;\n", tuning.workgroup);
    build("stencil", &constants, generate::Text::default(), edit)
}

/// The kernels that measure the device: `copy` and `expand`.
pub fn measures(tuning: &Tuning) -> Result<[Shader; 2], Error> {
    let constants = format!("const WORKGROUP = {}u;\n", tuning.workgroup);
    Ok([
        build("copy", &constants, generate::Text::default(), None)?,
        build("expand", &constants, generate::Text::default(), None)?,
    ])
}

fn layout_constants(layout: &Layout, tuning: &Tuning) -> String {
    format!(
        "const WORKGROUP = {}u;\nconst QUADS = {}u;\nconst HALO = {}u;\nconst LINK = {}u;\nconst WORD = {}u;\nconst POINTS = {}u;\nconst ROWS = {}u;\nconst COLUMNS = {}u;\n\
         const LINES = {}u;\nconst NETS = {}u;\n",
        tuning.workgroup,
        layout.record_words / 4,
        layout.halo(),
        layout.link.unwrap_or(0),
        layout.word.unwrap_or(0),
        layout.net_points(),
        layout.degree[0] + 1,
        layout.degree[1] + 1,
        lines(layout),
        tuning.nets_by_line(layout),
    )
}

fn stage_constants(plan: &Plan, stage: &Stage, tuning: &Tuning) -> String {
    format!(
        "{}{}const TRACED = {};\nconst ONLY = {};\nconst EACH = {}u;\nconst CLOSED = {}u;\nconst MEASURED = {}u;\nconst CELLS = {}u;\n",
        layout_constants(&plan.tables.layout, tuning),
        rule_constants(stage),
        stage.roots,
        generate::only_production(stage).is_some(),
        tuning.points_each(),
        stage.closed.unwrap_or(0),
        stage.row.words,
        generate::cells(stage),
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

fn measure_constants(plan: &Plan, stage: &Stage) -> String {
    let mut text = format!(
        "const RATIONAL = {};\n\
         const READS_NETS = {};\nconst VIEW = {}u;\n",
        plan.rational(),
        stage.row.reads_nets(),
        plan.tables.given.view()
    );
    for (place, measure) in stage.row.places.iter().zip(MEASURES) {
        let place = place.map_or("NOWHERE".to_string(), |at| format!("{at}u"));
        text.push_str(&format!("const {} = {place};\n", measure.place));
    }
    text
}

/// The word of all rules that can fire, where it is one; 0 where it is not.
fn only_rule_word(stage: &Stage) -> u32 {
    if stage.closed.is_none() {
        return 0;
    }
    let first = |ids: &Vec<usize>| Some(&stage.productions[stage.rules[*ids.first()?].productions.start]);
    let mut words = stage.by_symbol.iter().filter_map(first).map(Production::word);
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
    generated: generate::Text,
    edit: Option<&Edit>,
) -> Result<Shader, Error> {
    let linked = link::link(name, constants, &generated, edit);
    let module = link::validate(name, &linked)?;
    Ok(Shader { name, source: linked.source, module })
}
