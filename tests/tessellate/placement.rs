//! Displaced tessellations: closed forms, no cracks with whatever the expression reads, the same at every level and
//! in every orientation, and on devices as on the CPU.

use super::invariants::check;
use super::sets::{self, book, degenerate, reoriented, scrambled, torus};
use super::{derived, file};
use burgeon::cpu;
use burgeon::cpu::tessellate::Tessellator;
use burgeon::language::elementary::{hash, unit};
use burgeon::language::{System, Value};
use burgeon::patch::{Axiom, Grid, Net, Values, Word};
use burgeon::plan::{self, Plan};
use burgeon::tessellate::passes::Corner;
use burgeon::tessellate::vertex::{Format, Tangent};
use burgeon::tessellate::{Level, Options};
use std::collections::{HashMap, HashSet};

/// What hangs on everything that an expression may see.
pub const WILD: &str = "p + normal * (0.1 * noise(3 * p) + 0.05 * rand(-1, 1)) \
    + frame * (0.05 * uv.x, 0.03 * uv.y * randn(), 0.02 * scale) + (0, 0.02 * float(id), 0.1 * distance(p, old))";

/// The same but for what a file's orientation decides; normals of one sign are as good as of the other.
const UNORIENTED: &str = "p + normal * dot(normal, (0.1, 0.2, -0.1)) * noise(2 * p) + (0, 0.05 * scale, 0) \
    * noise(3 * p) + (0.01, 0, 0) * float(id)";

/// A plan that displaces by an expression with the params a and b.
pub fn plan_of(expression: &str) -> Plan {
    let text = format!(
        "system s : patch bezier 3\nparam a: float = 0.25 in 0 .. 2\nparam b: float = 0.1\n\
         query Height(h: float)\nmodule P\naxiom: P = file \"x.bpt\"\nplace d = {expression}\nrun:\n  place d\n"
    );
    Plan::new(&System::parse(&text).expect(expression)).expect(expression)
}

pub fn displaced(nets: &[Net], level: &Level, options: &Options, expression: &str) -> Tessellator {
    let mut t = Tessellator::new(nets, options).expect("a set");
    t.displace(&plan_of(expression), &plan::Options::default()).expect(expression);
    t.run(&level.target().expect("a level"));
    t
}

/// Where the corners of all triangles lie, in order: root, lattice point, and index.
fn corners(t: &Tessellator) -> Vec<((u32, [u32; 2]), usize)> {
    let tree = t.tree();
    let mut all = Vec::new();
    for node in (0..tree.nodes.len() as u32).filter(|&n| tree.is_leaf(n)) {
        tree.triangles(node, t.trees().marks[node as usize], |triangle| {
            let (corners, cell) = tree.corners(node, triangle);
            let mirrored = t.topology().orientation(tree.nodes[cell as usize].root).mirrors();
            let first = all.len();
            for (k, corner) in corners.into_iter().enumerate() {
                let k = if mirrored { [0, 2, 1][k] } else { k };
                let place = match corner {
                    Corner::At { root, p } => (root, p),
                    Corner::Centre { node } => {
                        let node = &tree.nodes[node as usize];
                        (node.root, node.centre())
                    }
                };
                all.push((place, t.out().indices[first + k] as usize));
            }
        });
    }
    all
}

fn bits(positions: &[[f32; 3]]) -> Vec<[u32; 3]> {
    positions.iter().map(|p| p.map(f32::to_bits)).collect()
}

/// Position bits of all corners of all triangles.
fn placed_corners(t: &Tessellator) -> Vec<[u32; 3]> {
    let positions = bits(&t.mesh().positions);
    t.out().indices.iter().map(|&i| positions[i as usize]).collect()
}

/// The mesh is closed, and that of patches with vertices of their own lies on it, to the bit.
fn no_crack(what: &str, nets: &[Net], make: &dyn Fn(&Options) -> Tessellator) {
    let shared = make(&Options::default());
    assert!(shared.is_displaced());
    check(&shared, nets, None);
    assert!(shared.mesh().positions.iter().flatten().all(|x| x.is_finite()), "{what}");
    let apart = make(&Options { seams: true, ..Options::default() });
    assert_eq!(shared.trees().nodes, apart.trees().nodes, "{what}");
    assert!(apart.status().vertices >= shared.status().vertices);
    let (a, b) = (placed_corners(&shared), placed_corners(&apart));
    let differs = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    assert!(a.len() == b.len() && differs == 0, "{what}: {differs} of {} corners lie apart", a.len());
    for normal in shared.mesh().normals.iter().chain(&apart.mesh().normals) {
        let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-5, "{what}: a normal {length} long");
    }
}

#[test]
fn a_displaced_surface_has_no_crack_whatever_moves_it() {
    let teapot = file("teapot.bpt", false);
    let cases: Vec<(&str, Vec<Net>, Vec<f32>)> = vec![
        ("teapot", teapot.clone(), vec![0.5, 0.03]),
        ("scrambled teapot", scrambled(&teapot, 3).0, vec![0.05]),
        ("sphere", file("sphere.bpt", true), vec![0.3, 0.01]),
        ("torus", file("torus.bpt", true), vec![0.05]),
        ("one patch closed both ways", torus(1, 1, 4), vec![0.3]),
        ("random torus", torus(2, 1, 7), vec![0.2]),
        ("random torus of nine", scrambled(&torus(3, 3, 8), 5).0, vec![0.1]),
        ("book", book(5, 3), vec![10.0, 0.1]),
        ("degenerate", degenerate(), vec![0.1]),
    ];
    for (name, nets, tolerances) in &cases {
        for &tolerance in tolerances {
            let level = Level::world(tolerance);
            no_crack(name, nets, &|options| displaced(nets, &level, options, WILD));
        }
    }
}

#[test]
fn words_with_holes_are_displaced_without_a_crack() {
    for name in ["holes", "fractal", "sierpinski2"] {
        let (plan, word, nets) = derived(name, &[]);
        no_crack(name, &nets, &|options| of_word(&nets, &word, plan.hole, &plan_of(WILD), options, 0.1));
    }
    let nets = torus(2, 1, 3);
    for seed in 0..6 {
        let word = sets::word(2, seed);
        no_crack("random word", &nets, &|options| {
            of_word(&nets, &word, Some(1), &plan_of(WILD), options, 0.3)
        });
    }
}

pub fn of_word(
    nets: &[Net],
    word: &Word,
    hole: Option<usize>,
    plan: &Plan,
    options: &Options,
    tolerance: f32,
) -> Tessellator {
    let mut t = Tessellator::of_word(nets, word, hole, options).expect("a word");
    t.displace(plan, &plan::Options::default()).expect("a placement");
    t.run(&Level { depth: 0..=7, ..Level::world(tolerance) }.target().expect("a level"));
    t
}

/// Where a point of the surface goes does not hang on how finely it is cut, nor on which leaf owns it then.
#[test]
fn vertices_stay_where_they_are_when_the_level_changes() {
    for (name, nets) in [
        ("teapot", file("teapot.bpt", false)),
        ("torus", torus(2, 2, 7)),
        ("sphere", file("sphere.bpt", true)),
    ] {
        let places = |level: &Level| {
            let t = displaced(&nets, level, &Options::default(), WILD);
            let (positions, mut known) = (bits(&t.mesh().positions), HashMap::new());
            for (place, index) in corners(&t) {
                let before = known.insert(place, positions[index]);
                assert!(before.is_none_or(|b| b == positions[index]), "{name}: one point in two places");
            }
            known
        };
        let fine = places(&Level { depth: 4..=9, ..Level::world(0.01) });
        let mut seen = 0;
        for tolerance in [1.0, 0.2, 0.05] {
            for (place, position) in places(&Level::world(tolerance)) {
                if let Some(again) = fine.get(&place) {
                    assert_eq!(position, *again, "{name}: {place:?} moves");
                    seen += 1;
                }
            }
        }
        assert!(seen > 100, "{name}: only {seen} points in common");
    }
}

#[test]
fn no_orientation_of_the_file_changes_where_vertices_go() {
    let nets = file("teapot.bpt", false);
    let level = Level::world(0.03);
    let first = displaced(&nets, &level, &Options::default(), UNORIENTED);
    for seed in 0..6 {
        let (turned, _) = scrambled(&nets, seed);
        let again = displaced(&turned, &level, &Options::default(), UNORIENTED);
        assert_eq!(first.trees(), again.trees());
        assert_eq!(bits(&first.mesh().positions), bits(&again.mesh().positions));
        // Normals have the sign that the file gives them.
        for (a, b) in first.mesh().normals.iter().zip(&again.mesh().normals) {
            let cosine = (0..3).map(|k| a[k] * b[k]).sum::<f32>().abs();
            assert!(cosine > 0.999, "{a:?} and {b:?}");
        }
    }
}

#[test]
fn the_same_input_gives_the_same_displaced_bytes() {
    let nets = file("teapot.bpt", false);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| displaced(&nets, &Level::world(0.05), &Options::default(), WILD).out().clone())
    };
    assert_eq!(run(1), run(1));
    assert_eq!(run(1), run(3));
}

/// The plane patch 3 wide along u and 2 along v.
fn flat() -> Net {
    let points = (0..16).map(|k| [(k / 4) as f32, (k % 4) as f32 * 2.0 / 3.0, 0.0, 1.0]);
    Net { degree: [3, 3], points: points.collect() }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit_of(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

#[track_caller]
fn near(found: impl IntoIterator<Item = f32>, wanted: impl IntoIterator<Item = f64>, most: f64, what: &str) {
    let (found, wanted): (Vec<f32>, Vec<f64>) = (found.into_iter().collect(), wanted.into_iter().collect());
    let apart = found.iter().zip(&wanted).map(|(&a, b)| (f64::from(a) - b).abs()).fold(0.0, f64::max);
    assert!(apart <= most && found.len() == wanted.len(), "{what}: {found:?} for {wanted:?}");
}

/// All attributes in floats: position, normal, tangent, uv.
fn with_tangents() -> Options {
    let format = Format { tangent: Some(Tangent::Float), ..Format::default() };
    Options { format, ..Options::default() }
}

/// Position, normal, tangent and uv of each vertex.
fn vertices(t: &Tessellator) -> impl Iterator<Item = [f32; 12]> {
    let words: &[[u32; 12]] = bytemuck::cast_slice(&t.out().vertices);
    words.iter().map(|w| w.map(f32::from_bits))
}

#[test]
fn a_plane_becomes_the_wave_that_its_expression_says() {
    let level = Level { depth: 4..=4, ..Level::world(0.01) };
    let wave = "p + normal * (b * sin(tau * uv.x) * cos(pi * uv.y))";
    // The same with the sum the other way round, without any, and in the frame.
    let others = [
        "normal * (b * sin(tau * uv.x) * cos(pi * uv.y)) + old",
        "1.0 * p + normal * (b * sin(tau * uv.x) * cos(pi * uv.y))",
        "p - frame * (0, 0, -(b * sin(tau * uv.x) * cos(pi * uv.y)))",
    ];
    let mut seen = HashSet::new();
    for choice in 0..24 {
        let (nets, mirrored) = reoriented(&[flat()], choice);
        seen.insert(format!("{nets:?}"));
        let expression = if choice < 16 { wave } else { others[choice as usize % 3] };
        let t = displaced(&nets, &level, &with_tangents(), expression);
        let corner = |k: usize| [0, 1, 2].map(|c| f64::from(nets[0].points[k][c]));
        let (origin, along_u, along_v) = (corner(0), corner(12), corner(3));
        let [su, sv] = [along_u, along_v].map(|end| [0, 1, 2].map(|k| end[k] - origin[k]));
        let up = if mirrored[0] { -1.0 } else { 1.0 };
        assert_eq!(unit_of(cross(su, sv)), [0.0, 0.0, up]);
        let tau = std::f64::consts::TAU;
        for v in vertices(&t) {
            let [x, y] = [f64::from(v[10]), f64::from(v[11])];
            let (wave_x, wave_y) = ((tau * x).sin_cos(), (tau / 2.0 * y).sin_cos());
            let h = 0.1 * wave_x.0 * wave_y.1;
            let slope = [0.1 * tau * wave_x.1 * wave_y.1, -0.1 * tau / 2.0 * wave_x.0 * wave_y.0];
            let along = |s: [f64; 3], slope: f64| [s[0], s[1], s[2] + up * slope];
            let (du, dv) = (along(su, slope[0]), along(sv, slope[1]));
            let position = [0, 1, 2].map(|k| origin[k] + x * su[k] + y * sv[k] + [0.0, 0.0, up * h][k]);
            near([v[0], v[1], v[2]], position, 2e-6, expression);
            let normal = unit_of(cross(du, dv));
            let exact = if expression.starts_with("1.0") { 2e-3 } else { 1e-4 };
            near([v[3], v[4], v[5]], normal, exact, expression);
            near([v[6], v[7], v[8]], unit_of(du), exact, expression);
        }
        assert_eq!(t.status().vertices, 17 * 17);
    }
    assert_eq!(seen.len(), 8, "all orientations");
}

/// Across a groove along the curve of two patches, both walls steeper than 45°, the normal is that of the plane.
#[test]
fn the_normal_in_a_groove_is_the_mean_of_its_walls() {
    let mut other = flat();
    other.points.iter_mut().for_each(|p| p[0] += 3.0);
    let nets = [flat(), other];
    let level = Level { depth: 4..=4, ..Level::world(0.01) };
    let t = displaced(&nets, &level, &Options::default(), "p + normal * 5 * min(uv.x, 1 - uv.x)");
    let mesh = t.mesh();
    let mut seen = [0; 2];
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        if p[0] == 3.0 {
            near(*n, [0.0, 0.0, 1.0], 1e-4, "a groove");
            seen[0] += 1;
        } else if p[0] < 1.4 {
            near(*n, unit_of([-5.0 / 3.0, 0.0, 1.0]), 1e-4, "a wall");
            seen[1] += 1;
        }
    }
    assert_eq!(seen, [17, 8 * 17]);
}

#[test]
fn axes_are_those_of_u_and_v_and_the_scale_is_that_of_the_root() {
    let level = Level { depth: 2..=2, ..Level::world(0.01) };
    for choice in 0..12 {
        let (nets, mirrored) = reoriented(&[flat()], choice);
        let up = if mirrored[0] { -1.0f64 } else { 1.0 };
        let corner = |k: usize| [0, 1, 2].map(|c| f64::from(nets[0].points[k][c]));
        let axis = |end: usize| unit_of([0, 1, 2].map(|k| corner(end)[k] - corner(0)[k]));
        let (u, v) = (axis(12), axis(3));
        let t = displaced(&nets, &level, &Options::default(), "p + frame * (2, 3, scale)");
        let plain = super::tessellated(&nets, &level, &Options::default());
        let scale = 13f64.sqrt();
        for (found, smooth) in t.mesh().positions.iter().zip(&plain.mesh().positions) {
            let wanted =
                [0, 1, 2].map(|k| f64::from(smooth[k]) + 2.0 * u[k] + 3.0 * v[k] + [0.0, 0.0, up * scale][k]);
            near(*found, wanted, 2e-6, "a frame");
        }
    }
}

#[test]
fn a_sphere_that_grows_is_a_sphere_and_one_with_a_lobe_has_its_normals() {
    let nets = file("sphere.bpt", true);
    for seams in [false, true] {
        let options = Options { seams, ..Options::default() };
        let t = displaced(&nets, &Level::world(0.01), &options, "p + normal * a");
        for (p, n) in t.mesh().positions.iter().zip(&t.mesh().normals) {
            let p = p.map(f64::from);
            near([p.iter().map(|x| x * x).sum::<f64>().sqrt() as f32], [1.25], 1e-6, "a radius");
            near(*n, unit_of(p), 2e-4, "a normal");
        }
        // r(d) = 1.25 + d.x / 10: the normal is r d - (the part of the gradient along the sphere).
        let t = displaced(&nets, &Level::world(0.01), &options, "p + normal * (a + b * p.x)");
        let poles: Vec<[f32; 3]> = nets.iter().flat_map(poles).collect();
        let mut seen = 0;
        for (p, n) in t.mesh().positions.iter().zip(&t.mesh().normals) {
            let d = unit_of(p.map(f64::from));
            let r = 1.25 + 0.1 * d[0];
            near(*p, d.map(|x| r * x), 1e-6, "a position");
            let gradient = [0, 1, 2].map(|k| [0.1, 0.0, 0.0][k] - 0.1 * d[0] * d[k]);
            let normal = unit_of([0, 1, 2].map(|k| r * d[k] - gradient[k]));
            // Where a side of the patches is a point there is no slope along it: the smooth normal stands.
            if poles.iter().any(|q| (0..3).all(|k| (f64::from(q[k]) - d[k]).abs() < 1e-6)) {
                near(*n, d, 0.1, "a pole's normal");
            } else {
                near(*n, normal, 5e-4, "a normal");
                seen += 1;
            }
        }
        assert!(seen > 500, "{seen} vertices");
    }
}

/// Corners of a net that are whole sides.
fn poles(net: &Net) -> Vec<[f32; 3]> {
    let [m, n] = net.degree.map(usize::from);
    let at = |i: usize, j: usize| {
        let [x, y, z, w] = net.points[i * (n + 1) + j];
        [x / w, y / w, z / w]
    };
    let sides = [[(0, 0), (0, n)], [(m, 0), (m, n)], [(0, 0), (m, 0)], [(0, n), (m, n)]];
    sides.iter().filter(|[a, b]| at(a.0, a.1) == at(b.0, b.1)).map(|[a, _]| at(a.0, a.1)).collect()
}

/// Random numbers hang on the seed, the point as the file has it, the placement's name and the call.
#[test]
fn random_numbers_are_those_of_the_point() {
    let level = Level { depth: 3..=3, ..Level::world(0.01) };
    let plan = plan_of("p + (rand(), rand(2, 4), 0)");
    let site = "d".bytes().fold(0x811c_9dc5u32, |h, b| (h ^ u32::from(b)).wrapping_mul(0x0100_0193));
    for choice in 0..6 {
        let (nets, _) = reoriented(&[flat()], choice);
        for seed in [0, 77] {
            let mut t = Tessellator::new(&nets, &Options::default()).expect("a set");
            t.displace(&plan, &plan::Options { seed: Some(seed), ..Default::default() })
                .expect("a placement");
            t.run(&level.target().expect("a level"));
            let plain = super::tessellated(&nets, &level, &Options::default());
            let (moved, mesh) = (t.mesh(), plain.mesh());
            for ((found, smooth), uv) in moved.positions.iter().zip(&mesh.positions).zip(&mesh.uvs) {
                let [x, y] = uv.map(|x| (x * (1 << 24) as f32) as u32);
                let drawn =
                    |call| unit([0, x, y, site, call].into_iter().fold(seed, |h: u32, word| hash(h, word)));
                assert_eq!(*found, [smooth[0] + drawn(0), smooth[1] + (2.0 + 2.0 * drawn(1)), smooth[2]]);
            }
        }
    }
}

/// A word of two symbols, cut by rules, and holes.
pub fn checkered(on: &str) -> (Plan, Word, Vec<Net>) {
    let text = format!(
        "system s : patch bezier 3\nmodule P, Q, R\naxiom: P = file \"x.bpt\"\nplace d on {on} = p + (0, 0, 50)\n\
         rules:\n  P -> [ Q P ; P eps ]\n  Q -> [ R [ Q R ; R R ] ; R R ]\nrun:\n  derive 2\n  place d\n"
    );
    let system = System::parse(&text).expect("a system");
    let plan = Plan::keeping_holes(&system).expect("a plan");
    let nets = scrambled(&torus(3, 3, 5), 4).0;
    let axiom = Axiom::load(&system, &mut |_| Ok::<_, String>(nets.clone())).expect("an axiom");
    let (word, _) = cpu::derive(&plan, &axiom, &plan::Options::default(), 0).expect("a word");
    (plan, word, nets)
}

#[test]
fn only_what_lies_wholly_on_the_symbols_is_moved() {
    for on in ["P", "Q", "R", "P, Q", "P, Q, R"] {
        let (plan, word, nets) = checkered(on);
        let wanted: Vec<u32> =
            on.split(", ").map(|s| ["P", "Q", "R"].iter().position(|&n| n == s).unwrap() as u32).collect();
        for seams in [false, true] {
            let options = Options { seams, ..Options::default() };
            let t = of_word(&nets, &word, plan.hole, &plan, &options, 0.05);
            let shared = of_word(&nets, &word, plan.hole, &plan, &Options::default(), 0.05);
            // Which points are which vertex, when patches share them.
            let mut labels: HashMap<usize, Vec<(u32, [u32; 2])>> = HashMap::new();
            for (place, index) in corners(&shared) {
                labels.entry(index).or_default().push(place);
            }
            let tree = shared.tree();
            let leaves: Vec<_> =
                (0..tree.nodes.len()).filter(|&n| tree.is_leaf(n as u32)).map(|n| tree.nodes[n]).collect();
            let moves = |labels: &[(u32, [u32; 2])]| {
                leaves.iter().filter(|leaf| !leaf.is_hole()).all(|leaf| {
                    let inside = |p: &[u32; 2]| {
                        (0..2).all(|k| leaf.low()[k] <= p[k] && p[k] <= leaf.low()[k] + leaf.size()[k])
                    };
                    wanted.contains(&leaf.symbol())
                        || !labels.iter().any(|(root, p)| *root == leaf.root && inside(p))
                })
            };
            let moved: HashMap<usize, bool> = labels.iter().map(|(&v, labels)| (v, moves(labels))).collect();
            let mesh = t.mesh();
            let mut counts = [0; 2];
            for ((_, own), (_, v)) in corners(&t).into_iter().zip(corners(&shared)) {
                let z = mesh.positions[own][2];
                assert_eq!(z > 25.0, moved[&v], "{on}: vertex {own} at {z}");
                counts[usize::from(moved[&v])] += 1;
            }
            assert!(counts[1] > 100 && (counts[0] > 100 || on == "P, Q, R"), "{on}: {counts:?}");
        }
    }
}

/// A grid over the teapot.
pub fn heights() -> plan::Options<'static> {
    let values = (0..2 * 3 * 2).map(|n| Value::Float(n as f32 * 0.05)).collect();
    let grid = Grid { size: [2, 3, 2], from: [-4.0, 0.0, -3.0], to: [4.0, 4.0, 3.0], values };
    plan::Options { bind: vec![("Height".to_string(), Values::Grid(grid))], ..Default::default() }
}

pub const HIGH: &str = "p + (0, Height(p), 0)";

#[test]
fn values_of_the_host_displace() {
    let nets = file("teapot.bpt", false);
    let level = Level::world(0.1);
    let mut t = Tessellator::new(&nets, &Options::default()).expect("a set");
    t.displace(&plan_of(HIGH), &heights()).expect("values");
    t.run(&level.target().expect("a level"));
    let plain = super::tessellated(&nets, &level, &Options::default());
    for (found, smooth) in t.mesh().positions.iter().zip(&plain.mesh().positions) {
        let [x, y, z] = smooth.map(f64::from);
        // The grid is linear: x counts one point, y two, z six.
        let height = ((x + 4.0) / 8.0 + y.clamp(0.0, 4.0) / 2.0 * 2.0 + (z + 3.0) / 6.0 * 6.0) * 0.05;
        near(*found, [x, y + height, z], 2e-6, "a height");
    }
    let error = t.displace(&plan_of(HIGH), &plan::Options::default()).expect_err("nothing bound");
    assert!(error.to_string().contains("nothing is bound to the query Height; it wants a grid"), "{error}");
}

#[test]
fn params_change_between_frames_and_wrong_ones_are_refused() {
    let nets = file("teapot.bpt", false);
    let target = Level::world(0.1).target().expect("a level");
    let set = |list: &[(&str, f32)]| -> Vec<(String, Value)> {
        list.iter().map(|&(name, value)| (name.to_string(), Value::Float(value))).collect()
    };
    let fresh = |list: &[(&str, f32)]| {
        let mut t = Tessellator::new(&nets, &Options::default()).expect("a set");
        let options = plan::Options { set: set(list), ..Default::default() };
        t.displace(&plan_of("p + normal * (a + b)"), &options).expect("params");
        t.run(&target);
        t.out().clone()
    };
    let mut t = Tessellator::new(&nets, &Options::default()).expect("a set");
    let nothing = t.set_params(&set(&[("a", 1.0)])).expect_err("nothing is displaced").to_string();
    assert!(nothing.contains("`a` cannot be set: no placement displaces"), "{nothing}");
    t.set_params(&[]).expect("nothing is set");
    let options = plan::Options { set: set(&[("b", 0.5)]), ..Default::default() };
    t.displace(&plan_of("p + normal * (a + b)"), &options).expect("params");
    t.run(&target);
    assert_eq!(*t.out(), fresh(&[("b", 0.5)]));
    t.set_params(&set(&[("a", 1.5)])).expect("in its range");
    t.run(&target);
    // What was set before stays.
    assert_eq!(*t.out(), fresh(&[("a", 1.5), ("b", 0.5)]));
    for (wrong, said) in [
        (("a", Value::Float(3.0)), "param a = 3 lies outside 0 .. 2"),
        (("a", Value::Bool(true)), "param a is of type float, not bool"),
        (("c", Value::Float(0.0)), "`c` is no param of s; it has a, b"),
    ] {
        let error = t.set_params(&[(wrong.0.to_string(), wrong.1)]).expect_err(said).to_string();
        assert!(error.contains(said), "{error}");
    }
    t.run(&target);
    assert_eq!(*t.out(), fresh(&[("a", 1.5), ("b", 0.5)]));
    // Ints are floats, and a plan without a placement displaces nothing.
    t.set_params(&[("a".to_string(), Value::Int(1))]).expect("an int");
    let (plain, _, _) = derived("teapot", &[]);
    assert!(plain.placement.is_none());
    t.displace(&plain, &plan::Options::default()).expect("nothing");
    assert!(!t.is_displaced());
    t.run(&target);
    assert_eq!(t.out(), super::tessellated(&nets, &Level::world(0.1), &Options::default()).out());
}

/// The word is the same with a placement or without.
#[test]
fn a_placement_leaves_the_word_alone() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let text = std::fs::read_to_string(format!("{folder}/fractal.burgeon")).expect("an example");
    let placed = text.replacen("run:", "place d = p * 2 + normal * rand()\nrun:", 1) + "  place d\n";
    let word = |text: &str| {
        let system = System::parse(text).expect("a system");
        let plan = Plan::new(&system).expect("a plan");
        let mut read = |file: &str| burgeon::io::bpt::read(format!("{folder}/{file}"), plan.rational());
        let axiom = Axiom::load(&system, &mut read).expect("an axiom");
        (
            plan.placement.is_some(),
            cpu::derive(&plan, &axiom, &plan::Options::default(), 0).expect("a word").0,
        )
    };
    let (plain, placed) = (word(&text), word(&placed));
    assert_eq!((plain.0, placed.0), (false, true));
    assert_eq!(plain.1, placed.1);
}

#[cfg(feature = "gpu")]
mod on_devices {
    use super::super::device::{ROOM, difference, submit};
    use super::*;
    use crate::device;
    use burgeon::gpu::Engine;
    use burgeon::gpu::tessellate::{Capacity, Tessellator as Gpu};

    fn same(cpu: &Tessellator, gpu: &mut Gpu, engine: &Engine, what: &str) {
        assert_eq!(difference(cpu, &submit(engine, gpu)), None, "{what}");
    }

    #[test]
    fn cpu_and_gpu_displace_alike() {
        let [whole, packed, bare] = super::super::kernels::formats();
        for (name, engine) in device::engines() {
            let cases: Vec<(&str, Vec<Net>, f32, Format)> = vec![
                ("teapot", scrambled(&file("teapot.bpt", false), 3).0, 0.03, Format::default()),
                ("teapot, all attributes", file("teapot.bpt", false), 0.1, whole),
                ("teapot, apart", file("teapot.bpt", false), 0.1, Format { separate: true, ..whole }),
                ("positions", file("teapot.bpt", false), 0.1, bare),
                ("sphere", file("sphere.bpt", true), 0.02, whole),
                ("random torus", torus(2, 1, 7), 0.2, whole),
                ("book", book(5, 3), 0.1, Format::default()),
                ("degenerate", degenerate(), 0.1, Format::default()),
            ];
            assert!(packed.normal.is_some());
            for (set, nets, tolerance, format) in cases {
                let (level, what) = (Level::world(tolerance), format!("{set} on {name}"));
                for seams in [false, true] {
                    let options = Options { format, seams };
                    let cpu = displaced(&nets, &level, &options, WILD);
                    let mut gpu = Gpu::new(&engine, &nets, &level, &options, &ROOM).expect(&what);
                    gpu.displace(&plan_of(WILD), &plan::Options::default()).expect(&what);
                    if format.separate {
                        gpu.set_capacity(&Capacity::of(cpu.status())).expect("room");
                    }
                    same(&cpu, &mut gpu, &engine, &what);
                }
            }
        }
    }

    #[test]
    fn words_symbols_and_values_displace_alike() {
        let Some(headless) = device::headless() else { return };
        let engine = Engine::new(&headless.device, &headless.queue);
        let level = Level { depth: 0..=7, ..Level::world(0.05) };
        for (on, seams) in [("Q", false), ("R", true), ("P, Q", true)] {
            let (plan, word, nets) = checkered(on);
            let options = Options { seams, ..Options::default() };
            let cpu = of_word(&nets, &word, plan.hole, &plan, &options, 0.05);
            let mut gpu =
                Gpu::of_word(&engine, &nets, &word, plan.hole, &level, &options, &ROOM).expect("a word");
            gpu.displace(&plan, &plan::Options::default()).expect("a placement");
            same(&cpu, &mut gpu, &engine, on);
        }
        let (nets, level) = (file("teapot.bpt", false), Level::world(0.1));
        let mut cpu = Tessellator::new(&nets, &Options::default()).expect("a set");
        cpu.displace(&plan_of(HIGH), &heights()).expect("values");
        cpu.run(&level.target().expect("a level"));
        let mut gpu = Gpu::new(&engine, &nets, &level, &Options::default(), &ROOM).expect("a set");
        gpu.displace(&plan_of(HIGH), &heights()).expect("values");
        same(&cpu, &mut gpu, &engine, "heights");
        // And the grid is there in other room, too.
        gpu.set_capacity(&Capacity::of(cpu.status())).expect("room");
        cpu.run(&level.target().expect("a level"));
        same(&cpu, &mut gpu, &engine, "heights in other room");
    }

    #[test]
    fn params_are_written_to_the_device() {
        let Some(headless) = device::headless() else { return };
        let engine = Engine::new(&headless.device, &headless.queue);
        let (nets, level) = (file("teapot.bpt", false), Level::world(0.1));
        let target = level.target().expect("a level");
        let plan = plan_of("p + normal * (a * noise(4 * p) + b)");
        let mut cpu = Tessellator::new(&nets, &Options::default()).expect("a set");
        let mut gpu = Gpu::new(&engine, &nets, &level, &Options::default(), &ROOM).expect("a set");
        let one = |name: &str, value: f32| [(name.to_string(), Value::Float(value))];
        assert!(gpu.set_params(&one("a", 1.0)).is_err());
        gpu.set_params(&[]).expect("nothing is set");
        for t in [true, false] {
            let options = plan::Options { seed: Some(u32::from(t)), ..Default::default() };
            cpu.displace(&plan, &options).expect("a placement");
            gpu.displace(&plan, &options).expect("a placement");
            for (name, value) in [("a", 0.5), ("b", 0.3), ("a", 0.0)] {
                cpu.set_params(&one(name, value)).expect("a param");
                gpu.set_params(&one(name, value)).expect("a param");
                cpu.run(&target);
                same(&cpu, &mut gpu, &engine, name);
            }
            let said = gpu.set_params(&one("a", 3.0)).expect_err("out of range").to_string();
            assert!(said.contains("lies outside 0 .. 2"), "{said}");
            cpu.run(&target);
            same(&cpu, &mut gpu, &engine, "as before");
            // Frozen triangles follow the params.
            gpu.freeze(true);
            cpu.set_params(&one("b", 0.7)).expect("a param");
            gpu.set_params(&one("b", 0.7)).expect("a param");
            cpu.dice();
            let frame = submit(&engine, &mut gpu);
            assert_eq!(difference(&cpu, &frame), None, "frozen");
            gpu.freeze(false);
        }
        // And nothing is displaced by a plan without a placement.
        let (plain, _, _) = derived("teapot", &[]);
        gpu.displace(&plain, &plan::Options::default()).expect("nothing");
        let mut fresh = Gpu::new(&engine, &nets, &level, &Options::default(), &ROOM).expect("a set");
        assert!(submit(&engine, &mut gpu).vertices == submit(&engine, &mut fresh).vertices, "smooth again");
    }
}
