//! Pipelines and bind groups, made from the list of passes.

use super::{Engine, Error, buffers};
use crate::codegen::{self, Shader};
use crate::plan::columns::Stored;
use crate::plan::derive::StageId;
use crate::plan::program::{Over, Work};
use crate::plan::step::{Column, Pass};
use crate::plan::{Given, Plan};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// One compute pipeline; `stages` of it where a pass takes several dispatches.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
    /// Their entry points.
    entries: Vec<&'static str>,
    /// Whether one of its bindings is a slot.
    pub slotted: bool,
    label: &'static str,
}

/// Kernels by their source, bindings and entries.
pub type Kept = Arc<Mutex<HashMap<(String, Vec<Bound>, Vec<&'static str>), Kernel>>>;

impl Kernel {
    /// A kernel whose bindings are these columns: (column, written).
    pub fn new(
        engine: &Engine,
        shader: &Shader,
        bindings: &[(Column, bool)],
        entries: &[&'static str],
    ) -> Kernel {
        let bound = bindings.iter().map(|&(column, written)| match column {
            Column::Extent => Bound::Slot,
            Column::Environment => Bound::Uniform,
            _ if written => Bound::Written,
            _ => Bound::Read,
        });
        Kernel::with_bindings(engine, shader, &bound.collect::<Vec<_>>(), entries)
    }

    /// A kernel with these bindings, numbered from 0.
    pub fn with_bindings(
        engine: &Engine,
        shader: &Shader,
        bindings: &[Bound],
        entries: &[&'static str],
    ) -> Kernel {
        let Some(kept) = &engine.kept else { return Kernel::made(engine, shader, bindings, entries) };
        let key = (shader.source.clone(), bindings.to_vec(), entries.to_vec());
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.entry(key).or_insert_with(|| Kernel::made(engine, shader, bindings, entries)).clone()
    }

    fn made(engine: &Engine, shader: &Shader, bindings: &[Bound], entries: &[&'static str]) -> Kernel {
        let device = &engine.device;
        let label = shader.name;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(shader.source.as_str().into()),
        });
        let binding = |(n, bound): (usize, &Bound)| wgpu::BindGroupLayoutEntry {
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
        let list: Vec<_> = bindings.iter().enumerate().map(binding).collect();
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
        Kernel {
            layout,
            pipelines,
            entries: entries.to_vec(),
            slotted: bindings.contains(&Bound::Slot),
            label,
        }
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

    /// Records what a pass of a stage calls over a word of `n` elements; `dispatch` says over how many workgroups.
    pub fn run(
        &self,
        pass: &mut wgpu::ComputePass,
        (group, slot): (&wgpu::BindGroup, u32),
        work: &Work,
        n: u64,
        dispatch: impl Fn(&mut wgpu::ComputePass, Over),
    ) {
        pass.set_bind_group(0, group, &[slot]);
        for call in &work.calls {
            for entry in call.dispatches(n) {
                let Some(at) = self.entries.iter().position(|own| *own == entry) else { continue };
                pass.set_pipeline(&self.pipelines[at]);
                dispatch(pass, call.over);
            }
        }
    }

    /// Records the dispatches of a pass, with these numbers of workgroups and the slot that is bound.
    pub fn record(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, groups: &[[u32; 2]]) {
        pass.set_bind_group(0, group, &[0]);
        for (pipeline, [x, y]) in self.pipelines.iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(*x, *y, 1);
        }
    }
}

/// What a device calls the buffer of a column.
pub fn label(column: Column) -> &'static str {
    use Stored::{Nets, Records};
    match column {
        Column::Before(Records) | Column::After(Records) | Column::Finished(Records) => "burgeon records",
        Column::Before(Nets) | Column::After(Nets) | Column::Finished(Nets) => "burgeon nets",
        Column::Attributes => "burgeon attributes",
        Column::Rules => "burgeon rules",
        Column::Counts => "burgeon counts",
        Column::Offsets => "burgeon offsets",
        Column::Sums => "burgeon sums",
        Column::Retired => "burgeon retired",
        Column::RetiredSums => "burgeon retired sums",
        Column::Links => "burgeon links",
        Column::TileMotions => "burgeon motions of tiles",
        Column::Motions => "burgeon motions",
        Column::Carried => "burgeon turtle",
        Column::Status => "burgeon status",
        Column::Environment => "burgeon environment",
        Column::Extent => "burgeon extents",
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

/// Whether the device binds what the expressions of every stage read.
///
/// # Errors
/// [`Error::Uniforms`].
pub fn fits(engine: &Engine, plan: &Plan) -> Result<(), Error> {
    let stages = plan.stages().into_iter().map(|id| id.of(plan));
    // However long it is does not depend on the values.
    let words = stages.map(|stage| plan.environment(stage, &[], &Given::default()).len());
    buffers::fits_uniform(engine, 4 * words.max().unwrap_or(0) as u64)
}

/// The kernels of a plan's stages. Those that know only the layout are made once for all.
pub struct Kernels {
    engine: Engine,
    shared: HashMap<&'static str, Kernel>,
    stages: HashMap<StageId, StageKernels>,
}

/// The kernels that depend on the rules of a stage, by their files, and its environment.
struct StageKernels {
    own: HashMap<&'static str, Kernel>,
    environment: wgpu::Buffer,
}

impl Kernels {
    pub fn new(engine: &Engine) -> Kernels {
        Kernels { engine: engine.clone(), shared: HashMap::new(), stages: HashMap::new() }
    }

    /// Whether those of this stage are there.
    pub fn has(&self, id: StageId) -> bool {
        self.stages.contains_key(&id)
    }

    /// Makes those that these passes of a stage run.
    ///
    /// # Errors
    /// [`Error::Uniforms`] for an environment that the device does not bind.
    pub fn compile<'w>(
        &mut self,
        plan: &Plan,
        id: StageId,
        environment: &[u32],
        works: impl Iterator<Item = &'w Work>,
    ) -> Result<(), Error> {
        let engine = &self.engine;
        let environment = buffers::uniform(engine, "burgeon environment", environment)?;
        let works: Vec<&Work> = works.collect();
        let mut own: HashMap<&'static str, Kernel> = HashMap::new();
        for work in &works {
            let row = work.pass.row();
            if own.contains_key(row.kernel) || self.shared.contains_key(row.kernel) {
                continue;
            }
            let shader = codegen::kernel(plan, id, work, engine.tuning(), engine.edit.as_ref())?;
            // Some passes are further entries of the same kernel.
            let same = works.iter().filter(|other| other.pass.row().kernel == row.kernel);
            let mut entries: Vec<&'static str> = Vec::new();
            for entry in same.flat_map(|other| &other.calls).flat_map(|call| call.entries) {
                if !entries.contains(entry) {
                    entries.push(entry);
                }
            }
            let kernel = Kernel::new(engine, &shader, &work.bindings, &entries);
            if row.of_rules { &mut own } else { &mut self.shared }.insert(row.kernel, kernel);
        }
        self.stages.insert(id, StageKernels { own, environment });
        Ok(())
    }

    /// The kernel of a pass of a stage that was compiled.
    pub fn of(&self, id: StageId, pass: Pass) -> &Kernel {
        let name = pass.row().kernel;
        self.stages[&id].own.get(name).unwrap_or_else(|| &self.shared[name])
    }

    pub fn environment(&self, id: StageId) -> Binding<'_> {
        Binding::whole(&self.stages[&id].environment)
    }

    /// Writes the environments of all stages that there are.
    pub fn set_environments(&self, words: impl Fn(StageId) -> Vec<u32>) {
        for (id, kernels) in &self.stages {
            self.engine.queue.write_buffer(&kernels.environment, 0, bytemuck::cast_slice(&words(*id)));
        }
    }
}
