//! Models far from the origin, very large, very small, or with a stray point: the same triangles as near it, as long as
//! the shape survives single precision.

use super::{file, tessellated};
use burgeon::cpu::tessellate::Tessellator;
use burgeon::patch::Net;
use burgeon::tessellate::topology::MOST_COORDINATE;
use burgeon::tessellate::{Camera, Level, Options, Topology, bound};

/// The nets with each point, as it lies in space, moved to somewhere else.
pub fn mapped(nets: &[Net], f: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<Net> {
    let point = |&[x, y, z, w]: &[f32; 4]| {
        let [x, y, z] = f([x / w, y / w, z / w]);
        [x * w, y * w, z * w, w]
    };
    nets.iter()
        .map(|net| Net { degree: net.degree, points: net.points.iter().map(point).collect() })
        .collect()
}

/// Control points on a lattice that single precision holds at all places that these tests move it to.
pub fn on_lattice(nets: &[Net]) -> Vec<Net> {
    mapped(nets, |p| p.map(|x| (x * 64.0).round() / 64.0))
}

fn moved(nets: &[Net], by: [f32; 3]) -> Vec<Net> {
    mapped(nets, |p| [0, 1, 2].map(|k| p[k] + by[k]))
}

fn flat(x: f32) -> Vec<Net> {
    let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|[a, b]| [x + a, b, 0.0, 1.0]);
    vec![Net { degree: [1, 1], points: points.to_vec() }]
}

pub const PLACES: [[f32; 3]; 5] = [
    [500.0, 500.0, 0.0],
    [1000.0, 1000.0, 0.0],
    [5000.0, 5000.0, 0.0],
    [1e4, -3e4, 7.0],
    [-65536.0, 0.0, 65536.0],
];

fn positions(t: &Tessellator) -> Vec<[f32; 3]> {
    t.mesh().positions
}

#[test]
fn what_is_flat_takes_two_triangles_wherever_it_is() {
    for x in [0.0, 1e4, 1e6, -1.6e7] {
        let t = tessellated(&flat(x), &Level::world(1e-6), &Options::default());
        assert_eq!(t.mesh().indices.len(), 6, "at {x}");
        assert!(positions(&t).iter().all(|p| p[0] == x || p[0] == x + 1.0), "{:?}", positions(&t));
    }
}

/// As many cells are split, and each vertex is where an unmoved one goes but for half a spacing of floats there. (Which
/// orientation of a patch is the canonical one may change, and with it the order.)
#[test]
fn a_model_far_off_has_the_triangles_that_it_has_near_by() {
    let teapot = on_lattice(&file("teapot.bpt", false));
    let options = Options::default();
    for by in PLACES {
        let teapot_there = moved(&teapot, by);
        for tolerance in [0.05, 0.005] {
            let level = Level::world(tolerance);
            let (near, far) =
                (tessellated(&teapot, &level, &options), tessellated(&teapot_there, &level, &options));
            assert_eq!(far.mesh().indices.len(), near.mesh().indices.len(), "{by:?}, {tolerance}");
            if tolerance == 0.005 {
                continue;
            }
            let most = bound::rounding(4.0, by.iter().fold(0.0f32, |a, x| a.max(x.abs())) + 4.0);
            let (near, far) = (near.mesh(), far.mesh());
            for (p, n) in far.positions.iter().zip(&far.normals) {
                let at = [0, 1, 2].map(|k| f64::from(p[k]) - f64::from(by[k]));
                let is_there = |(q, m): (&[f32; 3], &[f32; 3])| {
                    (0..3).all(|k| (f64::from(q[k]) - at[k]).abs() <= most.into())
                        && (0..3).all(|k| (n[k] - m[k]).abs() < 1e-3)
                };
                let found = near.positions.iter().zip(&near.normals).any(is_there);
                assert!(found, "nothing is at {at:?} with the normal {n:?}, moved by {by:?}");
            }
        }
    }
}

/// Vertices that patches do not share lie in one place all the same.
#[test]
fn seams_far_off_have_no_crack() {
    for (nets, rational) in [(file("teapot.bpt", false), false), (file("torus.bpt", true), true)] {
        let nets = moved(&nets, PLACES[3]);
        let triangles = |seams: bool| -> Vec<[[u32; 3]; 3]> {
            let t = tessellated(&nets, &Level::world(0.05), &Options { seams, ..Options::default() });
            let mesh = t.mesh();
            mesh.triangles().map(|t| t.map(|v| mesh.positions[v as usize].map(f32::to_bits))).collect()
        };
        assert!(triangles(true) == triangles(false), "rational: {rational}");
    }
}

#[test]
fn rational_models_far_off_do_not_explode() {
    for name in ["sphere.bpt", "torus.bpt"] {
        let nets = file(name, true);
        let level = Level::world(0.01);
        let near = tessellated(&nets, &level, &Options::default()).mesh().indices.len();
        // Farther off its points are so coarse that it is another surface.
        for by in &PLACES[..3] {
            let far = tessellated(&moved(&nets, *by), &level, &Options::default()).mesh().indices.len();
            assert!((far as f64 / near as f64 - 1.0).abs() < 0.02, "{name} at {by:?}: {far} for {near}");
        }
    }
}

/// Powers of two change no digit.
#[test]
fn no_size_changes_the_triangles() {
    let teapot = file("teapot.bpt", false);
    let options = Options::default();
    let near = tessellated(&teapot, &Level::world(0.05), &options);
    for power in [-100, -40, 40, 100] {
        let factor = 2f32.powi(power);
        let nets = mapped(&teapot, |p| p.map(|x| x * factor));
        let scaled = tessellated(&nets, &Level::world(0.05 * factor), &options);
        assert_eq!(scaled.mesh().indices.len(), near.mesh().indices.len(), "2^{power}");
        assert!(scaled.mesh().normals == near.mesh().normals, "2^{power}");
        let back: Vec<[f32; 3]> = positions(&scaled).iter().map(|p| p.map(|x| x / factor)).collect();
        assert!(back == positions(&near), "2^{power}");
    }
}

#[test]
fn a_stray_point_makes_one_large_patch_and_no_other() {
    let mut teapot = file("teapot.bpt", false);
    let near = tessellated(&teapot, &Level::world(1e27), &Options::default()).mesh().indices.len();
    teapot[6].points[5][0] = 1e30;
    let t = tessellated(&teapot, &Level::world(1e27), &Options::default());
    assert!(positions(&t).iter().flatten().all(|x| x.is_finite()));
    assert!(t.mesh().indices.len() < near + 3 * 5000, "{} triangles", t.mesh().indices.len() / 3);
    // A weight near 0 throws a point that far, too.
    let mut net = flat(0.0);
    net[0].points[2] = [2f32.powi(110), 0.0, 0.0, 2f32.powi(-20)];
    let error = Topology::new(&net).expect_err("a point that is too far");
    assert_eq!(
        error.to_string(),
        format!("patch 0: a coordinate of {:e} is beyond {MOST_COORDINATE:e}", 2f64.powi(130))
    );
}

/// What a camera sees does not change when it goes along.
#[test]
fn a_camera_far_off_sees_the_same() {
    let teapot = on_lattice(&file("teapot.bpt", false));
    let level = |[x, y, z]: [f32; 3]| {
        let camera = Camera::looking(
            [x, y + 2.0, z + 8.0],
            [x, y + 1.0, z],
            [0.0, 1.0, 0.0],
            45.0,
            [800.0, 600.0],
            0.1,
        );
        Level::pixels(1.0, camera)
    };
    let near = tessellated(&teapot, &level([0.0; 3]), &Options::default()).mesh().indices.len();
    for by in PLACES {
        let far = tessellated(&moved(&teapot, by), &level(by), &Options::default()).mesh().indices.len();
        assert!((far as f64 / near as f64 - 1.0).abs() < 0.05, "at {by:?}: {far} for {near}");
    }
}
