//! The pipelines of a tessellation, and what each binds.

use super::super::kernels::{Binding, Bound, Kernel};
use super::super::run::Run;
use super::super::{Engine, Error, warm};
use super::buffers::{Buffers, Of, RANGE_BYTES};
use crate::codegen::{self, Shader, Tessellation};
use crate::plan::Stored;

/// One kernel a pass.
pub(super) struct Kernels {
    begin: Kernel,
    decide: Kernel,
    pub scan: Kernel,
    split: Kernel,
    advance: Kernel,
    mark: Kernel,
    tally: Kernel,
    afford: Kernel,
    finish: Kernel,
    pub vertices: Kernel,
    triangles: Kernel,
    pub derived: Option<Derived>,
}

/// The kernels of a word that is derived each frame.
pub(super) struct Derived {
    pub recall: Kernel,
    pub adopt: Kernel,
    pub enter: Kernel,
}

/// What these are bound to: `recall` from wherever the word may stand.
pub(super) struct DerivedGroups {
    pub recall: Vec<wgpu::BindGroup>,
    pub adopt: wgpu::BindGroup,
    pub enter: wgpu::BindGroup,
}

/// What they are bound to, for one frame of two that take turns.
pub(super) struct Groups {
    pub begin: wgpu::BindGroup,
    pub decide: wgpu::BindGroup,
    pub scan: [wgpu::BindGroup; 2],
    pub split: wgpu::BindGroup,
    pub advance: wgpu::BindGroup,
    pub mark: wgpu::BindGroup,
    pub tally: wgpu::BindGroup,
    pub afford: wgpu::BindGroup,
    pub finish: wgpu::BindGroup,
    pub vertices: wgpu::BindGroup,
    pub triangles: wgpu::BindGroup,
}

use Bound::{Read, Slot, Uniform, Written};

impl Kernels {
    pub fn new(engine: &Engine, what: &Tessellation) -> Result<Kernels, Error> {
        let s = codegen::tessellation_edited(what, engine.tuning(), engine.edit.as_ref())?;
        let kernel = |shader, bindings: &[Bound], entries: &[&'static str]| {
            Kernel::with_bindings(engine, shader, bindings, entries)
        };
        Ok(Kernels {
            begin: kernel(&s.begin, &[Uniform, Uniform, Read, Written, Written], &["begin"]),
            decide: kernel(
                &s.decide,
                &[Slot, Uniform, Uniform, Read, Read, Read, Read, Read, Read, Written, Written],
                &["decide"],
            ),
            scan: kernel(&s.scan, &[Slot, Read, Written, Written], &["reduce", "spine", "scan"]),
            split: kernel(&s.split, &[Slot, Uniform, Read, Read, Written, Written, Written], &["split"]),
            advance: kernel(&s.advance, &[Slot, Uniform, Read, Read, Written, Written], &["advance"]),
            mark: kernel(&s.mark, &[Slot, Read, Read, Read, Read, Written], &["mark"]),
            tally: kernel(&s.tally, &[Slot, Uniform, Read, Read, Read, Read, Written, Written], &["tally"]),
            afford: kernel(&s.afford, &[Slot, Uniform, Uniform, Read, Written, Written], &["afford"]),
            finish: kernel(&s.finish, &[Slot, Uniform, Read, Read, Written, Written, Written], &["finish"]),
            vertices: Kernels::vertices(engine, &s.vertices),
            triangles: kernel(
                &s.triangles,
                &[Slot, Uniform, Read, Read, Read, Read, Read, Read, Written, Written],
                &["triangles"],
            ),
            derived: s.derived.as_ref().map(|[recall, adopt, enter]| Derived {
                recall: kernel(
                    recall,
                    &[Uniform, Read, Read, Read, Read, Read, Written, Written, Written],
                    &["recall"],
                ),
                adopt: kernel(
                    adopt,
                    &[Uniform, Read, Written, Written, Written, Written, Written],
                    &["adopt"],
                ),
                enter: kernel(
                    enter,
                    &[Slot, Uniform, Read, Read, Written, Written, Written, Written],
                    &["forget", "enter", "arrange"],
                ),
            }),
        })
    }

    /// Dispatches all over no workgroups.
    pub fn idle(&self, pass: &mut wgpu::ComputePass, groups: &Groups) {
        // Those of rules are dispatched by every frame that has some.
        let pairs = [
            (&self.begin, &groups.begin),
            (&self.decide, &groups.decide),
            (&self.scan, &groups.scan[0]),
            (&self.split, &groups.split),
            (&self.advance, &groups.advance),
            (&self.mark, &groups.mark),
            (&self.tally, &groups.tally),
            (&self.afford, &groups.afford),
            (&self.finish, &groups.finish),
            (&self.vertices, &groups.vertices),
            (&self.triangles, &groups.triangles),
        ];
        pairs.into_iter().for_each(|(kernel, group)| warm::idle(pass, kernel, group));
    }

    /// Binds the buffers of a word that is derived, if it is.
    pub fn derived_groups(&self, engine: &Engine, b: &Buffers, run: &Run) -> Option<DerivedGroups> {
        let (kernels, words) = (self.derived.as_ref()?, b.words.as_ref()?);
        let recall = |records: &wgpu::Buffer| {
            kernels.recall.bind(
                engine,
                &[
                    Binding::whole(&words.source),
                    Binding::whole(run.progress()),
                    Binding::whole(records),
                    Binding::whole(&b.topology),
                    Binding::whole(&b.nodes),
                    Binding::whole(&b.table),
                    Binding::whole(&words.leaves),
                    Binding::whole(&b.leaves_before),
                    Binding::whole(&words.too_deep),
                ],
            )
        };
        let adopt = [
            Binding::whole(&b.sizes),
            Binding::whole(run.progress()),
            Binding::whole(&b.ranges),
            Binding::whole(&b.dispatches),
            Binding::whole(&words.too_deep),
            Binding::whole(&words.adopted),
            Binding::whole(&b.status),
        ];
        let enter = [
            Binding { buffer: &b.ranges, offset: 0, bytes: RANGE_BYTES },
            Binding::whole(&words.source),
            Binding::whole(&words.adopted),
            Binding::whole(&words.leaves),
            Binding::whole(&b.leaves_before),
            Binding::whole(&b.nodes),
            Binding::whole(&b.table),
            Binding::whole(&words.shapes),
        ];
        Some(DerivedGroups {
            recall: run.column_places(Stored::Records).0.into_iter().map(recall).collect(),
            adopt: kernels.adopt.bind(engine, &adopt),
            enter: kernels.enter.bind(engine, &enter),
        })
    }

    /// The kernel of the vertices, of one placement or another.
    pub fn vertices(engine: &Engine, shader: &Shader) -> Kernel {
        let bindings = [Slot, Uniform, Read, Read, Read, Read, Read, Read, Read, Written, Uniform];
        Kernel::with_bindings(engine, shader, &bindings, &["vertices"])
    }

    /// Binds the buffers; `now` says whose turn it is.
    pub fn groups(&self, engine: &Engine, b: &Buffers, now: usize) -> Groups {
        let whole = |buffer: &'_ wgpu::Buffer| buffer.size();
        macro_rules! all {
            ($($buffer:expr),*) => { [$(Binding { buffer: $buffer, offset: 0, bytes: whole($buffer) }),*] };
        }
        let slot = |buffer| Binding { buffer, offset: 0, bytes: RANGE_BYTES };
        let range = slot(&b.ranges);
        let section = |buffer, section| {
            let bytes = b.section_bytes();
            Binding { buffer, offset: if section == Of::Triangles { bytes } else { 0 }, bytes }
        };
        let (children, before) = (&b.children[now], &b.children[1 - now]);
        let bind = |kernel: &Kernel, first: Binding, rest: &[Binding]| {
            kernel.bind(engine, &[&[first], rest].concat())
        };
        let scan = |s| {
            let [sums] = all![&b.sums];
            bind(&self.scan, range, &[section(&b.counts, s), section(&b.offsets, s), sums])
        };
        Groups {
            begin: self.begin.bind(engine, &all![&b.sizes, &b.target, &b.ranges, &b.dispatches, &b.budget]),
            decide: bind(
                &self.decide,
                range,
                &all![
                    &b.sizes,
                    &b.target,
                    &b.topology,
                    &b.nets,
                    &b.nodes,
                    before,
                    &b.budget,
                    &b.leaves_before,
                    &b.counts,
                    &b.marks
                ],
            ),
            scan: [scan(Of::Vertices), scan(Of::Triangles)],
            split: bind(
                &self.split,
                range,
                &all![&b.sizes, &b.offsets, before, &b.counts, &b.nodes, children],
            ),
            advance: bind(
                &self.advance,
                slot(&b.turns),
                &all![&b.sizes, &b.offsets, &b.budget, &b.ranges, &b.dispatches],
            ),
            mark: bind(&self.mark, range, &all![&b.topology, &b.nodes, children, &b.table, &b.marks]),
            tally: bind(
                &self.tally,
                range,
                &all![&b.sizes, &b.topology, &b.nodes, children, &b.table, &b.marks, &b.counts],
            ),
            afford: bind(
                &self.afford,
                range,
                &all![&b.sizes, &b.target, &b.offsets, &b.dispatches, &b.budget],
            ),
            finish: bind(
                &self.finish,
                range,
                &[&all![&b.sizes, &b.offsets, &b.budget, &b.status][..], &[b.draw.binding()], &all![&b.last]]
                    .concat(),
            ),
            vertices: bind(
                &self.vertices,
                range,
                &all![&b.outputs, &b.topology, &b.nets, &b.nodes, children, &b.table, &b.marks, &b.offsets]
                    .into_iter()
                    .chain([b.vertices.binding(), Binding::whole(&b.environment)])
                    .collect::<Vec<_>>(),
            ),
            triangles: bind(
                &self.triangles,
                range,
                &all![&b.sizes, &b.topology, &b.nodes, children, &b.table, &b.marks, &b.offsets]
                    .into_iter()
                    .chain([b.indices.binding(), Binding::whole(&b.cells)])
                    .collect::<Vec<_>>(),
            ),
        }
    }

    /// The pass of this kernel.
    pub fn of(&self, pass: Pass) -> &wgpu::ComputePipeline {
        let kernel = match pass {
            Pass::Begin => &self.begin,
            Pass::Decide => &self.decide,
            Pass::Split => &self.split,
            Pass::Advance => &self.advance,
            Pass::Mark => &self.mark,
            Pass::Tally => &self.tally,
            Pass::Afford => &self.afford,
            Pass::Finish => &self.finish,
            Pass::Vertices => &self.vertices,
            Pass::Triangles => &self.triangles,
        };
        &kernel.pipelines[0]
    }
}

/// The passes of one dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    Begin,
    Decide,
    Split,
    Advance,
    Mark,
    Tally,
    Afford,
    Finish,
    Vertices,
    Triangles,
}
