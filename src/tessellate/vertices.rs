//! The vertices of a tree's leaves: where they lie, which way they face, and what they share.

use super::lattice::FULL;
use super::orientation::Orientation;
use super::placement::on_side;
use super::surface::{
    Control, LANES, Patches, Points, Sample, Samples, TILE, Wide, cross, dot, each, length,
};
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
        if self.shared && on_side(p) {
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

    /// What a root says of some of its lattice points, before other patches that share them are asked. The net is kept
    /// from call to call, and so is room for what is found.
    #[inline]
    pub fn own<'a>(
        &self,
        patches: &Patches,
        (net, samples): (&mut Control, &'a mut Samples<LANES>),
        root: u32,
        points: &[[u32; 2]; LANES],
    ) -> Own<'a, LANES> {
        let orientation = self.orientation(root);
        patches.load(net, root, orientation);
        net.samples(points, samples);
        Own::new(root, orientation, samples)
    }

    /// The same of all crossings of some lines along x and y, row by row.
    #[inline(always)]
    pub fn own_tile<'a>(
        &self,
        patches: &Patches,
        (net, samples): (&mut Control, &'a mut [Samples<TILE>; TILE]),
        root: u32,
        [x, y]: [&[u32; TILE]; 2],
    ) -> [Own<'a, TILE>; TILE] {
        let orientation = self.orientation(root);
        patches.load(net, root, orientation);
        net.tile(x, y, samples);
        let [a, b, c, d] = samples;
        let own = |row| Own::new(root, orientation, row);
        [own(a), own(b), own(c), own(d)]
    }
}

/// Vertices as their own root has them, lane by lane.
pub struct Own<'a, const L: usize> {
    root: u32,
    orientation: Orientation,
    pub samples: &'a Samples<L>,
}

impl<'a, const L: usize> Own<'a, L> {
    #[inline(always)]
    fn new(root: u32, orientation: Orientation, samples: &'a mut Samples<L>) -> Own<'a, L> {
        if orientation.mirrors() {
            samples.normal.as_flattened_mut().iter_mut().for_each(|x| *x = -*x);
        }
        Own { root, orientation, samples }
    }

    /// Texture coordinates of the same points.
    #[inline]
    pub fn uv(&self, points: &[[u32; 2]; L]) -> [[f32; L]; 2] {
        // Parameters are exact, and so is what is left of 1.
        let at = |x: bool, turns: bool| -> [f32; L] {
            let (x, from, sign) =
                (usize::from(x), if turns { 1.0 } else { 0.0 }, if turns { -1.0 } else { 1.0 });
            each(|l| from + sign * (points[l][x] as i32 as f32 / FULL as f32))
        };
        let turned = self.orientation.transposes();
        [at(turned, self.orientation.flips(0)), at(!turned, self.orientation.flips(1))]
    }

    /// One of them, which no other patch shares.
    pub fn vertex(&self, lane: usize, p: [u32; 2], symbol: u32, tangents: bool) -> Vertex {
        let normal = self.normal(lane);
        Vertex {
            position: at(&self.samples.points.position, lane) + Vec3::ZERO,
            normal,
            tangent: tangent(self.orientation, &self.sample(lane), normal, tangents),
            uv: self.orientation.uv(p),
            source: [self.root, symbol],
        }
    }

    pub fn normal(&self, lane: usize) -> Vec3 {
        at(&self.samples.normal, lane)
    }

    fn sample(&self, lane: usize) -> Sample {
        let Points { position, du, dv } = &self.samples.points;
        Sample { position: at(position, lane), du: at(du, lane), dv: at(dv, lane) }
    }

    /// One on its root's border; other patches are asked for their normals there.
    pub fn rim(&self, net: &Control, lane: usize, p: [u32; 2], symbol: u32) -> Rim {
        let mut vertex = self.vertex(lane, p, symbol, false);
        vertex.position = net.position_of(p, vertex.position);
        Rim { sum: vertex.normal, orientation: self.orientation, sample: self.sample(lane), vertex }
    }
}

/// A vertex on the border of its root.
pub struct Rim {
    vertex: Vertex,
    orientation: Orientation,
    sample: Sample,
    /// Of all normals so far.
    sum: Vec3,
}

impl Rim {
    /// The normal of another patch, turned to the side of the first.
    pub fn see(&mut self, other: Vec3) {
        self.sum += if dot(other, self.vertex.normal) < 0.0 { -other } else { other };
    }

    /// The vertex, with the mean of the normals if patches share it.
    pub fn vertex(&self, shared: bool, tangents: bool) -> Vertex {
        let mut vertex = self.vertex;
        let length = length(self.sum);
        if shared && length > 0.0 {
            vertex.normal = self.sum / length;
        }
        vertex.tangent = tangent(self.orientation, &self.sample, vertex.normal, tangents);
        vertex
    }
}

#[inline]
fn at<const L: usize>(v: &Wide<L>, lane: usize) -> Vec3 {
    Vec3::new(v[0][lane], v[1][lane], v[2][lane])
}

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
