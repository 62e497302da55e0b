//! From a framed scene to pixels, on the device.

use super::Error;
use super::batch::Batch;
use crate::io::png::Image;
use wgpu::{BufferUsages, TextureFormat, TextureUsages, VertexFormat, VertexStepMode};

const SHADER: &str = include_str!("../../wgsl/picture.wgsl");
/// Linear light in the shader, sRGB in the bytes; samples are averaged in linear light.
const COLOR: TextureFormat = TextureFormat::Rgba8UnormSrgb;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;
/// Width and height of the shadow map.
const SHADOW: u32 = 2048;

/// Everything to draw, on the host.
pub(super) struct Scene {
    pub batches: Vec<Batch>,
    /// Two end points each.
    pub lines: Vec<[f32; 6]>,
    pub view: [[f32; 4]; 11],
    /// Is there a ground that shadows fall on?
    pub ground: bool,
}

/// The bytes that one vertex, index or line buffer may have: WebGPU promises 256 MiB, and smaller
/// pieces are kinder to the staging memory.
pub(super) fn buffer_limit(device: &wgpu::Device) -> u64 {
    device.limits().max_buffer_size.min(64 << 20)
}

/// Draws the scene and reads the picture back.
pub(super) fn draw(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    scene: &Scene,
    size: [u32; 2],
) -> Result<Image, Error> {
    let scopes = Scopes::push(device);
    let target = Target::new(device, size);
    submit(device, queue, scene, &target);
    // What went wrong so far explains why the pixels could not be read, so it comes first.
    let pixels = target.read(device);
    scopes.pop()?;
    Ok(Image { width: size[0], height: size[1], pixels: pixels? })
}

/// Catches every kind of error of the device, so that none reaches the handler of its owner.
struct Scopes([wgpu::ErrorScopeGuard; 3]);

impl Scopes {
    fn push(device: &wgpu::Device) -> Scopes {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        Scopes([OutOfMemory, Internal, Validation].map(|filter| device.push_error_scope(filter)))
    }

    /// The error of the first scope that has one, innermost first.
    fn pop(self) -> Result<(), Error> {
        let Scopes([memory, internal, validation]) = self;
        let errors = [
            pollster::block_on(validation.pop()),
            pollster::block_on(internal.pop()),
            pollster::block_on(memory.pop()),
        ];
        match errors.into_iter().flatten().next() {
            Some(error) => Err(Error::Device(error.to_string())),
            None => Ok(()),
        }
    }
}

fn submit(device: &wgpu::Device, queue: &wgpu::Queue, scene: &Scene, target: &Target) {
    let view =
        upload(device, queue, "picture view", BufferUsages::UNIFORM, bytemuck::cast_slice(&scene.view));
    let shadow = texture(device, "picture shadow", DEPTH, 1, [SHADOW; 2], TextureUsages::TEXTURE_BINDING)
        .create_view(&Default::default());
    let pipelines = Pipelines::new(device, &view, &shadow);
    let meshes: Vec<Geometry> =
        scene.batches.iter().map(|batch| Geometry::new(device, queue, batch)).collect();
    let line_length = size_of::<[f32; 6]>();
    let lines: Vec<(wgpu::Buffer, u32)> = scene
        .lines
        .chunks((buffer_limit(device) as usize / line_length).max(1))
        .map(|lines| {
            let bytes = bytemuck::cast_slice(lines);
            (upload(device, queue, "picture lines", BufferUsages::VERTEX, bytes), lines.len() as u32)
        })
        .collect();
    let mut encoder =
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("picture") });
    {
        let mut pass = begin_shadow(&mut encoder, &shadow);
        pass.set_bind_group(0, &pipelines.view, &[]);
        pass.set_pipeline(&pipelines.shadow);
        meshes.iter().for_each(|geometry| geometry.draw(&mut pass));
    }
    {
        let mut pass = target.begin(&mut encoder);
        pass.set_bind_group(0, &pipelines.view, &[]);
        pass.set_bind_group(1, &pipelines.shadows, &[]);
        pass.set_pipeline(&pipelines.background);
        pass.draw(0..3, 0..1);
        if scene.ground {
            pass.set_pipeline(&pipelines.ground);
            pass.draw(0..4, 0..1);
        }
        pass.set_pipeline(&pipelines.surface);
        meshes.iter().for_each(|geometry| geometry.draw(&mut pass));
        pass.set_pipeline(&pipelines.line);
        for (buffer, count) in &lines {
            pass.set_vertex_buffer(0, buffer.slice(..));
            pass.draw(0..6, 0..*count);
        }
    }
    target.copy(&mut encoder);
    queue.submit([encoder.finish()]);
}

fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    usage: BufferUsages,
    bytes: &[u8],
) -> wgpu::Buffer {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.len() as u64,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, bytes);
    buffer
}

/// A batch on the device.
struct Geometry {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    count: u32,
}

impl Geometry {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, batch: &Batch) -> Geometry {
        let (vertices, indices) =
            (bytemuck::cast_slice(&batch.vertices), bytemuck::cast_slice(&batch.indices));
        Geometry {
            vertices: upload(device, queue, "picture vertices", BufferUsages::VERTEX, vertices),
            indices: upload(device, queue, "picture indices", BufferUsages::INDEX, indices),
            count: batch.indices.len() as u32,
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.count, 0, 0..1);
    }
}

struct Pipelines {
    shadow: wgpu::RenderPipeline,
    background: wgpu::RenderPipeline,
    ground: wgpu::RenderPipeline,
    surface: wgpu::RenderPipeline,
    line: wgpu::RenderPipeline,
    /// Group 0: the record `View`.
    view: wgpu::BindGroup,
    /// Group 1: the shadow map and its sampler.
    shadows: wgpu::BindGroup,
}

impl Pipelines {
    fn new(device: &wgpu::Device, view: &wgpu::Buffer, shadow: &wgpu::TextureView) -> Pipelines {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("picture.wgsl"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let [view_layout, shadows_layout] = group_layouts(device);
        let layout = |label, bind_group_layouts: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts,
                immediate_size: 0,
            })
        };
        let alone = layout("picture shadow", &[Some(&view_layout)]);
        let both = layout("picture", &[Some(&view_layout), Some(&shadows_layout)]);
        let new = Builder { device, module: &module, layout: &both };
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("picture shadow"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        Pipelines {
            shadow: Builder { layout: &alone, ..new }.shadow(),
            background: new.flat("background", wgpu::PrimitiveTopology::TriangleList, None),
            ground: new.flat(
                "ground",
                wgpu::PrimitiveTopology::TriangleStrip,
                Some(wgpu::BlendState::ALPHA_BLENDING),
            ),
            surface: new.solid("surface", VERTEX),
            line: new.solid("line", LINE),
            view: device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("picture view"),
                layout: &view_layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }],
            }),
            shadows: device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("picture shadows"),
                layout: &shadows_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(shadow) },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&sampler) },
                ],
            }),
        }
    }
}

/// Of the groups 0 and 1 of the shader.
fn group_layouts(device: &wgpu::Device) -> [wgpu::BindGroupLayout; 2] {
    let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
    };
    let view = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let map = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
    let fragment = wgpu::ShaderStages::FRAGMENT;
    [
        layout("picture view", &[entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, view)]),
        layout("picture shadows", &[entry(0, fragment, map), entry(1, fragment, sampler)]),
    ]
}

/// What a pipeline reads from its buffer: so many times three floats, once a vertex or an instance.
#[derive(Clone, Copy)]
struct Input {
    triples: u64,
    step: VertexStepMode,
}

/// A [`Vertex`](super::batch::Vertex).
const VERTEX: Input = Input { triples: 3, step: VertexStepMode::Vertex };
/// Two end points.
const LINE: Input = Input { triples: 2, step: VertexStepMode::Instance };

/// What the pipelines have in common.
#[derive(Clone, Copy)]
struct Builder<'a> {
    device: &'a wgpu::Device,
    module: &'a wgpu::ShaderModule,
    layout: &'a wgpu::PipelineLayout,
}

impl Builder<'_> {
    /// Behind everything, over the whole target, from no buffer at all.
    fn flat(
        &self,
        name: &str,
        topology: wgpu::PrimitiveTopology,
        blend: Option<wgpu::BlendState>,
    ) -> wgpu::RenderPipeline {
        let color = wgpu::ColorTargetState { blend, ..COLOR.into() };
        self.pipeline(name, None, topology, Some(color), None)
    }

    /// Hidden by what is nearer.
    fn solid(&self, name: &str, input: Input) -> wgpu::RenderPipeline {
        let depth = Some(wgpu::DepthBiasState::default());
        self.pipeline(name, Some(input), wgpu::PrimitiveTopology::TriangleList, Some(COLOR.into()), depth)
    }

    /// Depth alone, set back so that a surface does not shade itself.
    fn shadow(&self) -> wgpu::RenderPipeline {
        let bias = wgpu::DepthBiasState { constant: 2, slope_scale: 2.0, clamp: 0.0 };
        let topology = wgpu::PrimitiveTopology::TriangleList;
        self.pipeline("shadow", Some(VERTEX), topology, None, Some(bias))
    }

    /// The pipeline of the entry points `name`_vertex and, with a color, `name`_fragment; `input` says
    /// what it reads, if anything; without `depth` nothing hides it.
    fn pipeline(
        &self,
        name: &str,
        input: Option<Input>,
        topology: wgpu::PrimitiveTopology,
        color: Option<wgpu::ColorTargetState>,
        depth: Option<wgpu::DepthBiasState>,
    ) -> wgpu::RenderPipeline {
        let format = VertexFormat::Float32x3;
        let attributes: [_; 3] = std::array::from_fn(|triple| wgpu::VertexAttribute {
            format,
            offset: triple as u64 * format.size(),
            shader_location: triple as u32,
        });
        let layout = |Input { triples, step }| wgpu::VertexBufferLayout {
            array_stride: triples * format.size(),
            step_mode: step,
            attributes: &attributes[..triples as usize],
        };
        let buffers: Vec<_> = input.map(|input| Some(layout(input))).into_iter().collect();
        let compare =
            if depth.is_some() { wgpu::CompareFunction::Less } else { wgpu::CompareFunction::Always };
        let fragment = format!("{name}_fragment");
        let targets = [color];
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&format!("picture {name}")),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(&format!("{name}_vertex")),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState { topology, ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(depth.is_some()),
                depth_compare: Some(compare),
                stencil: wgpu::StencilState::default(),
                bias: depth.unwrap_or_default(),
            }),
            multisample: wgpu::MultisampleState {
                count: if targets[0].is_some() { SAMPLES } else { 1 },
                ..Default::default()
            },
            fragment: targets[0].is_some().then_some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(&fragment),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

fn texture(
    device: &wgpu::Device,
    label: &str,
    format: TextureFormat,
    sample_count: u32,
    size: [u32; 2],
    usage: TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(size),
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

fn begin_shadow<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    shadow: &wgpu::TextureView,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("picture shadow"),
        color_attachments: &[],
        depth_stencil_attachment: Some(cleared_depth(shadow, wgpu::StoreOp::Store)),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn cleared_depth(
    view: &wgpu::TextureView,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

/// What is drawn into, and the buffer that the host reads.
struct Target {
    size: [u32; 2],
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::Texture,
    readback: wgpu::Buffer,
}

impl Target {
    fn new(device: &wgpu::Device, size: [u32; 2]) -> Target {
        let attachment = |label, format| {
            texture(device, label, format, SAMPLES, size, TextureUsages::empty())
                .create_view(&Default::default())
        };
        Target {
            size,
            samples: attachment("picture samples", COLOR),
            depth: attachment("picture depth", DEPTH),
            resolved: texture(device, "picture", COLOR, 1, size, TextureUsages::COPY_SRC),
            readback: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("picture readback"),
                size: u64::from(row_bytes(size)) * u64::from(size[1]),
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    fn begin<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let resolved = self.resolved.create_view(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(&resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(cleared_depth(&self.depth, wgpu::StoreOp::Discard)),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }

    fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes(self.size)),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &self.readback, layout };
        encoder.copy_texture_to_buffer(self.resolved.as_image_copy(), to, extent(self.size));
    }

    /// Waits for the device and takes the pixels, without the padding of the rows.
    fn read(&self, device: &wgpu::Device) -> Result<Vec<u8>, Error> {
        let (sender, receiver) = std::sync::mpsc::channel();
        self.readback.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver waits below, unless the poll failed first.
            let _ = sender.send(result);
        });
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(failed)?;
        receiver.try_recv().map_err(failed)?.map_err(failed)?;
        let bytes = self.readback.get_mapped_range(..).map_err(failed)?;
        let row = self.size[0] as usize * 4;
        Ok(bytes.chunks(row_bytes(self.size) as usize).flat_map(|padded| &padded[..row]).copied().collect())
    }
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Device(error.to_string())
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}

/// Rows in a buffer start at multiples of 256 bytes.
fn row_bytes([width, _]: [u32; 2]) -> u32 {
    (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}
