//! Where the viewer stands: so far off that the model just fills the picture.

use super::{Camera, Up};

type V3 = [f64; 3];

/// Half the angle of view, vertically.
const HALF_ANGLE: f64 = 14.0;
/// How much of the width and height the model may take.
const FILL: f64 = 0.88;

/// Farther off the model's origin than anything that is drawn, the ground included.
const GROUND: f64 = 6.0;

/// A model moved and scaled to lie in −1..=1, which keeps f32 exact enough for models of any size,
/// anywhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    center: V3,
    scale: f64,
}

impl Unit {
    /// For points that are finite.
    pub(super) fn of(points: &[[f32; 3]]) -> Unit {
        let Some(bounds) = crate::patch::Bounds::around(points.iter().copied()) else {
            return Unit { center: [0.0; 3], scale: 1.0 };
        };
        let (min, max) = (bounds.min.map(f64::from), bounds.max.map(f64::from));
        let center = std::array::from_fn(|k| 0.5 * (min[k] + max[k]));
        let half = (0..3).map(|k| 0.5 * (max[k] - min[k])).fold(0.0, f64::max);
        Unit { center, scale: if half > 0.0 { 1.0 / half } else { 1.0 } }
    }

    pub(super) fn apply(&self, point: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|k| ((f64::from(point[k]) - self.center[k]) * self.scale) as f32)
    }
}

/// A camera that shows the whole model. The first five are the head of the record `View` in
/// `wgsl/picture.wgsl`, where they are explained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Framed {
    pub right: [f32; 4],
    pub up: [f32; 4],
    pub back: [f32; 4],
    pub projection: [f32; 4],
    pub sky: [f32; 4],
}

/// Frames points that lie in −1..=1; `aspect` is width over height.
pub(super) fn frame(points: &[[f32; 3]], camera: Camera, up: Up, aspect: f64) -> Framed {
    let (azimuth, elevation) = match camera {
        Camera::Around { azimuth, elevation } => (f64::from(azimuth), f64::from(elevation)),
        Camera::Top => (0.0, 90.0),
    };
    let axes = Axes::new(azimuth.to_radians(), elevation.to_radians(), up);
    let seen = points.iter().map(|point| axes.apply(point.map(f64::from)));
    match camera {
        Camera::Around { .. } => perspective(&axes, seen, aspect),
        Camera::Top => parallel(&axes, seen, aspect),
    }
}

/// Right, up and back (towards the viewer) of the camera; the model's up.
struct Axes {
    right: V3,
    up: V3,
    back: V3,
    sky: V3,
}

impl Axes {
    fn new(azimuth: f64, elevation: f64, up: Up) -> Axes {
        // To the right, towards a viewer of azimuth 0, and up.
        let (x, front, sky): (V3, V3, V3) = match up {
            Up::Y => ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            Up::Z => ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]),
        };
        let ((sa, ca), (se, ce)) = (azimuth.sin_cos(), elevation.sin_cos());
        let mix = |a: f64, b: f64, c: f64| std::array::from_fn(|k| a * x[k] + b * front[k] + c * sky[k]);
        Axes {
            right: mix(ca, -sa, 0.0),
            up: mix(-se * sa, -se * ca, ce),
            back: mix(ce * sa, ce * ca, se),
            sky,
        }
    }

    fn apply(&self, p: V3) -> V3 {
        [dot(self.right, p), dot(self.up, p), dot(self.back, p)]
    }

    fn framed(&self, eye: V3, projection: [f64; 4], perspective: bool) -> Framed {
        let axis = |axis: V3, offset: f64| [axis[0] as f32, axis[1] as f32, axis[2] as f32, -offset as f32];
        let [x, y, z] = self.apply(self.sky).map(|x| x as f32);
        Framed {
            right: axis(self.right, eye[0]),
            up: axis(self.up, eye[1]),
            back: axis(self.back, eye[2]),
            projection: projection.map(|x| x as f32),
            sky: [x, y, z, f32::from(perspective)],
        }
    }
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The smallest and largest value.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const EMPTY: Range = Range(f64::INFINITY, f64::NEG_INFINITY);

    fn with(self, x: f64) -> Range {
        Range(self.0.min(x), self.1.max(x))
    }

    fn or_zero(self) -> Range {
        if self.0 <= self.1 { self } else { Range(0.0, 0.0) }
    }
}

/// The nearest eye from which all points lie inside the (slightly narrowed) pyramid of view.
///
/// Seen from (x₀, y₀, d), a point is inside when ±(x − x₀) ≤ (d − z)·t, and likewise in y. So the
/// largest x + t·z and the smallest x − t·z say where the sides of the pyramid touch the model: the
/// eye is in the middle between them, and far enough back for the wider of the two directions.
fn perspective(axes: &Axes, points: impl Iterator<Item = V3>, aspect: f64) -> Framed {
    let slope_y = HALF_ANGLE.to_radians().tan();
    let slope_x = slope_y * aspect;
    let (tx, ty) = (FILL * slope_x, FILL * slope_y);
    let (mut left, mut right, mut below, mut above, mut depth) =
        (Range::EMPTY, Range::EMPTY, Range::EMPTY, Range::EMPTY, Range::EMPTY);
    for [x, y, z] in points {
        left = left.with(x - tx * z);
        right = right.with(x + tx * z);
        below = below.with(y - ty * z);
        above = above.with(y + ty * z);
        depth = depth.with(z);
    }
    let (left, right, below, above) =
        (left.or_zero().0, right.or_zero().1, below.or_zero().0, above.or_zero().1);
    let depth = depth.or_zero();
    let distance = ((right - left) / (2.0 * tx)).max((above - below) / (2.0 * ty)).max(depth.1 + 0.1);
    let eye = [0.5 * (left + right), 0.5 * (below + above), distance];
    let (near, far) = (0.9 * (distance - depth.1), distance + GROUND);
    axes.framed(eye, [1.0 / slope_x, 1.0 / slope_y, near, far], true)
}

fn parallel(axes: &Axes, points: impl Iterator<Item = V3>, aspect: f64) -> Framed {
    let mut ranges = [Range::EMPTY; 3];
    for point in points {
        ranges = std::array::from_fn(|k| ranges[k].with(point[k]));
    }
    let [x, y, z] = ranges.map(Range::or_zero);
    let half_height = (0.5 * (y.1 - y.0)).max(0.5 * (x.1 - x.0) / aspect).max(1e-3) / FILL;
    let eye = [0.5 * (x.0 + x.1), 0.5 * (y.0 + y.1), z.1 + 1.0];
    let projection = [1.0 / (half_height * aspect), 1.0 / half_height, 0.5, z.1 + 1.0 + GROUND];
    axes.framed(eye, projection, false)
}
