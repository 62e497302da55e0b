//! Beside another library on the same device: burgeon tessellates the teapot, the host draws it, and egui puts
//! its panel on top, all in one encoder. The panel's numbers come from the tessellator, some frames late.
//!
//!     cargo run --release --manifest-path examples/beside_egui/Cargo.toml [-- FILE.png]

#[path = "../../host/mod.rs"]
mod host;

use burgeon::gpu::Engine;
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::io::bpt;
use burgeon::tessellate::{Camera, Level, Options};
use burgeon::wgpu;
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};
use std::error::Error;
use std::time::Instant;

const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip: mat4x4f;
struct Seen { @builtin(position) place: vec4f, @location(0) p: vec3f, @location(1) n: vec3f }
@vertex fn vertex(@location(0) p: vec3f, @location(1) n: vec3f) -> Seen {
    return Seen(clip * vec4f(p, 1), p, n);
}
@fragment fn fragment(seen: Seen) -> @location(0) vec4f {
    let sun = normalize(vec3f(1, 3, 2));
    let flat = abs(dot(normalize(cross(dpdx(seen.p), dpdy(seen.p))), sun));
    let light = 0.3 * abs(dot(normalize(seen.n), sun)) + 0.7 * flat;
    return vec4f(vec3f(0.69, 0.32, 0.15) * (0.1 + 0.9 * light), 1);
}";

const SIZE: [u32; 2] = [960, 640];

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or("beside_egui.png".into());
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    let target = host::Target::new(&device, SIZE);

    let nets = bpt::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../data/teapot.bpt"), false)?;
    let (eye, at, up) = ([3.2, 5.0, 8.4], [-0.3, 1.4, 0.0], [0.0, 1.0, 0.0]);
    let camera = Camera::looking(eye, at, up, 35.0, SIZE.map(|n| n as f32), 0.1);
    let mut pixels = 4.0;
    let engine = Engine::new(&device, &queue);
    let (level, room) = (Level::pixels(pixels, camera), Capacity::for_vertices(5_000));
    let mut teapot = Tessellator::new(&engine, &nets, &level, &Options::default(), &room)?;
    teapot.warm_up()?; // else the driver may compile in the first frame
    let surface = host::Surface::new(&device, SHADER, &teapot.vertex_layout().buffers());
    surface.look(&queue, &camera.clip);

    let context = egui::Context::default();
    context.set_pixels_per_point(1.5);
    let mut renderer = Renderer::new(&device, host::COLOR, RendererOptions::default());
    let screen = ScreenDescriptor { size_in_pixels: SIZE, pixels_per_point: 1.5 };
    let view = target.color.create_view(&Default::default());
    let mut recorded = 0.0;

    // egui lays out in its first frames, and the number of triangles comes later still: the fourth is kept.
    const FRAMES: usize = 4;
    for frame in 1..=FRAMES {
        let [width, height] = SIZE.map(|n| n as f32 / screen.pixels_per_point);
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, height))),
            time: Some(frame as f64),
            ..Default::default()
        };
        let mut output = context.run_ui(input, |ui| {
            egui::Window::new("Tessellation").default_pos([16.0, 16.0]).default_width(190.0).show(
                ui.ctx(),
                |ui| {
                    ui.add(egui::Slider::new(&mut pixels, 0.1..=16.0).logarithmic(true).text("pixels"));
                    match teapot.status() {
                        None => ui.label("no frame is known yet"),
                        Some(status) => {
                            ui.label(format!("{} triangles", status.indices / 3));
                            let share = status.vertices as f32 / status.vertex_capacity as f32;
                            ui.add(
                                egui::ProgressBar::new(share).text(format!("{} vertices", status.vertices)),
                            )
                        }
                    };
                    ui.label(format!("recorded in {recorded:.2} ms"));
                },
            );
        });
        let panel = context.tessellate(output.shapes, output.pixels_per_point);
        for (id, images) in output.textures_delta.set.drain() {
            images.iter().for_each(|image| renderer.update_texture(&device, &queue, id, image));
        }
        // What the slider says now.
        teapot.set_level(&Level::pixels(pixels, camera))?;

        let begun = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        teapot.encode(&mut encoder);
        recorded = begun.elapsed().as_secs_f64() * 1e3;
        let mut pass = target.begin(&mut encoder);
        pass.set_pipeline(&surface.pipeline);
        pass.set_bind_group(0, &surface.camera, &[]);
        pass.set_vertex_buffer(0, teapot.vertices().slice(..));
        pass.set_index_buffer(teapot.indices().slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed_indirect(teapot.draw_args(), 0);
        drop(pass);

        let mut before = renderer.update_buffers(&device, &queue, &mut encoder, &panel, &screen);
        let mut pass = over(&view, &mut encoder).forget_lifetime();
        renderer.render(&mut pass, &panel, &screen);
        drop(pass);
        output.textures_delta.free.drain().for_each(|id| renderer.free_texture(&id));
        let shot = target.shoot(&device, &mut encoder);
        before.push(encoder.finish());
        let submission = queue.submit(before);
        if frame == FRAMES {
            return shot.save(&device, submission, file);
        }
        device.poll(wgpu::PollType::wait_indefinitely())?;
    }
    Ok(())
}

/// A pass over what the picture shows already.
fn over<'a>(view: &wgpu::TextureView, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("panel"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}
