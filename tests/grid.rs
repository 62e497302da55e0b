//! Points and normals of nets, and the grids made of them.

use burgeon::io::bpt;
use burgeon::patch::{Cell, Net, Parameter, Word, net_points};
use burgeon::tessellate::{Mesh, dice, grid};
use proptest::prelude::*;
use std::collections::HashMap;

type V3 = [f64; 3];

fn teapot() -> Vec<Net> {
    bpt::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/teapot.bpt"), false).expect("the teapot")
}

fn word(nets: &[Net]) -> Word {
    Word::from_nets("test", "P", nets).expect("a word")
}

fn net(degree: [u8; 2], point: impl Fn(f64, f64) -> [f64; 4]) -> Net {
    let [m, n] = degree;
    let points = (0..=m).flat_map(|i| (0..=n).map(move |j| (i, j)));
    let at = |(i, j)| point(f64::from(i) / f64::from(m), f64::from(j) / f64::from(n)).map(|x| x as f32);
    Net { degree, points: points.map(at).collect() }
}

fn subtract(a: V3, b: V3) -> V3 {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: V3) -> V3 {
    a.map(|x| x / dot(a, a).sqrt())
}

fn wide(a: [f32; 3]) -> V3 {
    a.map(f64::from)
}

#[track_caller]
fn assert_near(found: [f32; 3], expected: V3, tolerance: f64) {
    let off = (0..3).map(|k| (f64::from(found[k]) - expected[k]).abs()).fold(0.0, f64::max);
    assert!(off <= tolerance, "{found:?} is {off:e} off {expected:?}");
}

/// By the Bernstein polynomials themselves, in f64: nothing in common with de Casteljau.
fn bernstein(net: &Net, u: f64, v: f64) -> V3 {
    let basis = |n: u8, t: f64| -> Vec<f64> {
        let n = i32::from(n);
        let choose = |k: i32| (0..k).map(|i| f64::from(n - i) / f64::from(i + 1)).product::<f64>();
        (0..=n).map(|k| choose(k) * t.powi(k) * (1.0 - t).powi(n - k)).collect()
    };
    let (bu, bv) = (basis(net.degree[0], u), basis(net.degree[1], v));
    let mut sum = [0.0; 4];
    for (index, point) in net.points.iter().enumerate() {
        let weight = bu[index / bv.len()] * bv[index % bv.len()];
        (0..4).for_each(|k| sum[k] += weight * f64::from(point[k]));
    }
    std::array::from_fn(|k| sum[k] / sum[3])
}

/// ∂S/∂u and ∂S/∂v by central differences.
fn differences(net: &Net, u: f64, v: f64) -> (V3, V3) {
    let h = 1e-5;
    let slope = |a: V3, b: V3| subtract(a, b).map(|x| x / (2.0 * h));
    (
        slope(bernstein(net, u + h, v), bernstein(net, u - h, v)),
        slope(bernstein(net, u, v + h), bernstein(net, u, v - h)),
    )
}

/// An eighth of the unit sphere, rational biquadratic: v = 1 is the pole +y.
fn octant() -> Net {
    // A quarter of a circle in homogeneous points, and its product with itself.
    let c = std::f64::consts::FRAC_1_SQRT_2;
    let arc = [[1.0, 0.0, 1.0], [c, c, c], [0.0, 1.0, 1.0]];
    let mut points = Vec::new();
    for meridian in arc {
        for [radius, height, weight] in arc {
            // u runs from +z to +x, so that u × v points outward (v runs upward).
            let [z, x, w] = meridian;
            points.push([x * radius, w * height, z * radius, w * weight].map(|x| x as f32));
        }
    }
    Net { degree: [2, 2], points }
}

mod closed_forms {
    use super::*;

    #[test]
    fn a_quadratic_height_field() {
        // The net of z = 2u² + 3uv − v, as a bicubic: blossoms at the control points.
        let blossom2 = |i: f64| i * (3.0 * i - 1.0) / 2.0;
        let quadratic = net([3, 3], |i, j| [i, j, 2.0 * blossom2(i) + 3.0 * i * j - j, 1.0]);
        for (u, v) in [(0.0, 0.0), (0.25, 0.5), (1.0, 1.0), (0.3, 0.9), (1.0, 0.0)] {
            let sample = quadratic.view().evaluate(u, v);
            assert_near(sample.position, [u, v, 2.0 * u * u + 3.0 * u * v - v], 2e-7);
            let (su, sv) = ([1.0, 0.0, 4.0 * u + 3.0 * v], [0.0, 1.0, 3.0 * u - 1.0]);
            assert_near(sample.du, su, 2e-6);
            assert_near(sample.dv, sv, 2e-6);
            assert_near(sample.normal, unit(cross(su, sv)), 1e-6);
        }
    }

    #[test]
    fn an_eighth_of_a_sphere() {
        let octant = octant();
        for i in 0..=16 {
            for j in 0..=16 {
                let sample = octant.view().sample(Parameter::fraction(i, 16), Parameter::fraction(j, 16));
                let position = wide(sample.position);
                assert!((dot(position, position) - 1.0).abs() < 1e-6, "{position:?}");
                assert_near(sample.normal, position, 2e-6);
            }
        }
        let pole = octant.view().evaluate(0.3, 1.0);
        assert_near(pole.normal, [0.0, 1.0, 0.0], 1e-6);
    }

    #[test]
    fn transposing_turns_the_normal() {
        for net in teapot().iter().chain([&octant()]) {
            let (here, there) =
                (net.view().evaluate(0.25, 0.75), net.transposed().view().evaluate(0.75, 0.25));
            assert_near(there.position, wide(here.position), 1e-6);
            assert_near(there.normal, wide(here.normal).map(|x| -x), 1e-5);
        }
    }
}

mod normals_where_the_product_vanishes {
    use super::*;

    #[test]
    fn at_the_lids_tip_and_the_middle_of_the_base() {
        let nets = teapot();
        for (patches, up) in [(20..24, 1.0), (28..32, -1.0)] {
            for patch in patches {
                for i in 0..=8 {
                    let sample = nets[patch].view().evaluate(f64::from(i) / 8.0, 0.0);
                    assert_near(sample.du, [0.0; 3], 0.0);
                    assert_near(sample.normal, [0.0, up, 0.0], 1e-6);
                }
            }
        }
    }

    #[test]
    fn also_in_small_leaves_far_from_the_origin() {
        // Halved ten times along u and v towards the tip, and moved; f32 all the way.
        for offset in [0.0, 10.0, 1000.0] {
            let mut net = teapot()[20].clone();
            for point in &mut net.points {
                point[0] += offset;
            }
            for _ in 0..10 {
                net = halve_along_v(&halve_along_v(&net.transposed()).transposed());
            }
            for i in 0..=4 {
                let normal = net.view().evaluate(f64::from(i) / 4.0, 0.0).normal;
                assert!(normal[1] > if offset > 100.0 { 0.5 } else { 0.999 }, "{offset}: {normal:?}");
            }
        }
    }

    /// The lower half by midpoints, as the engine halves.
    fn halve_along_v(net: &Net) -> Net {
        let columns = net.degree[1] as usize + 1;
        let mut half = net.clone();
        for row in half.points.chunks_mut(columns) {
            let mut line = row.to_vec();
            for (k, point) in row.iter_mut().enumerate().take(columns) {
                *point = line[0];
                for i in 0..columns - 1 - k {
                    line[i] = std::array::from_fn(|axis| (line[i][axis] + line[i + 1][axis]) * 0.5);
                }
            }
        }
        half
    }

    /// The normal at a place where it is a limit, against the one close by, from inside.
    #[track_caller]
    fn assert_limit(net: &Net, at: (f64, f64), inside: (f64, f64)) {
        let limit = net.view().evaluate(at.0, at.1).normal;
        let near = net.view().evaluate(at.0 + 1e-3 * inside.0, at.1 + 1e-3 * inside.1).normal;
        assert!(dot(wide(limit), wide(near)) > 0.9999, "{limit:?} is not near {near:?}");
        let length = dot(wide(limit), wide(limit));
        assert!((length - 1.0).abs() < 1e-5);
    }

    fn hill() -> Net {
        net([3, 3], |u, v| [3.0 * v, (2.0 * u + v * v + u * v).sin(), 3.0 * u, 1.0])
    }

    #[test]
    fn one_corner_with_a_vanishing_derivative() {
        for (corner, neighbours) in [(0, [1, 4]), (3, [2, 7]), (12, [8, 13]), (15, [11, 14])] {
            for neighbour in neighbours {
                let mut net = hill();
                net.points[neighbour] = net.points[corner];
                let at = (f64::from(corner as u8 / 12), f64::from(corner as u8 % 12) / 3.0);
                assert_limit(&net, at, (1.0 - 2.0 * at.0, 1.0 - 2.0 * at.1));
            }
            // Both at once: S_u = S_v = 0 there.
            let mut net = hill();
            neighbours.iter().for_each(|&n| net.points[n] = net.points[corner]);
            let at = (f64::from(corner as u8 / 12), f64::from(corner as u8 % 12) / 3.0);
            assert_limit(&net, at, (1.0 - 2.0 * at.0, 1.0 - 2.0 * at.1));
        }
    }

    #[test]
    fn sides_collapsed_once_or_twice() {
        for deep in [1, 2] {
            let mut net = hill();
            for i in 0..4 {
                for j in 0..deep {
                    net.points[4 * i + j] = [0.5, 0.25, 1.5, 1.0];
                }
            }
            for u in [0.0, 0.125, 0.5, 1.0] {
                assert_limit(&net, (u, 0.0), (0.0, 1.0));
                assert_limit(&net.transposed(), (0.0, u), (1.0, 0.0));
            }
        }
    }

    #[test]
    fn a_side_that_is_a_point_but_for_rounding() {
        let mut net = teapot()[20].clone();
        for (row, point) in net.points.iter_mut().step_by(4).enumerate() {
            *point = [2e-7 * row as f32, 3.15 - 2.4e-7 * (row % 2) as f32, -1e-7 * row as f32, 1.0];
        }
        for u in [0.0, 0.3, 1.0] {
            assert_near(net.view().evaluate(u, 0.0).normal, [0.0, 1.0, 0.0], 1e-5);
        }
    }

    #[test]
    fn on_a_fold_the_side_towards_the_middle_counts() {
        for fold in [0.25, 0.75] {
            let net = net([2, 1], |i, v| {
                // The blossom of (u − fold)² at the control points 0 0, 0 1, 1 1.
                let [a, b] = [(i - 0.5).max(0.0) * 2.0, (i * 2.0).min(1.0)];
                [(a - fold) * (b - fold), a + b, v, 1.0]
            });
            let flat = Net { points: net.points.iter().map(|p| [p[0], 0.0, p[2], 1.0]).collect(), ..net };
            let inside = if fold < 0.5 { 0.01 } else { -0.01 };
            let expected = flat.view().evaluate(fold + inside, 0.5).normal;
            assert_near(flat.view().evaluate(fold, 0.5).normal, wide(expected), 1e-6);
        }
    }

    #[test]
    fn weights_that_differ_along_a_collapsed_side() {
        let mut net = octant();
        for i in 0..3 {
            let factor = 1.0 + 0.5 * i as f32;
            net.points[3 * i + 2] = net.points[3 * i + 2].map(|x| x * factor);
        }
        assert_limit(&net, (0.5, 1.0), (0.0, -1.0));
        let mesh = dice(&word(&[net]), 4).expect("a mesh");
        assert_eq!(mesh.triangles().len(), 2 * 16 - 4);
    }

    #[test]
    fn curves_and_points_get_something_finite() {
        let point = net([3, 3], |_, _| [1.0, 2.0, 3.0, 1.0]);
        let line = net([3, 2], |u, v| [u + v, 0.0, 0.0, 1.0]);
        let cubic = net([3, 3], |u, _| [u, u * u, u.sin(), 1.0]);
        for net in [point, line, cubic] {
            for (u, v) in [(0.0, 0.0), (0.5, 0.5), (1.0, 0.5)] {
                let sample = net.view().evaluate(u, v);
                assert_near(sample.normal, [0.0, 0.0, 1.0], 0.0);
                assert_near(sample.position, bernstein(&net, u, v), 1e-6);
            }
        }
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    -4.0f32..4.0
}

fn random_net(rational: bool) -> impl Strategy<Value = Net> {
    (1u8..=8, 1u8..=8).prop_flat_map(move |(m, n)| {
        let weight = if rational { (0.25f32..4.0).boxed() } else { Just(1.0f32).boxed() };
        let point =
            (prop::array::uniform3(coordinate()), weight).prop_map(|([x, y, z], w)| [x * w, y * w, z * w, w]);
        prop::collection::vec(point, net_points([m, n]))
            .prop_map(move |points| Net { degree: [m, n], points })
    })
}

fn any_net() -> impl Strategy<Value = Net> {
    any::<bool>().prop_flat_map(random_net)
}

fn parameter() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.0f64..=1.0, 1 => prop::sample::select(vec![0.0, 1.0, 0.5])]
}

proptest! {
    #[test]
    fn points_derivatives_and_normals_against_differences(net in any_net(), u in parameter(), v in parameter()) {
        let sample = net.view().evaluate(u, v);
        assert_near(sample.position, bernstein(&net, u, v), 1e-6);
        let (su, sv) = differences(&net, u, v);
        let size = |x: V3| 1.0 + dot(x, x).sqrt();
        assert_near(sample.du, su, 1e-4 * size(su) + 1e-3);
        assert_near(sample.dv, sv, 1e-4 * size(sv) + 1e-3);
        let normal = cross(su, sv);
        // Differences say little where the surface is nearly folded.
        prop_assume!(dot(normal, normal).sqrt() > 0.05 * size(su) * size(sv));
        assert_near(sample.normal, unit(normal), 1e-3);
    }

    #[test]
    fn affine_maps_commute(net in any_net(), map in prop::array::uniform3(prop::array::uniform4(coordinate())), u in parameter(), v in parameter()) {
        let apply = |p: [f64; 4]| -> V3 { std::array::from_fn(|r| (0..4).map(|c| f64::from(map[r][c]) * p[c]).sum()) };
        let mapped = |p: &[f32; 4]| {
            let [x, y, z] = apply(p.map(f64::from));
            [x as f32, y as f32, z as f32, p[3]]
        };
        let image = Net { degree: net.degree, points: net.points.iter().map(mapped).collect() };
        let [x, y, z] = wide(net.view().evaluate(u, v).position);
        assert_near(image.view().evaluate(u, v).position, apply([x, y, z, 1.0]), 1e-4);
    }

    #[test]
    fn the_basis_sums_to_one(degree in (1u8..=8, 1u8..=8), x in coordinate(), w in 0.1f32..10.0, u in parameter(), v in parameter()) {
        let degree = [degree.0, degree.1];
        let net = Net { degree, points: vec![[x * w, 2.0 * x * w, 0.0, w]; net_points(degree)] };
        let sample = net.view().evaluate(u, v);
        assert_near(sample.position, [x.into(), (2.0 * x).into(), 0.0], 2e-6);
        assert_near(sample.du, [0.0; 3], 1e-5);
    }

    #[test]
    fn a_side_is_the_same_from_both_nets(net in any_net(), other in any_net(), n in 1usize..12) {
        // `other` gets the side u = 0 of `net` as its side v = 1, reversed.
        let side: Vec<[f32; 4]> = net.points[..=net.degree[1] as usize].iter().rev().copied().collect();
        let columns = other.degree[1] as usize + 1;
        let degree = [net.degree[1], other.degree[1]];
        let mut points: Vec<[f32; 4]> = other.points.iter().copied().cycle().take(net_points(degree)).collect();
        side.iter().enumerate().for_each(|(i, &point)| points[i * columns + columns - 1] = point);
        let other = Net { degree, points };
        for i in 0..=n {
            let here = net.view().sample(Parameter::fraction(0, n), Parameter::fraction(i, n));
            let there = other.view().sample(Parameter::fraction(n - i, n), Parameter::fraction(n, n));
            prop_assert_eq!(here.position.map(f32::to_bits), there.position.map(f32::to_bits));
        }
    }
}

/// Positions by their bits.
fn key(position: [f32; 3]) -> [u32; 3] {
    position.map(f32::to_bits)
}

fn area(mesh: &Mesh, triangle: [u32; 3]) -> V3 {
    let [a, b, c] = triangle.map(|vertex| wide(mesh.positions[vertex as usize]));
    cross(subtract(b, a), subtract(c, a)).map(|x| 0.5 * x)
}

#[test]
fn the_teapot_in_triangles() {
    let word = word(&teapot());
    for n in [1, 2, 3, 8] {
        let mesh = dice(&word, n).expect("a mesh");
        assert_eq!(mesh.positions.len(), 32 * (n + 1) * (n + 1));
        assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
        // Eight patches have one collapsed side: n triangles less each.
        assert_eq!(mesh.triangles().len(), 32 * 2 * n * n - 8 * n);
        for triangle in mesh.triangles() {
            let area = area(&mesh, triangle);
            // With one cell a patch, corners of the spout's patches lie on one line.
            assert!(n == 1 || dot(area, area) > 0.0, "{triangle:?} has no area");
            let normal = triangle.map(|vertex| wide(mesh.normals[vertex as usize]));
            if n >= 8 {
                assert!(normal.iter().all(|&normal| dot(area, normal) > 0.0), "{triangle:?} is turned");
            }
        }
        for (normal, uv) in mesh.normals.iter().zip(&mesh.uvs) {
            assert!((dot(wide(*normal), wide(*normal)) - 1.0).abs() < 1e-6);
            assert!(uv.iter().all(|x| (0.0..=1.0).contains(x)));
        }
    }
}

#[test]
fn whichever_side_is_collapsed() {
    let tip = teapot()[20].clone();
    let reversed = Net { degree: tip.degree, points: tip.points.iter().rev().copied().collect() };
    for net in [tip.transposed(), reversed.transposed(), tip, reversed] {
        let word = word(&[net]);
        let mesh = dice(&word, 4).expect("a mesh");
        assert_eq!(mesh.triangles().len(), 2 * 16 - 4);
        assert!(mesh.triangles().all(|t| dot(area(&mesh, t), area(&mesh, t)) > 0.0));
        let borders = grid::borders(&word, 4).expect("borders");
        assert_eq!(borders.len(), 3 * 4);
        for [a, b] in borders {
            assert_ne!(mesh.positions[a as usize], mesh.positions[b as usize]);
        }
    }
}

#[test]
fn the_teapot_leaks_only_at_its_borders() {
    for n in [3, 8] {
        let mesh = dice(&word(&teapot()), n).expect("a mesh");
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for [a, b, c] in mesh.triangles() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (key(mesh.positions[from as usize]), key(mesh.positions[to as usize]));
                let forward = from < to;
                let edge = if forward { [from, to] } else { [to, from] };
                *edges.entry(edge).or_default() += if forward { 1 } else { -1 };
            }
        }
        // 16 of the teapot's curves belong to one patch only (rim, spout, handle, lid); every other
        // edge runs once each way.
        let open = edges.values().filter(|&&balance| balance != 0).count();
        assert_eq!(open, 16 * n, "n = {n}");
    }
}

#[test]
fn a_sphere_is_covered() {
    // The octant's triangles as seen from the centre cover an eighth of the sphere.
    let mesh = dice(&word(&[octant()]), 64).expect("a mesh");
    let total: f64 = mesh.triangles().map(|t| dot(area(&mesh, t), area(&mesh, t)).sqrt()).sum();
    assert!((total - std::f64::consts::FRAC_PI_2).abs() < 1e-3, "{total}");
}

#[test]
fn uvs_lie_in_the_roots_square() {
    let mut word = word(&teapot()[..1]);
    word.modules[0].cell = Cell { du: 1, dv: 2, i: 1, j: 2 };
    let mesh = dice(&word, 2).expect("a mesh");
    let expected: Vec<[f32; 2]> =
        [0.5, 0.75, 1.0].into_iter().flat_map(|u| [0.5, 0.625, 0.75].map(|v| [u, v])).collect();
    assert_eq!(mesh.uvs, expected);
    assert_eq!(Cell { du: 32, dv: 0, i: u32::MAX, j: 0 }.uv()[1], [1.0, 1.0]);
}

#[test]
fn what_cannot_be_diced() {
    let word = word(&teapot());
    assert_eq!(dice(&word, 0), Err(grid::Error::NoCells));
    for n in [12_000, 1 << 31, usize::MAX] {
        assert_eq!(dice(&word, n), Err(grid::Error::TooManyVertices { leaves: 32, n }));
    }
    let none = Word { modules: vec![], nets: vec![], ..word };
    assert_eq!(dice(&none, 4), Ok(Mesh::default()));
}

#[test]
fn the_grid_is_halved_until_the_model_is_small_enough() {
    for (leaves, n, expected) in [
        (32, 8, 8),
        (15_625, 8, 8),
        (15_626, 8, 4),
        (524_288, 8, 1),
        (10_000_000, 8, 1),
        (0, 8, 8),
        (32, 0, 1),
        (1, usize::MAX, 549),
    ] {
        let found = burgeon::tessellate::grid_for(leaves, n);
        let fits = leaves * 2 * found * found <= grid::MAX_TRIANGLES || found == 1;
        assert!(fits, "{leaves} leaves, {n}: {found}");
        if n < 1000 {
            assert_eq!(found, expected, "{leaves} leaves, {n}");
        }
    }
}
