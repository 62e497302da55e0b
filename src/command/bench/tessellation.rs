//! Cases of watertight tessellations: a frame and its parts, on any backend.

use super::{Case, Failure, kernels::infallible, measured, threads};
use crate::command::counted;
use burgeon::cpu::tessellate::Tessellator;
use burgeon::patch::Net;
use burgeon::tessellate::{Camera, Level, Options, bound, surface};
use std::time::Instant;

/// The tolerance of the model as it is.
pub(super) const TOLERANCE: f32 = 0.0025;

/// One with so many vertices that what starts a pass no longer counts.
pub(super) const FINE: f32 = 0.0001;

pub(super) const FINE_VERTICES: &str = "vertices of 32 bytes, within 0.0001";

/// Patches of a model that is measured.
const MOST_MEASURED: usize = 2000;

/// Copies of the model along x and along z, in the crowd.
const CROWD: usize = 100;

/// The model again and again, as many as `side` · `side` of it, in rows on the ground.
pub(super) fn crowd(roots: &[Net]) -> Vec<Net> {
    let mut nets = Vec::with_capacity(CROWD * CROWD * roots.len());
    for copy in 0..CROWD * CROWD {
        let (x, z) = ((copy % CROWD) as f32 * 8.0, (copy / CROWD) as f32 * 8.0);
        nets.extend(roots.iter().map(|net| Net {
            degree: net.degree,
            points: net.points.iter().map(|&[a, b, c, w]| [a + x * w, b, c + z * w, w]).collect(),
        }));
    }
    nets
}

/// Where the camera of the crowd stands in a round: it goes along a row.
pub(super) fn moving(round: usize) -> Level {
    let x = 398.0 + 0.3 * round as f32;
    let camera =
        Camera::looking([x, 5.0, -9.0], [x, 0.0, 40.0], [0.0, 1.0, 0.0], 45.0, [1920.0, 1080.0], 0.1);
    Level { depth: 0..=7, ..Level::pixels(1.0, camera) }
}

/// Triangles of each patch halved to the depth at which its own bound keeps the tolerance.
fn uniform_triangles(roots: &[Net], tolerance: f32) -> u64 {
    let degree = roots.first().map_or([3, 3], |net| net.degree);
    let orders = surface::orders(degree);
    let of = |net: &Net| {
        let rational = net.points.iter().any(|p| p[3] != 1.0);
        let patches = surface::Patches { degree, rational, nets: &net.points, orders: &orders };
        let control = patches.control(0, Default::default());
        let error = bound::error(&control, rational) * control.place.size;
        let depth = (0..16).find(|&d| error <= tolerance * 4f32.powi(d)).unwrap_or(16);
        2 * 4u64.pow(depth as u32)
    };
    roots.iter().map(of).sum()
}

/// What a frame must write and read: outputs, nodes and their columns, once each.
pub(super) fn frame_bytes(nodes: u64, vertices: u64, triangles: u64) -> u64 {
    nodes * 60 + vertices * 32 + triangles * 16
}

pub(super) fn cpu_cases<'a>(roots: &[Net], crowd: &[Net], cases: &mut Vec<Case<'a>>) -> Result<(), Failure> {
    let threads = threads();
    let level = Level::world(TOLERANCE);
    let target = level.target().map_err(|e| Failure::Usage(format!("error: {e}")))?;
    let new = |nets: &[Net]| {
        Tessellator::new(nets, &Options::default()).map_err(|e| Failure::File(format!("error: {e}")))
    };
    let mut first = new(roots)?;
    first.run(&target);
    let s = *first.status();
    let (vertices, triangles) = (u64::from(s.vertices), u64::from(s.indices) / 3);
    let uniform = uniform_triangles(roots, TOLERANCE);
    super::super::say(&format!(
        "{} within {TOLERANCE}: {}, {}; {uniform} by uniform dicing of each patch at the same bound; {} bytes of \
         trees a vertex",
        counted(roots.len() as u64, "patch"),
        counted(vertices, "vertex"),
        counted(triangles, "triangle"),
        u64::from(s.nodes) * 44 / vertices.max(1),
    ));
    if let Some(uniform) = (roots.len() <= MOST_MEASURED).then(|| measured::uniform(roots, &level)).flatten()
    {
        super::super::say(&format!(
            "it is {:.1e} off where it was sampled; as near is uniform dicing of each patch in {}, of all alike in {}",
            uniform.distance,
            counted(uniform.by_patch, "triangle"),
            counted(uniform.by_model, "triangle"),
        ));
    }
    let mut add = |case: &str, bytes: u64, items: u64, run: Box<dyn FnMut() -> Result<_, Failure>>| {
        cases.push(Case {
            name: "tessellate",
            case: case.to_string(),
            backend: "cpu",
            threads,
            bytes,
            items,
            run,
            times: vec![],
        });
    };
    let make = || {
        let mut t = new(roots)?;
        t.run(&target);
        Ok::<_, Failure>(t)
    };
    let nodes = u64::from(s.nodes);
    let mut t = make()?;
    let bytes = frame_bytes(nodes, vertices, triangles);
    add("a frame, items are triangles", bytes, triangles, Box::new(move || infallible(|| t.run(&target))));
    let mut t = make()?;
    add("refine, nodes", nodes * 28, nodes, Box::new(move || infallible(|| t.refine(&target))));
    let mut t = make()?;
    add("stitch, nodes", nodes * 32, nodes, Box::new(move || infallible(|| t.stitch())));
    let mut t = make()?;
    let each = 32 * vertices + 24 * nodes;
    add("vertices of 32 bytes", each, vertices, Box::new(move || infallible(|| t.dice())));
    let mut t = new(roots)?;
    let fine = Level::world(FINE).target().map_err(|e| Failure::Usage(format!("error: {e}")))?;
    t.run(&fine);
    let items = u64::from(t.status().vertices);
    let each = 32 * items + 24 * u64::from(t.status().nodes);
    add(FINE_VERTICES, each, items, Box::new(move || infallible(|| t.dice())));
    let mut t = make()?;
    let each = 16 * triangles + 24 * nodes;
    add("triangles", each, triangles, Box::new(move || infallible(|| t.connect())));
    if !crowd.is_empty() {
        let mut t = new(crowd)?;
        let label = format!("{} patches, moving camera, 1 pixel", crowd.len());
        let target = |round| moving(round).target().map_err(|e| Failure::Usage(format!("error: {e}")));
        t.run(&target(0)?);
        let s = *t.status();
        super::super::say(&format!("{label}: {} vertices, {} triangles", s.vertices, s.indices / 3));
        let (nodes, vertices, triangles) =
            (u64::from(s.nodes), u64::from(s.vertices), u64::from(s.indices) / 3);
        let mut round = 0;
        let run = move || {
            round += 1;
            let target = target(round)?;
            let start = Instant::now();
            t.run(&target);
            Ok(start.elapsed())
        };
        add(&label, frame_bytes(nodes, vertices, triangles), triangles, Box::new(run));
    }
    Ok(())
}
