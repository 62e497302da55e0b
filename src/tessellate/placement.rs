//! What a placement sees of a surface, and the slopes of what it makes of it: the pure definitions.
//!
//! A vertex that patches share is displaced once, as the first of them in the order of the file sees it (its
//! *owner*, whatever leaf happens to own its number): smooth position, mean normal, uv and random numbers are
//! the owner's from every side. So there is no crack, also where each patch has vertices of its own.
//!
//! Normals come of slopes: those of the smooth surface, which are exact, and differences of what was added to it
//! a [step](STEPS) away along u and v, each patch by itself as it goes on from the vertex.

use super::lattice::{FULL, NOWHERE, along, side_corner};
use super::orientation::Orientation;
use super::surface::{Control, NOISE, Sample, cross, dot, length};
use super::topology::{curve_of, entries, incidence, point_of, reversed, side_at, turned};
use super::tree::Tree;
use super::vertices::tangent;
use glam::Vec3;

/// Steps of a difference along a side of a root, whatever the level: fewer would miss what is fine, more would
/// drown in the rounding of positions.
pub const STEPS: f32 = 2048.0;

/// By so much a product of differences is rougher than one of derivatives.
const ROUGHER: f32 = 64.0;

/// A place of a patch, as a placement sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    pub position: Vec3,
    /// Mean of the two diagonals between the corners of the root's net.
    pub scale: f32,
    /// Unit length, as are tangent (along the file's u) and bitangent.
    pub normal: Vec3,
    pub tangent: Vec3,
    pub bitangent: Vec3,
    /// In the root's square, as its file has it.
    pub uv: [f32; 2],
}

impl Site {
    /// A place of a patch at these canonical parameters, with this position and the file's normal.
    pub fn new(
        net: &Control,
        orientation: Orientation,
        at: [f32; 2],
        sample: &Sample,
        position: Vec3,
        normal: Vec3,
    ) -> Site {
        let [x, y, z, _] = tangent(orientation, sample, normal, true);
        let tangent = Vec3::new(x, y, z);
        Site {
            position,
            scale: net.scale(),
            normal,
            tangent,
            bitangent: cross(normal, tangent),
            uv: orientation.to_file(at, [1.0; 2]),
        }
    }
}

impl Control {
    /// Mean of the two diagonals between the corners.
    pub fn scale(&self) -> f32 {
        let (rows, columns) = (self.rows, self.columns);
        let corner = |i: usize, j: usize| {
            let p = self.points[i * columns + j];
            Vec3::new(p.x / p.w, p.y / p.w, p.z / p.w)
        };
        let first = length(corner(0, 0) - corner(rows - 1, columns - 1));
        let second = length(corner(rows - 1, 0) - corner(0, columns - 1));
        (first + second) * 0.5 * self.place.size
    }

    /// The unit normal of a displaced patch with these slopes at a place that went to `position`, if the slopes
    /// are more than rounding.
    pub fn placed_normal(&self, [du, dv]: [Vec3; 2], position: Vec3) -> Option<Vec3> {
        let far = position.abs().max_element();
        let rough = ROUGHER * (self.noise * self.place.size).max(NOISE * far);
        let product = cross(du, dv);
        let size = length(product);
        (size > rough * length(du) + rough * length(dv)).then(|| product / size)
    }
}

/// How the slope at t, from 0 to 1, is made of three places: how many steps each is off, and its weight. One of
/// weight 0 is not asked for. At the ends of a side all three lie on the patch.
pub fn stencil(t: f32) -> [(f32, f32); 3] {
    if t < 1.0 / STEPS {
        [(0.0, -1.5), (1.0, 2.0), (2.0, -0.5)]
    } else if t > 1.0 - 1.0 / STEPS {
        [(0.0, 1.5), (-1.0, -2.0), (-2.0, 0.5)]
    } else {
        [(-1.0, -0.5), (0.0, 0.0), (1.0, 0.5)]
    }
}

/// The mean of the normals of several patches, each turned to the side of the first: by the smooth ones, since,
/// displaced, both sides of a groove may face each other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean {
    /// Smooth, and displaced.
    first: Option<[Vec3; 2]>,
    sum: Vec3,
}

impl Mean {
    pub fn add(&mut self, smooth: Vec3, displaced: Vec3) {
        let [first, _] = *self.first.get_or_insert([smooth, displaced]);
        self.sum += if dot(smooth, first) < 0.0 { -displaced } else { displaced };
    }

    /// The first where they cancel.
    pub fn unit(&self) -> Vec3 {
        let size = length(self.sum);
        if size > 0.0 { self.sum / size } else { self.first.map_or(Vec3::Z, |[_, displaced]| displaced) }
    }
}

/// Whether a lattice point lies on a side of its root, where others may share it.
pub fn on_side(p: [u32; 2]) -> bool {
    side_at(p[0], 0).or(side_at(p[1], 1)).is_some()
}

impl Tree<'_> {
    /// A lattice point as each of the patches sees it that share it, in an order that depends on the point
    /// alone, and whether that is the patch that is asked.
    pub fn sharing(&self, root: u32, p: [u32; 2], mut see: impl FnMut(u32, [u32; 2], bool)) {
        let corner_at = |corner: u32| [(corner & 1) * FULL, (corner >> 1) * FULL];
        let mut around = |corner: u32| {
            for &entry in entries(self.topology, point_of(self.topology, root, corner)) {
                see(entry >> 2, corner_at(entry & 3), entry == root << 2 | corner);
            }
        };
        match (side_at(p[0], 0), side_at(p[1], 1)) {
            (None, None) => see(root, p, true),
            (Some(x), Some(y)) => around((x & 1) | (y & 1) << 1),
            (Some(side), None) | (None, Some(side)) => {
                let curve = curve_of(self.topology, root, side);
                if curve == NOWHERE {
                    return around(side_corner(side, 0));
                }
                let t = turned(p[along(side)], reversed(self.topology, root, side));
                for &entry in entries(self.topology, curve) {
                    let (r, s, turn) = incidence(entry);
                    let (across, t) = ((s & 1) * FULL, turned(t, turn));
                    let q = if along(s) == 1 { [across, t] } else { [t, across] };
                    see(r, q, (r, s) == (root, side));
                }
            }
        }
    }

    /// Whether all leaves that touch a lattice point, of every patch that shares it, have one of these symbols;
    /// holes do not count.
    pub fn lies_on(&self, root: u32, p: [u32; 2], symbols: &[usize]) -> bool {
        let mut all = true;
        Tree { shared: true, ..*self }.around(root, p, |touching| {
            let node = &self.nodes[touching.node as usize];
            all = node.is_hole() || symbols.contains(&(node.symbol() as usize));
            all
        });
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope of a parabola is exact, wherever it is taken.
    #[test]
    fn slopes_are_exact_for_parabolas_and_ask_for_nothing_outside() {
        let f = |t: f64| 3.0 * t * t - 2.0 * t + 1.0;
        for t in [0.0, 0.25 / STEPS, 1.0 / STEPS, 0.3, 1.0 - 1.0 / STEPS, 1.0 - 0.5 / STEPS, 1.0] {
            let mut slope = 0.0;
            for (off, weight) in stencil(t) {
                let place = t + off / STEPS;
                assert!(weight == 0.0 || (0.0..=1.0).contains(&place), "{place} for {t}");
                slope += f64::from(weight) * f(f64::from(place)) * f64::from(STEPS);
            }
            assert!((slope - (6.0 * f64::from(t) - 2.0)).abs() < 1e-9, "{slope} at {t}");
        }
    }

    #[test]
    fn a_mean_is_turned_to_its_first() {
        let mut mean = Mean::default();
        mean.add(Vec3::X, Vec3::X);
        mean.add(-Vec3::X, -Vec3::X);
        assert_eq!(mean.unit(), Vec3::X);
        mean.add(Vec3::Y, 2.0 * Vec3::Y);
        assert_eq!(mean.unit(), Vec3::new(1.0, 1.0, 0.0) / 2f32.sqrt());
        // Both sides of a groove.
        let mut groove = Mean::default();
        groove.add(Vec3::Z, Vec3::new(0.8, 0.0, 0.6));
        groove.add(Vec3::Z, Vec3::new(-0.8, 0.0, 0.6));
        assert_eq!(groove.unit(), Vec3::Z);
        assert_eq!(Mean::default().unit(), Vec3::Z);
    }
}
