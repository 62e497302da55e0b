//! The vertices of a tree's leaves: where they lie, which way they face, and what they share.

use super::lattice::FULL;
use super::orientation::Orientation;
use super::surface::{Control, Patches, Sample, cross, dot, length};
use super::topology::orientation_of;
use super::tree::Tree;
use super::vertex::Vertex;
use glam::Vec3;

impl Tree<'_> {
    #[inline]
    pub fn orientation(&self, root: u32) -> Orientation {
        orientation_of(self.topology, root)
    }

    /// The vertex at a lattice point of a root. Where patches share it, its normal is the mean of theirs, each
    /// turned to the side of the first. Two nets are kept from call to call: vertices of one root follow each other.
    pub fn vertex(
        &self,
        patches: &Patches,
        [net, spare]: &mut [Control; 2],
        root: u32,
        p: [u32; 2],
        symbol: u32,
        tangents: bool,
    ) -> Vertex {
        let orientation = self.orientation(root);
        patches.load(net, root, orientation);
        let (normal, sample) = net.normal(p);
        let mut normal = if orientation.mirrors() { -normal } else { normal };
        if self.shared {
            let mut sum = normal;
            self.sharing(root, p, |r, q, own| {
                if own {
                    return;
                }
                patches.load(spare, r, self.orientation(r));
                let (other, _) = spare.normal(q);
                let other = if self.orientation(r).mirrors() { -other } else { other };
                sum += if dot(other, normal) < 0.0 { -other } else { other };
            });
            let length = length(sum);
            if length > 0.0 {
                normal = sum / length;
            }
        }
        Vertex {
            position: net.position_of(p, sample.position),
            normal,
            tangent: tangent(orientation, &sample, normal, tangents),
            uv: orientation.uv(p),
            source: [root, symbol],
        }
    }

    /// Vertices inside one root, as many as [`LANES`] at once; what is behind `points` is one of them again.
    pub fn vertices_inside(
        &self,
        patches: &Patches,
        net: &mut Control,
        root: u32,
        points: &[[u32; 2]],
        tangents: bool,
    ) -> [Vertex; LANES] {
        let orientation = self.orientation(root);
        patches.load(net, root, orientation);
        let last = points.len() - 1;
        let uv = [0, 1].map(|k| std::array::from_fn(|l| points[l.min(last)][k] as f32 / FULL as f32));
        let [position, du, dv] = net.samples::<LANES>(uv);
        let product = |l: usize| -> [f32; 3] {
            let at = |k: usize, n: usize| du[k][l] * dv[n][l] - du[n][l] * dv[k][l];
            [at(1, 2), at(2, 0), at(0, 1)]
        };
        let sizes = |v: &dyn Fn(usize) -> [f32; 3]| -> [f32; LANES] {
            std::array::from_fn(|l| {
                let [x, y, z] = v(l);
                (x * x + y * y + z * z).sqrt()
            })
        };
        let of = |v: &[[f32; LANES]; 3], l: usize| [v[0][l], v[1][l], v[2][l]];
        let lengths = [sizes(&product), sizes(&|l| of(&du, l)), sizes(&|l| of(&dv, l))];
        std::array::from_fn(|l| {
            let p = points[l.min(last)];
            let sample = Sample {
                position: Vec3::from(of(&position, l)),
                du: Vec3::from(of(&du, l)),
                dv: Vec3::from(of(&dv, l)),
            };
            let [n, u, v] = lengths.map(|lengths| lengths[l]);
            let normal = match n > net.noise * u + net.noise * v {
                true => Vec3::from(product(l)) / n,
                false => net.normal(p).0,
            };
            let normal = if orientation.mirrors() { -normal } else { normal };
            Vertex {
                position: sample.position + Vec3::ZERO,
                normal,
                tangent: tangent(orientation, &sample, normal, tangents),
                uv: orientation.uv(p),
                source: [root, 0],
            }
        })
    }
}

/// Vertices that are computed at once.
pub const LANES: usize = 8;

/// The unit vector along the file's u at right angles to the normal, if it is wanted.
#[inline]
pub(crate) fn tangent(orientation: Orientation, sample: &Sample, normal: Vec3, wanted: bool) -> [f32; 4] {
    if !wanted {
        return [0.0; 4];
    }
    let [along_u, _] = orientation.to_file([sample.du, sample.dv], [Vec3::ZERO; 2]);
    let across = along_u - normal * dot(normal, along_u);
    let length = length(across);
    let tangent = if length > 0.0 { across / length } else { beside(normal) };
    [tangent.x, tangent.y, tangent.z, 1.0]
}

/// Some unit vector at right angles to a unit vector.
fn beside(n: Vec3) -> Vec3 {
    let other = if n.x.abs() < 0.5 { Vec3::X } else { Vec3::Y };
    let product = cross(n, other);
    product / length(product)
}
