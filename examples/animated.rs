//! Moving patches under a moving camera: a compute pass of the example's own bends the teapot's control
//! points on the device, every frame is tessellated anew and drawn, and the host learns the number of
//! triangles some frames late. The room is too small at first, and grows.
//!
//!     cargo run --release --example animated [-- --frames N --out FOLDER]

mod host;

use burgeon::gpu::Engine;
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::io::bpt;
use burgeon::tessellate::{Camera, Level, Options};
use std::collections::VecDeque;
use std::error::Error;
use std::f32::consts::TAU;
use std::path::PathBuf;
use std::time::Instant;
use wgpu::BufferUsages;
use wgpu::util::DeviceExt;

/// The teapot turns about the vertical and leans. Where a point goes depends on the point alone, so that
/// points which were equal stay so, and patches that met still meet.
const SWAY: &str = "
@group(0) @binding(0) var<storage> rest: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> points: array<vec4f>;
@group(0) @binding(2) var<uniform> phase: f32;
@compute @workgroup_size(64) fn sway(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&rest)) { return; }
    let p = rest[id.x];
    let turn = 0.3 * sin(2.0 * phase) * (p.y - 1.2);
    let lean = 0.1 * sin(phase) * p.y;
    let x = cos(turn) * p.x - sin(turn) * p.z;
    let z = sin(turn) * p.x + cos(turn) * p.z;
    points[id.x] = vec4f(x + sin(lean) * p.y, cos(lean) * p.y, z, p.w);
}";

/// Shaded half by the surface's normal and half by the triangle's, so that the triangles are seen.
const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip: mat4x4f;
struct Seen { @builtin(position) place: vec4f, @location(0) p: vec3f, @location(1) n: vec3f }
@vertex fn vertex(@location(0) p: vec3f, @location(1) n: vec3f) -> Seen {
    return Seen(clip * vec4f(p, 1), p, n);
}
@fragment fn fragment(seen: Seen) -> @location(0) vec4f {
    let sun = normalize(vec3f(1, 3, 2));
    let flat = abs(dot(normalize(cross(dpdx(seen.p), dpdy(seen.p))), sun));
    let light = 0.5 * (abs(dot(normalize(seen.n), sun)) + flat);
    return vec4f(vec3f(0.12, 0.38, 0.36) * (0.1 + 0.9 * light), 1);
}";

const SIZE: [u32; 2] = [640, 480];
/// Frames that may be under way before the host waits for the first.
const AHEAD: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let (frames, folder) = arguments()?;
    std::fs::create_dir_all(&folder)?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;

    let nets = bpt::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/teapot.bpt"), false)?;
    let engine = Engine::new(&device, &queue);
    // Too little, on purpose.
    let room = Capacity { nodes: 400, vertices: 400, indices: 2400, modules: 0 };
    let mut teapot = Tessellator::new(&engine, &nets, &level(&camera(0.0)), &Options::default(), &room)?;
    let points: Vec<[f32; 4]> = nets.iter().flat_map(|net| net.points.iter().copied()).collect();
    let sway = Sway::new(&device, &points, teapot.points());
    let surface = host::Surface::new(&device, SHADER, &teapot.vertex_layout().buffers());
    let target = host::Target::new(&device, SIZE);

    let mut under_way = VecDeque::new();
    for frame in 0..frames {
        if let Some(status) = teapot.status().filter(|status| !status.complete()) {
            // All buffers but the control points are new; what was drawn is in them.
            println!("frame {frame:3}: grows, as frame {} had too little room", status.frame - 1);
            teapot.set_capacity(&Capacity::grown(&status))?;
        }

        let begun = Instant::now();
        let time = frame as f32 / frames as f32;
        let camera = camera(time);
        teapot.set_level(&level(&camera))?;
        surface.look(&queue, &camera.clip);
        let mut encoder = device.create_command_encoder(&Default::default());
        sway.encode(&queue, &mut encoder, TAU * time);
        teapot.encode(&mut encoder);
        let mut pass = target.begin(&mut encoder);
        pass.set_pipeline(&surface.pipeline);
        pass.set_bind_group(0, &surface.camera, &[]);
        pass.set_vertex_buffer(0, teapot.vertices().slice(..));
        pass.set_index_buffer(teapot.indices().slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed_indirect(teapot.draw_args(), 0);
        drop(pass);
        let recorded = begun.elapsed();
        let shot = target.shoot(&device, &mut encoder);
        let submission = queue.submit([encoder.finish()]);

        let known = teapot.status().map_or("no frame is known yet".into(), |status| {
            format!("{} triangles in frame {}", status.indices / 3, status.frame - 1)
        });
        println!("frame {frame:3}: recorded in {:.2} ms; {known}", recorded.as_secs_f64() * 1e3);
        under_way.push_back((shot, submission, folder.join(format!("{frame:03}.png"))));
        if under_way.len() > AHEAD
            && let Some((shot, submission, path)) = under_way.pop_front()
        {
            shot.save(&device, submission, path)?;
        }
    }
    under_way.into_iter().try_for_each(|(shot, submission, path)| shot.save(&device, submission, path))
}

/// The frames to make, and where they go.
fn arguments() -> Result<(u32, PathBuf), Box<dyn Error>> {
    let (mut frames, mut folder) = (48, PathBuf::from("out/animated"));
    let mut given = std::env::args().skip(1);
    while let Some(name) = given.next() {
        let value = given.next().ok_or_else(|| format!("{name} needs a value"))?;
        match name.as_str() {
            "--frames" => frames = value.parse()?,
            "--out" => folder = value.into(),
            _ => return Err(format!("what is {name}? there are --frames N and --out FOLDER").into()),
        }
    }
    Ok((frames, folder))
}

/// Comes near, and goes again.
fn camera(time: f32) -> Camera {
    let distance = 7.0 + 1.8 * (TAU * time).cos();
    let (sin, cos) = (0.4 + 0.6 * (TAU * time).sin()).sin_cos();
    let eye = [distance * sin, 1.6 + 0.35 * distance, distance * cos];
    Camera::looking(eye, [0.2, 1.3, 0.0], [0.0, 1.0, 0.0], 38.0, SIZE.map(|n| n as f32), 0.1)
}

/// A cell that was split stays so until its error is a quarter below the pixel: no flicker at the limit.
fn level(camera: &Camera) -> Level {
    Level { hysteresis: 0.25, ..Level::pixels(1.0, *camera) }
}

/// The compute pass that moves the control points.
struct Sway {
    pipeline: wgpu::ComputePipeline,
    phase: wgpu::Buffer,
    group: wgpu::BindGroup,
    workgroups: u32,
}

impl Sway {
    fn new(device: &wgpu::Device, points: &[[f32; 4]], moved: &wgpu::Buffer) -> Sway {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("sway"),
            source: wgpu::ShaderSource::Wgsl(SWAY.into()),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("sway"),
            layout: None,
            module: &module,
            entry_point: Some("sway"),
            compilation_options: Default::default(),
            cache: None,
        });
        let buffer = |label, contents, usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let rest = buffer("rest", bytemuck::cast_slice(points), BufferUsages::STORAGE);
        let phase = buffer("phase", &[0; 16], BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let bound = [&rest, moved, &phase];
        let entry =
            |n: usize| wgpu::BindGroupEntry { binding: n as u32, resource: bound[n].as_entire_binding() };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sway"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[0, 1, 2].map(entry),
        });
        Sway { pipeline, phase, group, workgroups: (points.len() as u32).div_ceil(64) }
    }

    fn encode(&self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder, phase: f32) {
        queue.write_buffer(&self.phase, 0, bytemuck::bytes_of(&phase));
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(self.workgroups, 1, 1);
    }
}
