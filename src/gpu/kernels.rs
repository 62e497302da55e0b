//! Pipelines and bind groups, made from the list of passes.

use super::{Engine, Error};
use crate::codegen::{self, Shader};
use crate::plan::Plan;
use crate::plan::derive::StageId;
use crate::plan::layout::Layout;
use crate::plan::step::{self, Column, Pass};

/// One compute pipeline; `stages` of it where a pass takes several dispatches.
#[derive(Debug)]
pub struct Kernel {
    pub layout: wgpu::BindGroupLayout,
    pub pipelines: Vec<wgpu::ComputePipeline>,
    label: &'static str,
}

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
        Kernel { layout, pipelines, label }
    }

    fn of_pass(engine: &Engine, shader: &Shader, pass: &Pass, entries: &[&str]) -> Kernel {
        Kernel::new(engine, shader, &bindings(pass), entries)
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

    /// Records the dispatches of a pass, with these numbers of workgroups and the slot that is bound.
    pub fn record(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, groups: &[[u32; 2]]) {
        pass.set_bind_group(0, group, &[0]);
        for (pipeline, [x, y]) in self.pipelines.iter().zip(groups) {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(*x, *y, 1);
        }
    }
}

/// How a kernel sees a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

fn bindings(pass: &Pass) -> Vec<(Column, bool)> {
    let reads = pass.reads.iter().map(|c| (*c, false));
    reads.chain(pass.writes.iter().map(|c| (*c, true))).collect()
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

/// The kernels of a stage, and its environment.
pub struct StageKernels {
    pub measure: Option<Kernel>,
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
        let buffer = engine.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("burgeon environment"),
            size: environment.len() as u64 * 4,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        engine.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(environment));
        let claim = |s: &Shader| Kernel::of_pass(engine, s, &step::CLAIM, &["reduce", "spine", "claim"]);
        let measure = |s: &Shader| Kernel::of_pass(engine, s, &step::MEASURE, &["measure"]);
        Ok(StageKernels {
            measure: shaders.measure.as_ref().map(measure),
            claim: shaders.claim.as_ref().map(claim),
            match_modules: Kernel::of_pass(engine, &shaders.match_modules, &step::MATCH, &["match_modules"]),
            count: Kernel::of_pass(engine, &shaders.count, &step::COUNT, &["count"]),
            emit: match plan.tables.layout.is_curve() {
                true => Kernel::of_pass(engine, &shaders.emit, &step::EMIT_WORD, &["emit_word"]),
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
