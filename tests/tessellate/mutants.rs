//! The tests, tested: every kernel of a tessellation broken on purpose must show against the CPU.

use super::device::{ROOM, camera, difference, submit};
use super::far::{mapped, on_lattice};
use super::placement::{HIGH, WILD, checkered, displaced, heights, plan_of};
use super::{file, sets, tessellated};
use crate::{device, mutants, tier};
use burgeon::cpu::tessellate::Tessellator as Cpu;
use burgeon::gpu::Engine;
use burgeon::gpu::tessellate::{Capacity, Tessellator};
use burgeon::tessellate::{Camera, Level, Options};

/// How a mutant is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    /// The teapot in one orientation each, with sides that are points, in two frames, packed.
    Roots,
    /// A word of holes and of unequal halvings on a torus; patches that share no vertices.
    Word,
    /// Pixels of a camera that stands inside.
    Pixels,
    /// Frames that remember the one before.
    Frames,
    /// Room that ends.
    Room,
    /// Rational nets.
    Rational,
    /// Polynomial and rational nets far from the origin, also through a camera; patches that share no vertices.
    FarOff,
    /// A budget of triangles.
    Budget,
    /// Buffers of the caller's.
    Slab,
    /// Displaced by all that an expression sees; patches that share vertices, and that do not.
    Placed,
    /// Displaced only on one symbol of a word, and by values of the host.
    PlacedOn,
}

use Check::*;

/// File, text, what stands in its place, and the check that must see it.
type Mutant = (&'static str, &'static str, &'static str, Check);

const MUTANTS: &[Mutant] = &[
    ("decide", "k >= range.count", "k + 1u >= range.count", Roots),
    ("decide", "marks[i] = 0u", "marks[i] |= 0u", Frames),
    ("decide", "least < least_depth(n.x)", "least < 0u", Roots),
    ("decide", "least < wanted.least", "least < 0u", Pixels),
    ("decide", "select(wanted.tolerance, wanted.keep, was_split)", "wanted.tolerance", Frames),
    ("decide", "range.level != 0u", "false", Frames),
    ("decide", "n + k >= points", "n + k > points", Roots),
    ("decide", "y.w[k][c] * p[c]", "x.w[k][c] * p[c]", Roots),
    ("decide", "select(0u, 2u, x > w)", "0u", Pixels),
    ("decide", "(crosses || ", "(", Pixels),
    ("decide", "vec3f(wanted.half_size, 1.0)", "vec3f(wanted.half_size.xx, 1.0)", Pixels),
    ("bound", "2.0 * m * n * xy", "m * n * xy", Roots),
    ("bound", "xx = max(xx,", "xx = min(xx,", Roots),
    ("bound", "+ r * abs(d.w)", "", Rational),
    ("bound", "least = min(least, p.w)", "least = max(least, p.w)", Pixels),
    ("split", "first + 4u > sizes.nodes", "first > sizes.nodes", Room),
    ("split", "known + c", "known", Frames),
    ("split", "children[i] = LEAF;", "", Frames),
    ("advance", "min(splits, room)", "splits", Room),
    ("advance", "if turn.level > 0u", "if turn.level > 1u", Room),
    ("lattice", "(n.z << 1u) | (c & 1u)", "(n.z << 1u) | (c >> 1u)", Roots),
    ("lattice", "size_of(n) >> vec2u(1u)", "size_of(n) >> vec2u(2u)", Roots),
    ("lattice", "side == 0u || side == 3u", "side == 0u || side == 2u", Roots),
    ("topology", "FULL - t", "FULL - t - 1u", Roots),
    ("topology", "any(x) && any(y)", "all(x) && any(y)", Roots),
    ("topology", ">> (16u + side)", ">> (17u + side)", Roots),
    ("tree", "place & ~(size - 1u)", "place", Roots),
    ("tree", "select(1u, 0u, turn == ((k & 1u) == 0u))", "select(1u, 0u, (k & 1u) != 0u)", Word),
    ("tree", "select(border, border - 1u, (side & 1u) == 0u)", "border", Roots),
    ("tree", "if a.depth == own {", "if a.depth > own {", Roots),
    ("tree", "a.depth < own && !is_hole(nodes[a.node])", "a.depth < own", Word),
    ("table", "(n.y & 0xffffu) == shape", "true", Word),
    ("tree", "p.x == low.x || p.x == high.x", "p.x == low.x", Word),
    ("mark", "a.depth < depth[along(side)]", "a.depth <= depth[along(side)]", Roots),
    ("mark", "1u << a.side", "1u << side", Roots),
    ("tally", "seen = seen || !is_hole(nodes[found.node])", "seen = true", Word),
    ("tally", "found.node == i && found.corner == corner", "found.node == i", Roots),
    ("tally", "has_corner(nodes[to.node], ends[0])", "false", Word),
    ("finish", "vertices <= sizes.vertices", "vertices < sizes.vertices", Room),
    ("finish", "sizes.first_index", "0u", Slab),
    ("finish", "sizes.base_vertex", "0u", Slab),
    ("finish", "let at = sizes.draw_word", "let at = 0u", Slab),
    ("triangles", "sizes.index_word +", "", Slab),
    ("finish", "status[7] += 1u", "status[7] = 1u", Frames),
    ("begin", "budget.coarser -= back", "budget.coarser -= 0u", Budget),
    ("begin", "budget.fits = 0u", "budget.fits = 1u", Budget),
    ("afford", "budget.triangles <= wanted.budget", "budget.triangles < 2u * wanted.budget", Budget),
    ("budget", "case 1u: { part = 1.1892071; }", "case 1u: { part = 1.3; }", Budget),
    ("target", "near: f32,\n  tolerance: f32", "tolerance: f32,\n  near: f32", Pixels),
    ("workgroups", "invocations + workgroup - 1u", "invocations", Roots),
    ("control", "select(b, COLUMNS - 1u - b,", "select(b, b,", Roots),
    ("control", "select(vec3f(0.0), first, is_far_off)", "vec3f(0.0)", FarOff),
    ("control", "p.xyz - origin * p.w", "p.xyz - origin", FarOff),
    ("control", "(254u << 23u)", "(255u << 23u)", Roots),
    ("surface", "s.position * net_size + net_origin", "s.position * net_size", FarOff),
    ("surface", "projected(curve[0]) + origin", "projected(curve[0])", FarOff),
    ("decide", "unit) * size > limit", "unit) > limit", Roots),
    ("decide", "wanted.clip[2][k] * o.z + ", "", FarOff),
    ("decide", "let near = wanted.near * inverse_size()", "let near = 1000.0", Pixels),
    ("surface", "if size > noise", "if size >= 0.0 * noise", Roots),
    ("surface", "rest >= FULL", "rest > FULL", Roots),
    ("surface", "position * du.w", "0.0 * position", Rational),
    ("vertices", "product_of(n, own) < 0.0", "product_of(n, own) > 2.0", Roots),
    ("vertices", "entry == ((a.root << 2u) | a.corner)", "false", Roots),
    ("vertices", "select(p, p.yx, (orientation & 4u) != 0u)", "p", Roots),
    ("vertices", "if n.z >= 0.0", "if n.z >= -2.0", Frames),
    ("vertices", "foreign(n, side, to)[end]", "foreign(n, side, to)[1u - end]", Word),
    ("vertices", "found = !has_corner(nodes[to.node], p)", "found = true", Word),
    ("vertices", "position = placed;", "position = placed + vec3f(0.001);", Placed),
    ("vertices", "sum += select(face.normal, -face.normal,", "sum += select(n, -n,", Placed),
    ("vertices", "-u, (orientation & 1u)", "-u, (orientation & 2u)", Placed),
    ("surface", "let noise = NOISE * far_of_net()", "let noise = 0.0", Roots),
    ("placement", "vec2f(1.0) - q,", "q,", Placed),
    ("placement", "in_file(orientation_of(owner.root), owner.p)", "owner.p", Placed),
    ("placement", "vec3u(owner.root,", "vec3u(a.root,", Placed),
    ("placement", "(first + second) * 0.5", "first", Placed),
    ("placement", "(first + second) * 0.5", "second", Placed),
    ("placement", "place_of(a, k + skipped)", "place_of(a, (count - 1u - k) + skipped)", Placed),
    ("placement", "product_of(n, own) < 0.0", "product_of(n, own) > 2.0", Placed),
    (
        "placement",
        "let bitangent = cross_of(normal, tangent)",
        "let bitangent = cross_of(tangent, normal)",
        Placed,
    ),
    ("placement", "vec3f(-1.5, 2.0, -0.5)", "vec3f(-0.5, 0.0, 0.5)", Placed),
    ("placement", "vec3f(1.5, -2.0, 0.5)", "vec3f(1.0, -1.0, 0.0)", Placed),
    ("placement", "vec3f(-0.5, 0.0, 0.5)", "vec3f(-1.0, 1.0, 0.0)", Placed),
    ("placement", "place[direction] += off", "place[1u - direction] += off", Placed),
    ("placement", "s.dv + slopes[1] * STEPS", "s.dv", Placed),
    ("placement", "face.normal = -face.normal", "face.normal = face.normal", Placed),
    ("placement", "const ROUGHER = 64.0", "const ROUGHER = 0.0", Placed),
    ("placement", "record_at(key, root, place,", "record_at(key + vec3u(k), root, place,", Placed),
    ("placement", "select(found.normal, -found.normal, mirrors(root))", "found.normal", Placed),
    ("placement", "!is_hole(n) && !placed", "!placed", PlacedOn),
    ("placement", "!is_hole(n) && !placed", "!is_hole(n) && placed", PlacedOn),
    ("placement", "t - (k & 1u)", "t", PlacedOn),
    ("placement", "vec2u(k & 1u, k >> 1u)", "vec2u(k & 1u, 0u)", PlacedOn),
    ("placement", "* (FULL - 1u)).node", "* 0u).node", PlacedOn),
    ("placement", "uniform_word(SEED + 1u) +", "", PlacedOn),
    ("placement", "uniform_word(SEED + 2u)", "1u", PlacedOn),
    ("triangles", "select(b, c, turn)", "b", Roots),
    ("triangles", "own += 1u", "own += 2u", Word),
    ("triangles", "number(to.node, 4u)", "number(to.node, 3u)", Roots),
];

impl Check {
    /// The difference between CPU and GPU, if there is one.
    fn run(self, engine: &Engine) -> Option<String> {
        let compare = |nets: &[_], levels: &[Level], options: &Options| {
            let mut cpu = Cpu::new(nets, options).expect("a set");
            let mut gpu = Tessellator::new(engine, nets, &levels[0], options, &ROOM).expect("a set");
            levels.iter().find_map(|level| {
                cpu.run(&level.target().expect("a level"));
                gpu.set_level(level).expect("a level");
                difference(&cpu, &submit(engine, &mut gpu))
            })
        };
        let [whole, packed, _] = super::kernels::formats();
        let shared = |format| Options { format, seams: false };
        match self {
            Roots => {
                let nets = sets::scrambled(&file("teapot.bpt", false), 5).0;
                let whole = &shared(whole);
                compare(&nets, &[Level::world(0.05), Level::world(10.0)], whole)
                    .or_else(|| compare(&sets::degenerate(), &[Level::world(10.0)], whole))
                    .or_else(|| compare(&sets::book(5, 3), &[Level::world(0.05)], whole))
            }
            Rational => {
                let levels = [0.1, 0.03, 0.01, 0.003].map(Level::world);
                compare(&file("sphere.bpt", true), &levels, &shared(whole))
                    .or_else(|| compare(&file("torus.bpt", true), &levels, &shared(whole)))
            }
            FarOff => {
                let by = [5000.0, -3000.0, 700.0];
                let there = |p: [f32; 3]| [0, 1, 2].map(|k| p[k] + by[k]);
                let teapot = mapped(&on_lattice(&file("teapot.bpt", false)), there);
                let seams = Options { format: whole, seams: true };
                let [eye, at] = [[3.0, 2.0, 2.5], [0.0, 1.0, 0.0]].map(there);
                let camera = Camera::looking(eye, at, [0.0, 1.0, 0.0], 40.0, [960.0, 720.0], 0.05);
                let seen = Level { depth: 0..=6, ..Level::pixels(2.0, camera) };
                compare(&teapot, &[Level::world(0.1), seen], &seams).or_else(|| {
                    compare(&mapped(&file("sphere.bpt", true), there), &[Level::world(0.05)], &seams)
                })
            }
            Pixels => {
                let nets = file("teapot.bpt", false);
                // Inside, near, and on the surface.
                let on_it = nets[5].view().evaluate(0.5, 0.5).position;
                let levels = [[0.3, 1.2, 0.1], [3.1, 2.0, 2.4], on_it]
                    .map(|eye| Level { depth: 1..=7, ..Level::pixels(1.0, camera(eye)) });
                compare(&nets, &levels, &shared(whole))
            }
            Frames => {
                let level = |tolerance| Level { hysteresis: 0.5, ..Level::world(tolerance) };
                let levels = [0.02, 0.03, 0.2, 0.12, 0.07, 0.045, 0.02, 0.5, 0.8].map(level);
                compare(&file("teapot.bpt", false), &levels, &shared(packed))
            }
            Budget => {
                let level = |budget| Level { budget, ..Level::world(0.02) };
                let levels = [Some(3_000), Some(2_000), Some(2_000), Some(4_000), None].map(level);
                compare(&file("teapot.bpt", false), &levels, &shared(whole))
            }
            Slab => super::slabs::difference(engine),
            Word => {
                let (nets, options) = (sets::torus(2, 1, 3), Options { format: whole, seams: true });
                let level = Level { depth: 0..=7, ..Level::world(0.3) };
                [9, 10, 11].into_iter().find_map(|seed| {
                    let word = sets::word(nets.len() as u32, seed);
                    let mut cpu = Cpu::of_word(&nets, &word, Some(1), &options).expect("a word");
                    cpu.run(&level.target().expect("a level"));
                    let gpu = Tessellator::of_word(engine, &nets, &word, Some(1), &level, &options, &ROOM);
                    difference(&cpu, &submit(engine, &mut gpu.expect("a word")))
                })
            }
            Placed => {
                let sets = [
                    (sets::scrambled(&file("teapot.bpt", false), 5).0, 0.2),
                    (sets::book(5, 3), 0.2),
                    (sets::torus(1, 1, 4), 0.4),
                    (sets::degenerate(), 10.0),
                ];
                sets.iter().find_map(|(nets, tolerance)| {
                    [false, true].into_iter().find_map(|seams| {
                        let (level, options) = (Level::world(*tolerance), Options { format: whole, seams });
                        let cpu = displaced(nets, &level, &options, WILD);
                        let mut gpu = Tessellator::new(engine, nets, &level, &options, &ROOM).expect("a set");
                        gpu.displace(&plan_of(WILD), &Default::default()).expect("a placement");
                        difference(&cpu, &submit(engine, &mut gpu))
                    })
                })
            }
            PlacedOn => {
                let level = Level { depth: 0..=7, ..Level::world(0.05) };
                let of_word = |(on, seams)| {
                    let (plan, word, nets) = checkered(on);
                    let options = Options { format: whole, seams };
                    let cpu = super::placement::of_word(&nets, &word, plan.hole, &plan, &options, 0.05);
                    let gpu = Tessellator::of_word(engine, &nets, &word, plan.hole, &level, &options, &ROOM);
                    let mut gpu = gpu.expect("a word");
                    gpu.displace(&plan, &Default::default()).expect("a placement");
                    difference(&cpu, &submit(engine, &mut gpu))
                };
                let values = || {
                    let (nets, level) = (file("teapot.bpt", false), Level::world(0.2));
                    let mut cpu = Cpu::new(&nets, &shared(whole)).expect("a set");
                    cpu.displace(&plan_of(HIGH), &heights()).expect("values");
                    cpu.run(&level.target().expect("a level"));
                    let gpu = Tessellator::new(engine, &nets, &level, &shared(whole), &ROOM);
                    let mut gpu = gpu.expect("a set");
                    gpu.displace(&plan_of(HIGH), &heights()).expect("values");
                    difference(&cpu, &submit(engine, &mut gpu))
                };
                [("R", false), ("P", true)].into_iter().find_map(of_word).or_else(values)
            }
            Room => {
                let (nets, options) = (sets::torus(3, 3, 11), shared(whole));
                let level = Level::world(0.1);
                let cpu = tessellated(&nets, &level, &options);
                let exact = Capacity::of(cpu.status());
                let room = Capacity { nodes: exact.nodes - 4, ..exact };
                let mut gpu = Tessellator::new(engine, &nets, &level, &options, &exact).expect("a set");
                let first = difference(&cpu, &submit(engine, &mut gpu));
                let mut gpu = Tessellator::new(engine, &nets, &level, &options, &room).expect("a set");
                let s = submit(engine, &mut gpu).status;
                let wrong = s.nodes != exact.nodes || s.node_capacity != room.nodes;
                let few = super::device::try_closed(engine, &mut gpu, room.nodes);
                // Nine roots are split, and there is room for the children of one.
                let least = Capacity { nodes: 13, ..exact };
                let mut gpu = Tessellator::new(engine, &nets, &level, &options, &least).expect("a set");
                let known = submit(engine, &mut gpu).status.nodes;
                let known = (known != 45).then(|| format!("{known} nodes after one level of 9 roots"));
                first.or_else(|| wrong.then(|| format!("{s:?} for {exact:?}"))).or(few).or(known)
            }
        }
    }
}

#[test]
fn every_mutant_of_a_tessellation_is_seen() {
    let Some(headless) = device::headless() else { return };
    let engine = Engine::new(&headless.device, &headless.queue).keeping_kernels();
    for check in [Roots, Word, Pixels, Frames, Room, Rational, FarOff, Budget, Slab, Placed, PlacedOn] {
        assert_eq!(check.run(&engine), None, "{check:?} without a mutant");
    }
    let unseen = |&(file, find, replace, check): &Mutant| {
        let unseen = mutants::unseen(&engine, (file, find, replace), |engine| check.run(engine))?;
        Some(format!("{unseen} by {check:?}"))
    };
    // In a sample one of each file, and one for each check.
    let kinds = |(file, .., check): &Mutant| vec![file.to_string(), format!("{check:?}")];
    let sample = tier::sample(MUTANTS.iter().copied(), kinds);
    mutants::assert_seen(sample.iter().filter_map(unseen));
}

#[test]
fn every_file_has_mutants() {
    for folder in ["wgsl/tessellate", "wgsl/tessellate/shared"] {
        for entry in std::fs::read_dir(folder).expect("the kernels") {
            let path = entry.expect("an entry").path();
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let broken = MUTANTS.iter().any(|m| m.0 == name) || super::rules::breaks(&name);
            assert!(path.is_dir() || broken, "{name} has no mutant");
        }
    }
}
