//! Where a root lies, and how large it is.
//!
//! What is done with a root's control points is done in units of its own size, and far from the origin about its own first
//! point, so that neither a place far off nor a size that is very large or small costs digits, or overflows. Subtracting
//! is exact where the coordinates of a root lie within a factor of two, as they do far off; sizes are powers of two.

use glam::{Vec3, Vec4};

/// The origin for its points, and a power of two: the largest that is no greater than all of their coordinates then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub origin: Vec3,
    pub size: f32,
}

impl Default for Place {
    fn default() -> Place {
        Place { origin: Vec3::ZERO, size: 1.0 }
    }
}

/// The powers of two that a size may be: so that its inverse is no denormal number.
const SIZES: [u32; 2] = [1 << 23, 253 << 23];

/// So many times its size away a net is far off.
const FAR_OFF: f32 = 4.0;

impl Place {
    /// The place of a net, whose points are written about it.
    #[inline]
    pub fn of(net: &[Vec4], rational: bool, own: &mut [Vec4]) -> Place {
        let (origin, far) = origin_of(net, project(net[0], rational), rational);
        // Its exponent.
        let bits = (far.to_bits() & 0x7f80_0000).clamp(SIZES[0], SIZES[1]);
        let place = Place { origin, size: f32::from_bits(bits) };
        let inverse = place.inverse();
        for (own, &point) in own.iter_mut().zip(net) {
            let moved = about(point, origin, rational);
            *own = (moved.truncate() * inverse).extend(moved.w);
        }
        place
    }

    /// 1 / size, exactly.
    #[inline]
    pub fn inverse(&self) -> f32 {
        f32::from_bits((254 << 23) - self.size.to_bits())
    }
}

/// One of the points if they are far off, else 0; and their greatest coordinate about it.
#[inline]
pub(super) fn origin_of(points: &[Vec4], one: Vec3, rational: bool) -> (Vec3, f32) {
    let greatest = |p: Vec4| p.truncate().abs().max_element();
    let (mut far, mut about_one) = (0.0f32, 0.0f32);
    for &p in points {
        far = far.max(greatest(p));
        about_one = about_one.max(greatest(about(p, one, rational)));
    }
    if far > FAR_OFF * about_one { (one, about_one) } else { (Vec3::ZERO, far) }
}

/// A homogeneous point with the origin moved.
#[inline]
pub(super) fn about(p: Vec4, origin: Vec3, rational: bool) -> Vec4 {
    let moved = if rational { origin * p.w } else { origin };
    (p.truncate() - moved).extend(p.w)
}

/// The origin for the points of a curve, the same in both directions: the first of its ends by their coordinates.
#[inline]
pub(super) fn origin_of_curve(curve: &[Vec4], rational: bool) -> Vec3 {
    let (a, b) = (curve[0], curve[curve.len() - 1]);
    let first = if a.to_array() <= b.to_array() { a } else { b };
    origin_of(curve, project(first, rational), rational).0
}

#[inline]
fn project(p: Vec4, rational: bool) -> Vec3 {
    if rational { Vec3::new(p.x / p.w, p.y / p.w, p.z / p.w) } else { p.truncate() }
}
