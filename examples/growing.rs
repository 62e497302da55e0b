//! Rules that run with each frame: a lace grows up the teapot while a camera goes round. A param of the rules
//! changes from frame to frame, and half-way other rules are loaded, once with a mistake in them.
//! `cargo run --release --example growing -- --frames 48 --out out/growing` writes a picture a frame.
mod host; // what a renderer has anyway: the picture, the pipeline, the way to the file

use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::gpu::{Engine, run};
use burgeon::io::bpt;
use burgeon::language::{System, Value};
use burgeon::patch::Axiom;
use burgeon::tessellate::{Camera, Level, Options};
use std::path::PathBuf;

const SIZE: [u32; 2] = [768, 512];

/// Panes below a height lose a quarter, and what is left of them again and again, the further below the more often.
const LACE: &str = "
system lace : patch bezier 3
param height: float = 0.0
module Pane(n: int)
axiom: Pane(0) = file \"teapot.bpt\"
rules split:
  Pane(n) -> [ Pane(0) Pane(0) ; Pane(0) Pane(0) ]
rules lace:
  Pane(n) : centroid.y < height - 0.6 * n -> [ Pane(n + 1) Pane(n + 1) ; Pane(n + 1) eps ]
run:
  derive 2 with split
  derive 4 with lace
";

const SHADER: &str = "
@group(0) @binding(0) var<uniform> clip: mat4x4f;
struct Seen { @builtin(position) place: vec4f, @location(0) normal: vec3f }
@vertex fn vertex(@location(0) p: vec3f, @location(1) n: vec3f) -> Seen { return Seen(clip * vec4f(p, 1), n); }
@fragment fn fragment(seen: Seen, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let light = abs(dot(normalize(seen.normal), normalize(vec3f(1, 3, 2))));
    let paint = select(vec3f(0.72, 0.55, 0.2), vec3f(0.13, 0.35, 0.42), front);
    return vec4f(paint * (0.15 + 0.85 * light), 1);
}";

type Failure = Box<dyn std::error::Error>;

/// The rules of a text, and where they begin. What is wrong with it is said with its line.
fn rules(text: &str) -> Result<(System, Axiom), Failure> {
    let system = System::parse(text)?;
    let data = |name: &str| bpt::read(format!("{}/examples/data/{name}", env!("CARGO_MANIFEST_DIR")), false);
    let axiom = Axiom::load(&system, &mut |name| data(name))?;
    Ok((system, axiom))
}

fn camera(turn: f32) -> Camera {
    let eye = [7.5 * turn.sin(), 4.6, 7.5 * turn.cos()];
    Camera::looking(eye, [0.0, 1.3, 0.0], [0.0, 1.0, 0.0], 35.0, SIZE.map(|x| x as f32), 0.1)
}

fn main() -> Result<(), Failure> {
    let (frames, out) = arguments()?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default()))?;
    let engine = Engine::new(&device, &queue);

    let (system, axiom) = rules(LACE)?;
    let (level, room) = (Level::pixels(0.5, camera(0.0)), Capacity::for_vertices(20_000));
    let params = run::Options::default();
    let mut teapot =
        Tessellator::of_rules(&engine, &system, &axiom, &params, &level, &Options::default(), &room)?;
    let surface = host::Surface::new(&device, SHADER, &teapot.vertex_layout().buffers());
    let target = host::Target::new(&device, SIZE);
    std::fs::create_dir_all(&out)?;

    for frame in 0..frames {
        let time = frame as f32 / frames as f32;
        if frame == frames / 2 {
            // Someone edits the rules: first they do not hold together, and the old ones go on; then they do.
            let hole = "; Pane(n + 1) eps ]";
            let mistake = LACE.replace(hole, "; eps ]");
            match rules(&mistake).and_then(|(s, a)| Ok(teapot.reload(&s, &a, &params)?)) {
                Err(e) => println!("frame {frame}: the old rules go on\n{e}"),
                Ok(()) => return Err("a ragged block was taken".into()),
            }
            let (system, axiom) = rules(&LACE.replace(hole, "; eps eps ]"))?;
            teapot.reload(&system, &axiom, &params)?;
            println!("frame {frame}: other rules");
        }
        // What changes: the rules' param, and the camera.
        let height = Value::Float(10.0 * (time % 0.5));
        teapot.set_params(&[("height".into(), height)])?;
        let camera = camera(std::f32::consts::TAU * time);
        teapot.set_camera(camera)?;
        surface.look(&queue, &camera.clip);

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
        // A window would go on here; a picture waits for its pixels, and with them comes the status.
        shot.save(&device, submission, out.join(format!("{frame:03}.png")))?;
        if let Some(status) = teapot.status() {
            let (modules, triangles) = (status.modules, status.indices / 3);
            match status.skipped {
                0 => println!("frame {frame}: {modules} modules, {triangles} triangles"),
                _ => println!("frame {frame}: {modules} modules; the frame before is drawn"),
            }
            if !status.complete() {
                teapot.set_capacity(&Capacity::grown(&status).half_more())?;
                println!("frame {frame}: the room grows");
            }
        }
    }
    Ok(())
}

fn arguments() -> Result<(usize, PathBuf), Failure> {
    let (mut frames, mut out) = (48, PathBuf::from("out/growing"));
    let mut list = std::env::args().skip(1);
    while let Some(flag) = list.next() {
        let value = list.next().ok_or_else(|| format!("{flag} wants a value"))?;
        match flag.as_str() {
            "--frames" => frames = value.parse().map_err(|_| format!("--frames {value}: a number"))?,
            "--out" => out = value.into(),
            _ => return Err(format!("{flag} is no flag: there are --frames N and --out FOLDER").into()),
        }
    }
    Ok((frames, out))
}
