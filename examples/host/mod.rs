//! What any renderer has, in small, for the examples of embedding: a picture to draw into, a pipeline for
//! surfaces with a camera, and a way to a `.png`.

use burgeon::io::png::{self, Image};
use burgeon::io::write_atomically;
use burgeon::wgpu;
use std::error::Error;
use std::path::Path;
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

/// Of the pictures: linear light in the shader, sRGB in the bytes.
pub const COLOR: TextureFormat = TextureFormat::Rgba8UnormSrgb;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;
const SKY: wgpu::Color = wgpu::Color { r: 0.79, g: 0.82, b: 0.86, a: 1.0 };

/// A picture of four samples a pixel, with a depth buffer.
pub struct Target {
    pub color: wgpu::Texture,
    view: wgpu::TextureView,
    samples: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Target {
    /// The width must be a multiple of 64, so that its rows may be copied as they are.
    pub fn new(device: &wgpu::Device, [width, height]: [u32; 2]) -> Target {
        let texture = |format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("target"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let color = texture(COLOR, 1, TextureUsages::COPY_SRC);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Target {
            view: view(&color),
            samples: view(&texture(COLOR, SAMPLES, TextureUsages::empty())),
            depth: view(&texture(DEPTH, SAMPLES, TextureUsages::empty())),
            color,
        }
    }

    /// Begins a pass on an empty picture.
    pub fn begin<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surface"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.samples,
                depth_slice: None,
                resolve_target: Some(&self.view),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(SKY), store: wgpu::StoreOp::Discard },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        })
    }

    /// Records that the picture is to be copied for the host.
    pub fn shoot(&self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder) -> Shot {
        let size = self.color.size();
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shot"),
            size: u64::from(size.width) * u64::from(size.height) * 4,
            usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size.width * 4),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(self.color.as_image_copy(), to, size);
        Shot { buffer, width: size.width, height: size.height }
    }
}

/// A picture on its way to the host.
pub struct Shot {
    buffer: wgpu::Buffer,
    width: u32,
    height: u32,
}

impl Shot {
    /// Waits for the submission that it was recorded for, and writes it.
    pub fn save(
        self,
        device: &wgpu::Device,
        submission: wgpu::SubmissionIndex,
        path: impl AsRef<Path>,
    ) -> Result<(), Box<dyn Error>> {
        self.buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        device.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None })?;
        let pixels = self.buffer.get_mapped_range(..)?.to_vec();
        let image = Image { width: self.width, height: self.height, pixels };
        Ok(write_atomically(path.as_ref(), |writer| png::write(writer, &image))?)
    }
}

/// A pipeline of the entry points `vertex` and `fragment`, whose binding 0 of group 0 is the camera, a
/// `mat4x4f`.
pub struct Surface {
    pub pipeline: wgpu::RenderPipeline,
    pub camera: wgpu::BindGroup,
    clip: wgpu::Buffer,
}

impl Surface {
    pub fn new(
        device: &wgpu::Device,
        shader: &str,
        vertices: &[Option<wgpu::VertexBufferLayout>],
    ) -> Surface {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("surface"),
            source: wgpu::ShaderSource::Wgsl(shader.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("surface"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: vertices,
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(COLOR.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let clip = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("camera"),
            size: 64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let camera = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: clip.as_entire_binding() }],
        });
        Surface { pipeline, camera, clip }
    }

    /// For the next submission.
    pub fn look(&self, queue: &wgpu::Queue, clip: &[[f32; 4]; 4]) {
        queue.write_buffer(&self.clip, 0, bytemuck::bytes_of(clip));
    }
}
