//! Watertight tessellations: trees, marks, offsets and triangles to the bit, vertices within rounding.
//!
//! Whether a cell is split hangs on floats, which a device may round otherwise; the tolerances of these cases are
//! such that a hundred-thousandth more or less splits no other cell.

use super::{Case, Compared, Stop, Trouble, check};
use crate::cpu::tessellate::Tessellator as Cpu;
use crate::gpu::tessellate::{Capacity, Frame, Tessellator};
use crate::gpu::{Engine, run};
use crate::io::bpt;
use crate::language::{System, Value};
use crate::patch::{Axiom, Net};
use crate::plan::{self, Plan, View};
use crate::tessellate::vertex::Normal;
use crate::tessellate::{Camera, Level, Options};

/// How far two floats of a vertex may be apart, beside the larger of 1 and their size.
pub const ROUNDING: f32 = 1e-5;

/// The same for normals and tangents that come of differences over a 2048th of a side, as those of a displaced
/// surface do.
pub const SLOPE_ROUNDING: f32 = 2e-3;

/// Patches, and the levels of the frames that are made of them.
pub struct Set {
    pub name: &'static str,
    /// A `.bpt` file.
    pub text: &'static str,
    pub rational: bool,
    pub levels: Vec<Level>,
    /// Rules without an axiom of these patches, whose placement displaces them.
    pub rules: Option<&'static str>,
}

/// What the cases are made of.
pub fn sets() -> [Set; 4] {
    const TEAPOT: &str = include_str!("../../examples/data/teapot.bpt");
    const SPHERE: &str = include_str!("../../examples/data/sphere.bpt");
    let teapot = [0.05, 0.01].map(Level::world).to_vec();
    let sphere = vec![Level::world(0.02)];
    [
        Set { name: "teapot", text: TEAPOT, rational: false, levels: teapot.clone(), rules: None },
        Set { name: "sphere", text: SPHERE, rational: true, levels: sphere, rules: None },
        Set { name: "camera", text: TEAPOT, rational: false, levels: moving(), rules: None },
        Set { name: "displaced", text: TEAPOT, rational: false, levels: teapot, rules: Some(DISPLACED) },
    ]
}

/// Rules whose cells are of unequal depths, erased ones among them, and others when a param is, or the view.
pub const LACE: &str = "\
system lace : patch bezier 3
param depth: int = 2 in 0 .. 4
param limit: float = 0.6 in 0 .. 10
module P(n: int), Q
axiom: P(0) = file \"teapot.bpt\"
rules:
  P(n) : n < depth && flatness > limit -> [ P(n + 1) P(n + 1) ; P(n + 1) Q ]
  P(n) : n < depth && bbox_px > 200 -> [ P(n + 1) | Q ]
rules cut:
  Q : level % 2 == 1 -> [ Q eps ; Q Q ]
  P(n) : n == 1 -> [ Q ; Q ]
run:
  derive until terminal max 5
  derive depth with cut
";

/// Frames whose rules are derived with them.
fn of_rules() -> Case {
    Case::new("tessellation of rules", |engine, stop| {
        let differs = |e: String| Trouble::Differs(e);
        let nets = bpt::parse(include_bytes!("../../examples/data/teapot.bpt"), false);
        let nets = nets.map_err(|e| differs(e.to_string()))?;
        let system = System::parse(LACE).map_err(|e| differs(e.to_string()))?;
        let plan = Plan::keeping_holes(&system).map_err(|e| differs(e.to_string()))?;
        let axiom = Axiom::load::<String>(&system, &mut |_| Ok(nets.clone()));
        let axiom = axiom.map_err(|e| differs(e.to_string()))?;
        let at =
            |from: f32| View::looking([from, 2.0, from], [0.0; 3], [0.0, 1.0, 0.0], 40.0, [800.0, 600.0]);
        let params = |depth, limit, from| run::Options {
            set: vec![("depth".into(), Value::Int(depth)), ("limit".into(), Value::Float(limit))],
            view: Some(at(from)),
            ..run::Options::default()
        };
        let first = params(2, 0.6, 6.0);
        let (options, room) = (Options::default(), Capacity::for_vertices(1 << 16));
        let level = Level { hysteresis: 0.5, ..Level::world(0.1) };
        let mut gpu = Tessellator::of_rules(engine, &system, &axiom, &first, &level, &options, &room)?;
        let mut cpu = Cpu::new(&nets, &options).map_err(crate::gpu::Error::from)?;
        let mut all = Compared::default();
        for (depth, limit, from, tolerance) in
            [(2, 0.6, 6.0, 0.1), (3, 0.2, 3.0, 0.14), (0, 0.4, 3.0, 0.12), (4, 0.05, 9.0, 0.1)]
        {
            check(stop)?;
            let run::Options { set, view, .. } = params(depth, limit, from);
            let level = Level { tolerance, ..level.clone() };
            gpu.set_params(&set)?;
            gpu.set_view(at(from))?;
            gpu.set_level(&level)?;
            let derived = plan::Options { set, view, ..plan::Options::default() };
            let (word, _) =
                crate::cpu::derive(&plan, &axiom, &derived, 0).map_err(|e| differs(e.to_string()))?;
            cpu.set_word(&word, plan.hole).map_err(crate::gpu::Error::from)?;
            cpu.run(&level.target().map_err(crate::gpu::Error::from)?);
            all.add(compare(&cpu, &gpu.frame()?)?);
        }
        Ok(all)
    })
}

/// A placement that reads all there is.
const DISPLACED: &str = "
system displaced : patch bezier 3
param height: float = 0.1
module P
place d = p + (normal * (height * noise(3 * p) + 0.02 * rand(-1, 1))
  + frame * (scale * (0.02 * sin(tau * uv.x), 0.02 * uv.y, 0.01 * randn())) + (0, 0.01 * float(id), 0))
run:
  place d
";

/// The cases.
pub fn cases() -> Vec<Case> {
    let case = |set: Set| {
        Case::new(format!("tessellation {}", set.name), move |engine, stop| {
            let nets = bpt::parse(set.text.as_bytes(), set.rational);
            let nets = nets.map_err(|e| Trouble::Differs(e.to_string()))?;
            let mut all = Compared::default();
            for seams in [false, true] {
                let options = Options { seams, ..Options::default() };
                all.add(frames(engine, &nets, &set, &options, stop)?);
            }
            Ok(all)
        })
    };
    sets().map(case).into_iter().chain([of_rules()]).collect()
}

/// A camera that comes near, with memory of the frame before and a budget.
fn moving() -> Vec<Level> {
    let at = |eye: [f32; 3]| {
        let camera = Camera::looking(eye, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 40.0, [960.0, 720.0], 0.05);
        Level { hysteresis: 0.25, budget: Some(12_000), depth: 0..=8, ..Level::pixels(1.0, camera) }
    };
    [[9.0, 4.0, 7.0], [5.0, 3.0, 4.0], [2.6, 1.8, 2.2], [0.3, 1.2, 0.1], [9.0, 4.0, 7.0]].map(at).to_vec()
}

/// Frame after frame on both.
fn frames(
    engine: &Engine,
    nets: &[Net],
    set: &Set,
    options: &Options,
    stop: Stop,
) -> Result<Compared, Trouble> {
    let mut cpu = Cpu::new(nets, options).map_err(crate::gpu::Error::from)?;
    let room = Capacity::for_vertices(1 << 16);
    let first = set.levels.first().ok_or(Trouble::Stopped)?;
    let mut gpu = Tessellator::new(engine, nets, first, options, &room)?;
    if let Some(rules) = set.rules {
        let system = System::parse(rules).map_err(|e| Trouble::Differs(e.to_string()))?;
        let plan = Plan::new(&system).map_err(|e| Trouble::Differs(e.to_string()))?;
        let values = plan::Options { seed: Some(5), ..plan::Options::default() };
        cpu.displace(&plan, &values).map_err(crate::gpu::Error::from)?;
        gpu.displace(&plan, &values)?;
    }
    let mut all = Compared::default();
    for level in &set.levels {
        check(stop)?;
        cpu.run(&level.target().map_err(crate::gpu::Error::from)?);
        gpu.set_level(level)?;
        all.add(compare(&cpu, &gpu.frame()?)?);
    }
    Ok(all)
}

/// Holds a frame of a device against the CPU's.
///
/// # Errors
/// [`Trouble::Differs`] with the first thing that is not the same.
pub fn compare(cpu: &Cpu, gpu: &Frame) -> Result<Compared, Trouble> {
    let (t, out) = (cpu.trees(), cpu.out());
    let leaves = |marks: &[u32]| -> Vec<u32> {
        let leaf = |n: &usize| t.children[*n] == crate::tessellate::tree::LEAF;
        (0..t.nodes.len()).filter(leaf).map(|n| marks.get(n).copied().unwrap_or(u32::MAX)).collect()
    };
    equal("node", &gpu.nodes, &t.nodes)?;
    equal("children of node", &gpu.children, &t.children)?;
    equal("marks of leaf", &leaves(&gpu.marks), &leaves(&t.marks))?;
    equal("offset of vertices", &gpu.offsets, &t.offsets)?;
    equal("offset of triangles", &gpu.triangle_offsets, &t.triangle_offsets)?;
    equal("index", &gpu.indices, &out.indices)?;
    equal("cell of triangle", &gpu.cells, &out.cells)?;
    equal("draw arguments", &[gpu.draw], &[*cpu.draw_args()])?;
    let said = |s: &crate::tessellate::passes::Status| {
        [s.vertices, s.indices, s.nodes, s.frame, s.coarser, s.skipped]
    };
    equal("status", &said(&gpu.status), &said(cpu.status()))?;
    let rounding = vertices(cpu, gpu)?;
    let words = 6 * t.nodes.len() + 2 * t.offsets.len() + out.indices.len() + out.cells.len();
    let values = (words + out.vertices.len()) as u64;
    Ok(Compared { runs: 1, passes: 1, values, rounding })
}

fn equal<T: PartialEq + std::fmt::Debug>(what: &str, gpu: &[T], cpu: &[T]) -> Result<(), Trouble> {
    if gpu.len() != cpu.len() {
        return Err(Trouble::Differs(format!("{} of {what} for {}", gpu.len(), cpu.len())));
    }
    match gpu.iter().zip(cpu).position(|(a, b)| a != b) {
        None => Ok(()),
        Some(at) => Err(Trouble::Differs(format!("{what} {at}: {:?} for {:?}", gpu[at], cpu[at]))),
    }
}

/// The words of all vertices: the greatest distance as a part of what is allowed.
fn vertices(cpu: &Cpu, gpu: &Frame) -> Result<f32, Trouble> {
    let wanted = &cpu.out().vertices;
    if gpu.vertices.len() < wanted.len() {
        let (found, wanted) = (gpu.vertices.len(), wanted.len());
        return Err(Trouble::Differs(format!("{found} words of vertices for {wanted}")));
    }
    let packed = cpu.format().normal == Some(Normal::Octahedral);
    let rounding = |word: usize| if of_slopes(cpu, word) { SLOPE_ROUNDING } else { ROUNDING };
    let mut most = 0.0f32;
    for (k, (&a, &b)) in gpu.vertices.iter().zip(wanted).enumerate() {
        let (x, y) = (f32::from_bits(a), f32::from_bits(b));
        let part = match packed {
            _ if a == b => 0.0,
            true => {
                if a_step_apart(a, b) {
                    1.0
                } else {
                    f32::INFINITY
                }
            }
            // A small integer is a float that is nearly 0.
            false if !x.is_normal() && x != 0.0 => f32::INFINITY,
            false => (x - y).abs() / (rounding(k) * y.abs().max(1.0)),
        };
        if part > 1.0 || part.is_nan() {
            let what = format!("word {k} of the vertices: {x} ({a:x}) for {y} ({b:x})");
            return Err(Trouble::Differs(what));
        }
        most = most.max(part);
    }
    Ok(most)
}

/// Whether a word of the vertices is one of a normal or tangent of a displaced surface.
fn of_slopes(cpu: &Cpu, word: usize) -> bool {
    let (count, byte) = (cpu.status().vertices, 4 * word as u64);
    cpu.is_displaced()
        && cpu.format().places(count)[1..3].iter().flatten().any(|place| {
            let past = byte.checked_sub(place.offset);
            past.is_some_and(|past| {
                past % place.stride < place.bytes && past / place.stride < u64::from(count)
            })
        })
}

/// Packed words whose parts are but a step apart, as halves or as bytes.
fn a_step_apart(a: u32, b: u32) -> bool {
    let near = |a: i32, b: i32| (a - b).abs() <= 1;
    let low = |w: u32| i32::from(w as u16 as i16);
    let high = |w: u32| i32::from((w >> 16) as i16);
    let halves = near(low(a), low(b)) && near(high(a), high(b));
    let bytes = a.to_le_bytes().into_iter().zip(b.to_le_bytes());
    halves || bytes.into_iter().all(|(a, b)| near((a as i8).into(), (b as i8).into()))
}
