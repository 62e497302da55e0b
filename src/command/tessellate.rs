//! `burgeon tessellate`, and the tessellation that `run --tolerance` makes of a word.

use super::flags::Tolerance;
use super::load::{self, bounds, sight};
use super::progress::Bar;
use super::run::{self, Device, milliseconds};
use super::{Failure, agreeing, counted, flags, output, stop};
use burgeon::cpu::tessellate as cpu;
use burgeon::patch::{Net, Word};
use burgeon::plan::{self, Plan};
use burgeon::tessellate::lattice::MAX_DEPTH;
use burgeon::tessellate::level::LEAST_TOLERANCE;
use burgeon::tessellate::{Camera, Complete, Level, Measure, Options, Topology, bound};
use std::time::Instant;

/// What is tessellated, and how finely.
pub struct Work<'a> {
    pub nets: &'a [Net],
    /// A word over these nets, and the symbol of its holes; else each net is one cell.
    pub word: Option<(&'a Word, Option<usize>)>,
    /// What displaces it, with its values.
    pub placement: Option<(&'a Plan, &'a plan::Options<'a>)>,
    pub level: &'a Level,
}

/// A mesh, and what it took.
pub struct Surface {
    pub complete: Complete,
    pub ms: f64,
}

impl Surface {
    pub fn vertices(&self) -> u64 {
        u64::from(self.complete.status.vertices)
    }

    pub fn triangles(&self) -> u64 {
        u64::from(self.complete.status.indices / 3)
    }

    /// `289 vertices, 512 triangles`.
    pub fn counts(&self) -> String {
        format!("{}, {}", counted(self.vertices(), "vertex"), counted(self.triangles(), "triangle"))
    }
}

/// Reads patches and writes one mesh.
pub fn tessellate(flags: &flags::Tessellate) -> Result<(), Failure> {
    let start = Instant::now();
    // What is wrong with the file comes before what is wrong with flags.
    let word = load::patches(&flags.file, flags.bspline)?;
    let targets = output::targets(&flags.out, flags.format, &output::TRIANGLES)?;
    let nets: Vec<Net> = (0..word.modules.len())
        .map(|root| Net { degree: word.degree, points: word.net(root).to_vec() })
        .collect();
    let in_pixels = matches!(flags.fineness.tolerance, Some(Tolerance::Pixels(_)));
    if flags.view.eye.is_some() && !in_pixels {
        let what = "--eye is for a tolerance in pixels, as in --tolerance 0.5px";
        return Err(Failure::Usage(format!("error: {what}")));
    }
    let level = level(&flags.fineness, &flags.view, flags.drawing.up, &nets)?;
    stop::watch();
    let bar = Bar::new();
    let device = run::device(flags.backend, &flags.machine, &bar)?;
    if flags.fineness.tolerance.is_none() {
        let tolerance = short(level.tolerance, 9);
        bar.say(&format!("note: --tolerance {tolerance}, a thousandth of the model's diagonal"));
    }
    let work = Work { nets: &nets, word: None, placement: None, level: &level };
    let mut surface = make(&work, device.as_ref(), &flags.machine, &bar);
    let shape = match &mut surface {
        Ok(surface) => Ok(shape(surface, false, &targets)),
        Err(why) => Err(why.clone()),
    };
    let look = output::Look {
        drawing: &flags.drawing,
        device: device.as_ref(),
        adapter: flags.machine.adapter.as_deref(),
    };
    let written = output::write(&targets, &word, &shape, &look, &bar);
    bar.clear();
    written?;
    // What failed was said by `write`.
    let Ok(surface) = surface else { return Ok(()) };
    if flags.stats {
        let stats = serde_json::json!({
            "backend": if device.is_some() { "gpu" } else { "cpu" },
            "adapter": adapter(device.as_ref()),
            "patches": nets.len(),
            "vertices": surface.vertices(),
            "triangles": surface.triangles(),
            // As it was given, not as the nearest f64 of it.
            "tolerance": level.tolerance.to_string().parse::<f64>().ok(),
            "pixels": in_pixels,
            "tessellate_ms": surface.ms,
            "total_ms": milliseconds(start),
        });
        return output::report(&targets, &stats.to_string());
    }
    let patches = counted(nets.len() as u64, "patch");
    output::report(&targets, &format!("{}: {patches}, {}", word.system, surface.counts()))
}

#[cfg(feature = "gpu")]
fn adapter(device: Option<&Device>) -> String {
    device.map_or("CPU".to_string(), |device| device.info.name.clone())
}

#[cfg(not(feature = "gpu"))]
fn adapter(_: Option<&Device>) -> String {
    "CPU".to_string()
}

/// A flag of depth that was given.
pub fn depth_flag(flags: &flags::Fineness) -> Option<&'static str> {
    let min = flags.min_depth.map(|_| "--min-depth");
    min.or(flags.max_depth.map(|_| "--max-depth"))
}

/// How fine the flags want it.
pub fn level(
    flags: &flags::Fineness,
    view: &flags::View,
    up: flags::Up,
    nets: &[Net],
) -> Result<Level, Failure> {
    let usage = |what: String| Failure::Usage(format!("error: {what}"));
    let (tolerance, measure) = match flags.tolerance {
        None => (a_thousandth(nets), Measure::World),
        Some(Tolerance::World(tolerance)) => (tolerance, Measure::World),
        Some(Tolerance::Pixels(tolerance)) => match sight(view, up, nets.iter())? {
            Some(sight) => (tolerance, Measure::Pixels(sight.camera())),
            None => {
                let what = format!("--tolerance {tolerance}px is seen by a viewer, and there is none");
                return Err(usage(format!("{what}\nhelp: --eye X,Y,Z says where the viewer stands")));
            }
        },
    };
    if tolerance < LEAST_TOLERANCE {
        let what = format!(
            "a tolerance of {tolerance:e} cannot be told in single precision, {LEAST_TOLERANCE:e} can"
        );
        return Err(usage(format!("--tolerance: {what}\nhelp: give a larger one, or scale the model up")));
    }
    let least = flags.min_depth.unwrap_or(0);
    let usual = *Level::world(tolerance).depth.end();
    let most = flags.max_depth.unwrap_or(usual.max(least));
    if least > most {
        return Err(usage(format!(
            "--min-depth {least} is more than --max-depth {most}: no depth lies between"
        )));
    }
    let level = Level { measure, depth: least..=most, ..Level::world(tolerance) };
    // What is left to be wrong is a viewer beyond what floats can tell.
    level.target().map_err(|e| usage(format!("--eye: {e}")))?;
    Ok(level)
}

/// A thousandth of the diagonal of the box around the control points, in two digits; 1 where all is one
/// point, which has no triangles at any tolerance.
fn a_thousandth(nets: &[Net]) -> f32 {
    let diagonal = bounds(nets.iter()).map_or(0.0, |b| {
        let side = |k: usize| f64::from(b.max[k]) - f64::from(b.min[k]);
        (0..3).map(|k| side(k) * side(k)).sum::<f64>().sqrt()
    });
    // The text is what the note says, so that giving it makes the same mesh.
    let rounded = format!("{:.1e}", diagonal * 1e-3).parse::<f32>();
    rounded.ok().filter(|&t| t > 0.0 && t.is_finite()).unwrap_or(1.0)
}

/// Makes the mesh on the device, or the CPU; says how the patches meet.
pub fn make(
    work: &Work,
    device: Option<&Device>,
    machine: &flags::Machine,
    bar: &Bar,
) -> Result<Surface, String> {
    let start = Instant::now();
    bar.doing(&format!("tessellating {}", counted(work.nets.len() as u64, "patch")));
    if work.nets.is_empty() {
        return Ok(Surface { complete: Complete::default(), ms: milliseconds(start) });
    }
    say_rounding(work, bar);
    let complete = match device {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(work, device, bar),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match *device {},
        None => on_cpu(work, machine, bar),
    }?;
    let (least, most) = (*work.level.depth.start(), *work.level.depth.end());
    if least < most && complete.deepest >= most {
        let help = if most < MAX_DEPTH { "; a greater --max-depth may help" } else { "" };
        let times = complete.deepest;
        bar.say(&format!("note: where cells were halved {times} times the tolerance may not be kept{help}"));
    }
    Ok(Surface { complete, ms: milliseconds(start) })
}

/// A note where rounding is no small part of the tolerance, as it is far from the origin.
fn say_rounding(work: &Work, bar: &Bar) {
    let (mut size, mut far) = (0.0f32, 0.0f32);
    for b in work.nets.iter().filter_map(|net| bounds(std::iter::once(net))) {
        for k in 0..3 {
            size = size.max(b.max[k] - b.min[k]);
            far = far.max(b.max[k].abs()).max(b.min[k].abs());
        }
    }
    let (unit, scale) = match work.level.measure {
        Measure::World => ("", 1.0),
        Measure::Pixels(camera) => (" pixels", pixels_a_unit(work.nets, &camera)),
    };
    let (rounding, tolerance) = (bound::rounding(size, far) * scale, work.level.tolerance);
    if rounding > tolerance * 0.01 {
        bar.say(&format!(
            "note: rounding adds up to {}{unit} to the tolerance of {}: numbers of single precision lie {} apart at {}",
            short(rounding, 1),
            short(tolerance, 6),
            short(bound::spacing(far), 2),
            short(far, 6),
        ));
    }
}

/// Pixels of a unit where the camera sees the patches from nearest.
fn pixels_a_unit(nets: &[Net], camera: &Camera) -> f32 {
    let row = |r: usize| [0, 1, 2, 3].map(|c| camera.clip[c][r]);
    let ([a, b, c, _], w) = (row(1), row(3));
    let depth = |p: &[f32; 4]| (w[0] * p[0] + w[1] * p[1] + w[2] * p[2]) / p[3] + w[3];
    let points = nets.iter().flat_map(|net| &net.points);
    let nearest = points.map(depth).filter(|&w| w >= camera.near).fold(f32::INFINITY, f32::min);
    let nearest = if nearest.is_finite() { nearest } else { camera.near };
    (a * a + b * b + c * c).sqrt() * camera.size[1] * 0.5 / nearest
}

/// A number in so many digits, as people write it.
fn short(x: f32, digits: usize) -> String {
    let rounded = format!("{x:.*e}", digits.saturating_sub(1)).parse::<f32>().unwrap_or(x);
    match (1e-4..1e6).contains(&rounded) {
        true => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(work: &Work, device: &Device, bar: &Bar) -> Result<Complete, String> {
    use burgeon::gpu::tessellate::{Capacity, Tessellator};
    use burgeon::gpu::{Engine, Error};
    /// Vertices that there is room for at first: a few megabytes.
    const GUESS: u32 = 1 << 16;
    let engine = Engine::new(&device.device, &device.queue);
    let (nets, options, room) = (work.nets, Options::default(), Capacity::for_vertices(GUESS));
    let tessellator = match work.word {
        Some((word, hole)) => Tessellator::of_word(&engine, nets, word, hole, work.level, &options, &room),
        None => Tessellator::new(&engine, nets, work.level, &options, &room),
    };
    let made = tessellator.and_then(|mut tessellator| {
        say_how_they_meet(tessellator.topology(), bar);
        if let Some((plan, options)) = work.placement {
            tessellator.displace(plan, options)?;
        }
        tessellator.complete()
    });
    made.map_err(|e| match e {
        Error::Binding { .. } => {
            // What no backend can count, the other one cannot either.
            let depths = Depths::of(work);
            let (help, other) = match depths.forced > cpu::MOST_NODES {
                true => (depths.coarser(cpu::MOST_NODES), ""),
                false => (depths.coarser(u64::MAX), ", or --backend cpu"),
            };
            format!("{e}\nhelp: {help}{other}")
        }
        e => e.to_string(),
    })
}

/// The bytes that a mesh may take.
fn memory(machine: &flags::Machine) -> u64 {
    machine.max_memory.unwrap_or_else(load::half_of_memory)
}

/// What makes a mesh coarser.
#[derive(Clone, Copy)]
struct Depths {
    least: u32,
    most: u32,
    /// The cells that the least makes, whatever the tolerance.
    forced: u64,
}

impl Depths {
    fn of(work: &Work) -> Depths {
        let (least, most) = (*work.level.depth.start(), *work.level.depth.end());
        // Each root is halved both ways so many times.
        let leaves = 1u64 << (2 * least);
        let forced = (leaves + (leaves - 1) / 3).saturating_mul(work.nets.len() as u64);
        Depths { least, most, forced }
    }

    /// What makes fewer cells, where these are too many: no tolerance helps against halvings that are asked for.
    fn coarser(self, cells: u64) -> &'static str {
        match self {
            Depths { least: 1.., forced, .. } if forced > cells => "take a lower --min-depth",
            Depths { least: least @ 1.., most, .. } if least == most => {
                "take a larger --tolerance or a lower --min-depth"
            }
            _ => "take a larger --tolerance or a lower --max-depth",
        }
    }
}

fn on_cpu(work: &Work, machine: &flags::Machine, bar: &Bar) -> Result<Complete, String> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(machine.threads as usize).build();
    let threads = threads.map_err(|e| format!("the CPU backend could not start its threads: {e}"))?;
    let options = Options::default();
    let mut tessellator = match work.word {
        Some((word, hole)) => {
            cpu::Tessellator::of_word(work.nets, word, hole, &options).map_err(|e| e.to_string())?
        }
        None => cpu::Tessellator::new(work.nets, &options).map_err(|e| e.to_string())?,
    };
    say_how_they_meet(tessellator.topology(), bar);
    if let Some((plan, options)) = work.placement {
        tessellator.displace(plan, options).map_err(|e| e.to_string())?;
    }
    let (level, depths) = (work.level, Depths::of(work));
    threads.install(|| {
        let target = level.target().map_err(|e| e.to_string())?;
        let budget = memory(machine);
        tessellator.run_within(&target, budget, &stop::STOP).map_err(|e| match e {
            cpu::Error::Memory { nodes, budget } => {
                let help = depths.coarser(budget / cpu::BYTES_A_NODE);
                let (needed, budget) = (load::size(nodes * cpu::BYTES_A_NODE), load::size(budget));
                let cells = counted(nodes, "cell");
                let what = format!("a mesh of {cells} needs about {needed}; the memory budget is {budget}");
                format!("{what}\nhelp: {help}, or raise --max-memory")
            }
            cpu::Error::Nodes { nodes } => {
                let (cells, most) = (counted(nodes, "cell"), counted(cpu::MOST_NODES, "cell"));
                let what = format!("a mesh of {cells} has more triangles than can be counted; {most} may be");
                format!("{what}\nhelp: {}", depths.coarser(cpu::MOST_NODES))
            }
            cpu::Error::Stopped => "stopped by Ctrl-C".to_string(),
            e @ cpu::Error::Points { .. } => e.to_string(),
        })?;
        Ok(tessellator.complete())
    })
}

/// The mesh, taken out, as files and pictures have it. With colours by symbol a picture has its vertices
/// once for each symbol.
pub fn shape(surface: &mut Surface, by_symbol: bool, targets: &[output::Target]) -> output::Shape {
    let mesh = std::mem::take(&mut surface.complete.mesh);
    let coloured = (by_symbol && output::need_picture(targets)).then(|| {
        let (mesh, symbols) = mesh.parted(|triangle| surface.complete.sources[triangle][1]);
        (mesh, symbols.into_iter().map(|symbol| output::color(symbol as usize)).collect())
    });
    output::Shape { mesh, coloured }
}

/// Sides that meet without being joined that are named one by one.
const NAMED: usize = 8;

/// Notes on what is not simply two patches to a side.
fn say_how_they_meet(topology: &Topology, bar: &Bar) {
    let report = topology.report();
    let note = |text: String| bar.say(&format!("note: {text}"));
    match report.borders as u64 {
        0 => {}
        n => {
            let share = agreeing(n, "shares its", "share their");
            let why = match topology.roots() {
                1 => String::new(),
                _ => format!(", which {share} control points with no other"),
            };
            note(format!("the surface is open at {}{why}", counted(n, "side")));
        }
    }
    match report.crowded as u64 {
        0 => {}
        n => note(format!("on {} more than two patches meet", counted(n, "side"))),
    }
    // Poles and tips of cones have one such side or two across from each other.
    let collapsed = |root: u32, sides: [u32; 2]| sides.iter().any(|&s| topology.is_collapsed(root, s));
    let bent = |root: &u32| collapsed(*root, [0, 1]) && collapsed(*root, [2, 3]);
    let bent: Vec<u32> = (0..topology.roots() as u32).filter(bent).collect();
    if let Some(first) = bent.first() {
        let all = match bent.len() as u64 - 1 {
            0 => String::new(),
            n => format!(", and so {} {n} more", agreeing(n, "has", "have")),
        };
        note(format!("patch {first} has two neighbouring sides that are points{all}"));
    }
    let named = |[root, side]: [u32; 2]| {
        let (direction, end) = topology.file_side(root, side);
        format!("side {direction} = {end} of patch {root}")
    };
    for &[(long, side), (short, of_short)] in report.partial.iter().take(NAMED) {
        let along = if topology.file_side(long, side).0 == 'u' { 'v' } else { 'u' };
        note(format!(
            "{} meets half of {} and is not joined to it, so there may be cracks; halve patch {long} at {along} = 0.5",
            named([short, of_short]),
            named([long, side]),
        ));
    }
    match report.partial.len().saturating_sub(NAMED) as u64 {
        0 => {}
        n => {
            let meet = agreeing(n, "side meets half of another", "sides meet halves of others");
            note(format!("{n} more {meet}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth(min: Option<u32>, max: Option<u32>) -> Option<std::ops::RangeInclusive<u32>> {
        let tolerance = Some(Tolerance::World(0.01));
        let fineness = flags::Fineness { tolerance, min_depth: min, max_depth: max };
        let view = flags::View { eye: None, look_at: None, angle: 40.0, pixels: [1280.0, 720.0] };
        level(&fineness, &view, flags::Up::Y, &[]).ok().map(|level| level.depth)
    }

    #[test]
    fn the_greatest_depth_follows_the_least_that_is_given() {
        assert_eq!(depth(None, None), Some(0..=12));
        assert_eq!(depth(Some(12), None), Some(12..=12));
        assert_eq!(depth(Some(13), None), Some(13..=13));
        assert_eq!(depth(Some(MAX_DEPTH), None), Some(MAX_DEPTH..=MAX_DEPTH));
        assert_eq!(depth(Some(2), Some(3)), Some(2..=3));
        assert_eq!(depth(Some(13), Some(12)), None);
    }

    #[test]
    fn what_is_advised_helps() {
        let nets = [Net { degree: [1, 1], points: Vec::new() }];
        let advice = |depth: std::ops::RangeInclusive<u32>, most| {
            let level = Level { depth, ..Level::world(0.01) };
            Depths::of(&Work { nets: &nets, word: None, placement: None, level: &level }).coarser(most)
        };
        assert_eq!(advice(0..=12, 100), "take a larger --tolerance or a lower --max-depth");
        assert_eq!(advice(3..=12, 85), "take a larger --tolerance or a lower --max-depth");
        assert_eq!(advice(3..=12, 84), "take a lower --min-depth");
        assert_eq!(advice(MAX_DEPTH..=MAX_DEPTH, 1 << 28), "take a lower --min-depth");
        assert_eq!(advice(13..=13, u64::MAX), "take a larger --tolerance or a lower --min-depth");
    }
}
