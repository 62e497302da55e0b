//! Pipelines and bind groups, made from the list of passes.

use super::{Engine, Error, buffers};
use crate::codegen::{self, Shader};
use crate::plan::derive::StageId;
use crate::plan::layout::Layout;
use crate::plan::step::{self, Column, Pass};
use crate::plan::{Given, Plan};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// One compute pipeline; `stages` of it where a pass takes several dispatches.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
    /// Whether one of its bindings is a slot.
    pub slotted: bool,
    label: &'static str,
}

/// Kernels by their source, bindings and entries.
pub type Kept = Arc<Mutex<HashMap<(String, Vec<Bound>, Vec<String>), Kernel>>>;

impl Kernel {
    /// A kernel whose bindings are these columns: (column, written).
    pub fn new(engine: &Engine, shader: &Shader, bindings: &[(Column, bool)], entries: &[&str]) -> Kernel {
        let bound = bindings.iter().map(|&(column, written)| match column {
            Column::Extent => Bound::Slot,
            Column::Environment => Bound::Uniform,
            _ if written => Bound::Written,
            _ => Bound::Read,
        });
        Kernel::with_bindings(engine, shader, &bound.collect::<Vec<_>>(), entries)
    }

    /// A kernel with these bindings, numbered from 0.
    pub fn with_bindings(engine: &Engine, shader: &Shader, bindings: &[Bound], entries: &[&str]) -> Kernel {
        let Some(kept) = &engine.kept else { return Kernel::made(engine, shader, bindings, entries) };
        let entry_names = entries.iter().map(|entry| entry.to_string()).collect();
        let key = (shader.source.clone(), bindings.to_vec(), entry_names);
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.entry(key).or_insert_with(|| Kernel::made(engine, shader, bindings, entries)).clone()
    }

    fn made(engine: &Engine, shader: &Shader, bindings: &[Bound], entries: &[&str]) -> Kernel {
        let device = &engine.device;
        let label = shader.name;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(shader.source.as_str().into()),
        });
        let entry = |(n, bound): (usize, &Bound)| wgpu::BindGroupLayoutEntry {
            binding: n as u32,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match bound {
                    Bound::Uniform | Bound::Slot => wgpu::BufferBindingType::Uniform,
                    Bound::Read => wgpu::BufferBindingType::Storage { read_only: true },
                    Bound::Written => wgpu::BufferBindingType::Storage { read_only: false },
                },
                has_dynamic_offset: *bound == Bound::Slot,
                min_binding_size: None,
            },
            count: None,
        };
        let list: Vec<_> = bindings.iter().enumerate().map(entry).collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &list,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |entry: &&str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let pipelines = entries.iter().map(pipeline).collect();
        Kernel { layout, pipelines, slotted: bindings.contains(&Bound::Slot), label }
    }

    fn of_pass(engine: &Engine, shader: &Shader, pass: &Pass, entries: &[&str]) -> Kernel {
        Kernel::new(engine, shader, &pass.bindings(false), entries)
    }

    /// Binds (buffer, offset, bytes) in the order of the columns.
    pub fn bind(&self, engine: &Engine, buffers: &[Binding]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .enumerate()
            .map(|(n, b)| wgpu::BindGroupEntry {
                binding: n as u32,
                resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: b.buffer,
                    offset: b.offset,
                    size: wgpu::BufferSize::new(b.bytes),
                }),
            })
            .collect();
        engine.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Records one dispatch of a kernel that has several entries.
    pub fn record_entry(
        &self,
        pass: &mut wgpu::ComputePass,
        group: &wgpu::BindGroup,
        entry: usize,
        [x, y]: [u32; 2],
    ) {
        pass.set_bind_group(0, group, &[0]);
        pass.set_pipeline(&self.pipelines[entry]);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Records the dispatches of a pass, with these numbers of workgroups and the slot that is bound.
    pub fn record(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, groups: &[[u32; 2]]) {
        pass.set_bind_group(0, group, &[0]);
        for (pipeline, [x, y]) in self.pipelines.iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(*x, *y, 1);
        }
    }

    /// Records these entries, one after the other, each over as many workgroups.
    pub fn record_entries(
        &self,
        pass: &mut wgpu::ComputePass,
        group: &wgpu::BindGroup,
        entries: &[usize],
        [x, y]: [u32; 2],
    ) {
        pass.set_bind_group(0, group, &[0]);
        for &entry in entries {
            pass.set_pipeline(&self.pipelines[entry]);
            pass.dispatch_workgroups(x, y, 1);
        }
    }
}

/// How a kernel sees a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bound {
    Uniform,
    /// A uniform that is one of several in a buffer, chosen when it is bound.
    Slot,
    Read,
    Written,
}

/// Part of a buffer, bound.
#[derive(Clone, Copy)]
pub struct Binding<'a> {
    pub buffer: &'a wgpu::Buffer,
    pub offset: u64,
    pub bytes: u64,
}

impl<'a> Binding<'a> {
    /// All of it.
    pub fn whole(buffer: &'a wgpu::Buffer) -> Binding<'a> {
        Binding { buffer, offset: 0, bytes: buffer.size() }
    }
    /// The first `bytes`, at least one vec4u of them.
    pub fn new(buffer: &'a wgpu::Buffer, bytes: u64) -> Binding<'a> {
        Binding { buffer, offset: 0, bytes: bytes.max(16).next_multiple_of(4) }
    }
}

/// Workgroups for so many invocations: more than fit in one dimension go on in the second.
pub fn groups(invocations: u64, workgroup: u32) -> [u32; 2] {
    const ALONG_X: u64 = 32_768;
    let groups = invocations.div_ceil(workgroup as u64);
    [groups.min(ALONG_X) as u32, groups.div_ceil(ALONG_X) as u32]
}

/// Workgroups of the three dispatches of a prefix sum.
pub fn scan_groups(count: u64, tile: u32) -> [[u32; 2]; 3] {
    let tiles = groups(count, tile);
    [tiles, [1, 1], tiles]
}

/// Entries of the kernel `link`: what contexts see, then what children hang on.
pub const LINK_ENTRIES: [&str; 6] = ["start", "link", "settle", "jump", "unhang", "rehang"];

/// Dispatches that fill the links which contexts follow, each as the entry that it calls: jumps as often as a link may
/// have to double.
pub fn link_calls(n: u64, branches: bool, ignoring: bool) -> Vec<usize> {
    let settled = branches.then_some(2);
    let jumps = if branches || ignoring { rounds(n) } else { 0 };
    [0, 1].into_iter().chain(settled).chain(std::iter::repeat_n(3, jumps)).collect()
}

/// Those that say what children hang on.
pub fn hang_calls(n: u64, unhangs: bool) -> Vec<usize> {
    std::iter::once(4).chain(std::iter::repeat_n(5, if unhangs { rounds(n) } else { 0 })).collect()
}

/// Rounds in which links that double reach through so many modules.
fn rounds(n: u64) -> usize {
    (u64::BITS - n.leading_zeros()) as usize + 1
}

/// Whether the device binds what the expressions of every stage read.
///
/// # Errors
/// [`Error::Uniforms`].
pub fn fits(engine: &Engine, plan: &Plan) -> Result<(), Error> {
    let stages = plan.tables.rule_sets.iter().flat_map(|set| &set.stages);
    // However long it is does not depend on the values.
    let words = stages.map(|stage| plan.environment(stage, &[], &Given::default()).len());
    buffers::fits_uniform(engine, 4 * words.max().unwrap_or(0) as u64)
}

/// The kernels of a stage, and its environment.
pub struct StageKernels {
    pub measure: Option<Kernel>,
    pub link: Option<Kernel>,
    pub turtle: Option<Kernel>,
    pub match_modules: Kernel,
    pub claim: Option<Kernel>,
    pub count: Kernel,
    pub emit: Kernel,
    pub environment: wgpu::Buffer,
}

impl StageKernels {
    pub fn new(
        engine: &Engine,
        plan: &Plan,
        id: StageId,
        environment: &[u32],
    ) -> Result<StageKernels, Error> {
        let shaders = codegen::stage_edited(plan, id, engine.tuning(), engine.edit.as_ref())?;
        let buffer = buffers::uniform(engine, "burgeon environment", environment)?;
        let claim = |s: &Shader| Kernel::of_pass(engine, s, &step::CLAIM, &["reduce", "spine", "claim"]);
        let measure = |s: &Shader| Kernel::of_pass(engine, s, &step::MEASURE, &["measure"]);
        let link = |s: &Shader| Kernel::of_pass(engine, s, &step::LINK, &LINK_ENTRIES);
        let linked = plan.tables.layout.link.is_some();
        let of_pass = |s: &Shader, pass: &Pass| Kernel::new(engine, s, &pass.bindings(linked), &[pass.name]);
        let turtle = |s: &Shader| match plan.tables.layout.link {
            None => Kernel::of_pass(engine, s, &step::TURTLE, &["reduce", "spine", "turtle"]),
            Some(_) => {
                let entries = ["begin", "away", "back", "turtle_linked"];
                Kernel::of_pass(engine, s, &step::TURTLE_LINKED, &entries)
            }
        };
        Ok(StageKernels {
            measure: shaders.measure.as_ref().map(measure),
            link: shaders.link.as_ref().map(link),
            turtle: shaders.turtle.as_ref().map(turtle),
            claim: shaders.claim.as_ref().map(claim),
            match_modules: of_pass(&shaders.match_modules, &step::MATCH),
            count: Kernel::of_pass(engine, &shaders.count, &step::COUNT, &["count"]),
            emit: match plan.tables.layout.is_curve() {
                true => of_pass(&shaders.emit, &step::EMIT_WORD),
                false => Kernel::of_pass(engine, &shaders.emit, &step::EMIT, &["emit"]),
            },
            environment: buffer,
        })
    }
}

/// The kernels that know only the layout.
pub struct SharedKernels {
    pub scan: Kernel,
    pub compact: Kernel,
    pub retire: Kernel,
}

impl SharedKernels {
    pub fn new(engine: &Engine, layout: &Layout) -> Result<SharedKernels, Error> {
        let shaders = codegen::shared_edited(layout, engine.tuning(), engine.edit.as_ref())?;
        Ok(SharedKernels {
            scan: Kernel::of_pass(engine, &shaders.scan, &step::SCAN, &["reduce", "spine", "scan"]),
            compact: Kernel::of_pass(
                engine,
                &shaders.compact,
                &step::COMPACT,
                &["reduce", "spine", "compact"],
            ),
            retire: Kernel::of_pass(engine, &shaders.retire, &step::RETIRE, &["retire"]),
        })
    }
}
