//! A renderer with a wgpu device of its own draws the teapot, tessellated watertight to half a pixel, in a
//! pass of its own. Nothing of the tessellation is read back. `cargo run --release --example own_device`
//! writes `own_device.png`.
mod host; // what a renderer has anyway: the picture, the pipeline, the way to the file

use burgeon::gpu::Engine;
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::io::bpt;
use burgeon::tessellate::{Camera, Level, Options};

const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip: mat4x4f;
struct Seen { @builtin(position) place: vec4f, @location(0) normal: vec3f }
@vertex fn vertex(@location(0) p: vec3f, @location(1) n: vec3f) -> Seen { return Seen(clip * vec4f(p, 1), n); }
@fragment fn fragment(seen: Seen) -> @location(0) vec4f {
    let light = abs(dot(normalize(seen.normal), normalize(vec3f(1, 3, 2))));
    return vec4f(vec3f(0.69, 0.32, 0.15) * (0.1 + 0.9 * light), 1);
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;

    // Once: the patches go to the device. The engine borrows it.
    let nets = bpt::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/teapot.bpt"), false)?;
    let (eye, at, up) = ([2.8, 4.4, 7.4], [0.2, 1.2, 0.0], [0.0, 1.0, 0.0]);
    let camera = Camera::looking(eye, at, up, 35.0, [960.0, 640.0], 0.1);
    let engine = Engine::new(&device, &queue);
    let (level, room) = (Level::pixels(0.5, camera), Capacity::for_vertices(50_000));
    let mut teapot = Tessellator::new(&engine, &nets, &level, &Options::default(), &room)?;
    teapot.warm_up()?; // else the driver may compile in the first frame

    // The renderer's own pipeline: position is at location 0, the normal at 1.
    let surface = host::Surface::new(&device, SHADER, &teapot.vertex_layout().buffers());
    surface.look(&queue, &camera.clip);
    let target = host::Target::new(&device, [960, 640]);

    // Each frame: the tessellation is recorded, then drawn with as many triangles as the device found.
    let mut encoder = device.create_command_encoder(&Default::default());
    teapot.encode(&mut encoder);
    let mut pass = target.begin(&mut encoder);
    pass.set_pipeline(&surface.pipeline);
    pass.set_bind_group(0, &surface.camera, &[]);
    pass.set_vertex_buffer(0, teapot.vertices().slice(..));
    pass.set_index_buffer(teapot.indices().slice(..), wgpu::IndexFormat::Uint32);
    pass.draw_indexed_indirect(teapot.draw_args(), 0);
    drop(pass);
    let shot = target.shoot(&device, &mut encoder);
    let submission = queue.submit([encoder.finish()]);
    shot.save(&device, submission, "own_device.png")
}
