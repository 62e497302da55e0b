//! How far a mesh really is from its patches, at sampled places, and what uniform dicing needs for the same.

use burgeon::cpu::tessellate::Tessellator;
use burgeon::patch::Net;
use burgeon::tessellate::{Level, Options};
use rayon::prelude::*;

/// Triangles of uniform dicing as far off as an adaptive mesh is.
pub(super) struct Uniform {
    /// The greatest distance that was found between the adaptive mesh and its surface at the same parameters.
    pub distance: f64,
    /// Each patch in as few cells as keep to it. Neighbours do not meet then.
    pub by_patch: u64,
    /// All patches in as many cells, so that they do.
    pub by_model: u64,
}

/// Barycentric places of a triangle where it is held against the surface.
const PLACES: [[f64; 3]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.5, 0.5, 0.0],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
    [0.6, 0.2, 0.2],
    [0.2, 0.6, 0.2],
    [0.2, 0.2, 0.6],
];

/// The most cells along a side that are tried.
const MOST: u32 = 1024;

/// What uniform dicing needs to be as near as the adaptive mesh of this level.
pub(super) fn uniform(nets: &[Net], level: &Level) -> Option<Uniform> {
    // With seams each vertex has the uv of its own patch.
    let mut t = Tessellator::new(nets, &Options { seams: true, ..Options::default() }).ok()?;
    t.run(&level.target().ok()?);
    let complete = t.complete();
    let mesh = &complete.mesh;
    let triangles: Vec<_> = mesh.triangles().zip(&complete.sources).collect();
    let distance = triangles
        .par_iter()
        .map(|(triangle, [root, _])| {
            let corner = |v: u32| {
                let (p, [u, w]) = (mesh.positions[v as usize], mesh.uvs[v as usize].map(f64::from));
                (p.map(f64::from), [u, w])
            };
            let net = &nets[*root as usize];
            off(net, spread(net, triangle.map(corner)))
        })
        .reduce(|| 0.0, f64::max);
    let cells: Option<Vec<u32>> = nets.par_iter().map(|net| fewest(net, distance)).collect();
    let cells = cells?;
    let of = |n: u32| 2 * u64::from(n) * u64::from(n);
    Some(Uniform {
        distance,
        by_patch: cells.iter().map(|&n| of(n)).sum(),
        by_model: nets.len() as u64 * cells.iter().map(|&n| of(n)).max()?,
    })
}

/// A corner of a triangle: where it is, and its parameters.
type Corner = ([f64; 3], [f64; 2]);

/// A vertex on a side that is a point has one place along it, and its triangles lie all along it: each takes the middle
/// of its own part.
fn spread(net: &Net, corners: [Corner; 3]) -> [Corner; 3] {
    let [rows, columns] = net.degree.map(|d| usize::from(d) + 1);
    let is_point = |k: usize, end: usize| {
        let at = |n: usize| match k {
            0 => net.points[end * (rows - 1) * columns + n],
            _ => net.points[n * columns + end * (columns - 1)],
        };
        let place = |[x, y, z, w]: [f32; 4]| [x / w, y / w, z / w];
        (1..if k == 0 { columns } else { rows }).all(|n| place(at(n)) == place(at(0)))
    };
    let mut spread = corners;
    for (c, corner) in spread.iter_mut().enumerate() {
        for k in 0..2 {
            let (value, along) = (corners[c].1[k], 1 - k);
            if (value == 0.0 && is_point(k, 0)) || (value == 1.0 && is_point(k, 1)) {
                corner.1[along] = (corners[(c + 1) % 3].1[along] + corners[(c + 2) % 3].1[along]) * 0.5;
            }
        }
    }
    spread
}

/// How far a triangle is from the surface at the same parameters.
fn off(net: &Net, corners: [Corner; 3]) -> f64 {
    let mix = |weights: &[f64; 3], of: &dyn Fn(usize) -> f64| (0..3).map(|c| weights[c] * of(c)).sum::<f64>();
    let at = |weights: &[f64; 3]| {
        let [u, v] = [0, 1].map(|k| mix(weights, &|c| corners[c].1[k]));
        let exact = net.view().evaluate(u, v).position.map(f64::from);
        let apart = [0, 1, 2].map(|k| mix(weights, &|c| corners[c].0[k]) - exact[k]);
        apart.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    PLACES.iter().map(at).fold(0.0, f64::max)
}

/// The fewest cells along each side of a patch with which all of its triangles are so near.
fn fewest(net: &Net, distance: f64) -> Option<u32> {
    let is_near = |n: u32| {
        let at = |i: u32| f64::from(i) / f64::from(n);
        let corner =
            |i: u32, j: u32| (net.view().evaluate(at(i), at(j)).position.map(f64::from), [at(i), at(j)]);
        (0..n * n).all(|cell| {
            let (i, j) = (cell / n, cell % n);
            let [a, b, c, d] = [(i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)].map(|(i, j)| corner(i, j));
            off(net, [a, c, d]) <= distance && off(net, [a, d, b]) <= distance
        })
    };
    let mut high = 1;
    while !is_near(high) {
        high *= 2;
        if high > MOST {
            return None;
        }
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = (low + high) / 2;
        if is_near(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(high)
}
