//! How fine a tessellation is to be, and which cells that splits.

use super::bound;
use super::budget::raised;
use super::lattice::{MAX_DEPTH, Node};
use super::surface::{Control, Place};
use glam::{Vec3, Vec4};
use std::ops::RangeInclusive;
use thiserror::Error;

/// How fine a tessellation is to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The most that a triangle may be off the surface, in the unit of `measure`: [`LEAST_TOLERANCE`] or more.
    /// A displacement is not part of that surface: for one with finer features take a least `depth`.
    /// Rounding of positions comes to it: see [`bound::rounding`].
    pub tolerance: f32,
    pub measure: Measure,
    /// Halvings of a root along each direction, at least and at most, up to [`MAX_DEPTH`]. At the most the
    /// tolerance is no longer kept; rules, and edges that must be told apart, may need more.
    pub depth: RangeInclusive<u32>,
    /// Against popping: a cell that was split in the frame before stays so until its error falls below
    /// this share of the tolerance less, 0 (no memory) to below 1.
    pub hysteresis: f32,
    /// The most triangles of a frame: the tolerance is raised until they fit, on the device, and given back when
    /// there is room again. What rules and `depth` ask for comes before it.
    pub budget: Option<u32>,
}

/// The least tolerance: shorter lengths soon are no full numbers of single precision.
pub const LEAST_TOLERANCE: f32 = 1e-36;

/// What a tolerance is measured in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Measure {
    /// Units of the model.
    #[default]
    World,
    /// Pixels of a camera's picture. Cells that it does not see are left as they are.
    Pixels(Camera),
}

/// A camera in perspective or in parallel projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// From the model's space to clip space: four columns. Depth is not read.
    pub clip: [[f32; 4]; 4],
    /// Width and height of the picture in pixels.
    pub size: [f32; 2],
    /// The least w of what is seen: the distance of the near plane in perspective, above 0.
    pub near: f32,
}

/// Why there can be no such level.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LevelError {
    #[error("a tolerance of {0:e} cannot be kept; it must be {LEAST_TOLERANCE:e} or more, and finite")]
    Tolerance(f32),
    #[error("depths from {least} to {most} are no range within 0 to {MAX_DEPTH}")]
    Depth { least: u32, most: u32 },
    #[error("a budget of 0 triangles is never kept")]
    Budget,
    #[error("a hysteresis of {0} lies outside 0 to below 1")]
    Hysteresis(f32),
    #[error("a camera needs a near plane above 0, a picture of some pixels and a finite matrix")]
    Camera,
}

impl Level {
    /// Within `tolerance` units of the model, to a depth of 12.
    pub fn world(tolerance: f32) -> Level {
        Level { tolerance, measure: Measure::World, depth: 0..=12, hysteresis: 0.0, budget: None }
    }

    /// Within so many pixels of a camera's picture, to a depth of 12.
    pub fn pixels(tolerance: f32, camera: Camera) -> Level {
        Level { measure: Measure::Pixels(camera), ..Level::world(tolerance) }
    }

    /// As the pass `decide` reads it.
    ///
    /// # Errors
    /// When a number lies outside what its field says.
    pub fn target(&self) -> Result<Target, LevelError> {
        // Written so that NaN is refused.
        if !(self.tolerance >= LEAST_TOLERANCE && self.tolerance < f32::INFINITY) {
            return Err(LevelError::Tolerance(self.tolerance));
        }
        let (least, most) = (*self.depth.start(), *self.depth.end());
        if least > most || most > MAX_DEPTH {
            return Err(LevelError::Depth { least, most });
        }
        if self.budget == Some(0) {
            return Err(LevelError::Budget);
        }
        if !(0.0..1.0).contains(&self.hysteresis) {
            return Err(LevelError::Hysteresis(self.hysteresis));
        }
        let mut target = Target {
            tolerance: self.tolerance,
            keep: self.tolerance * (1.0 - self.hysteresis),
            least,
            most,
            budget: self.budget.unwrap_or(0),
            ..bytemuck::Zeroable::zeroed()
        };
        if let Measure::Pixels(camera) = self.measure {
            let finite = camera.clip.iter().flatten().all(|x| x.is_finite());
            let sizes = camera.size.iter().all(|s| (1.0..1e6).contains(s));
            if !(finite && sizes && camera.near > 0.0 && camera.near < f32::INFINITY) {
                return Err(LevelError::Camera);
            }
            target.clip = camera.clip;
            target.half = camera.size.map(|s| s * 0.5);
            target.near = camera.near;
            target.pixels = 1;
        }
        Ok(target)
    }
}

impl Camera {
    /// In perspective, from `eye` towards `at`; `angle` is the vertical angle of view in degrees. `up` must not
    /// point along the line of sight.
    pub fn looking(
        eye: [f32; 3],
        at: [f32; 3],
        up: [f32; 3],
        angle: f32,
        size: [f32; 2],
        near: f32,
    ) -> Camera {
        let [eye, at, up] = [eye, at, up].map(glam::Vec3::from);
        let camera = glam::camera::rh::view::look_at_mat4(eye, at, up);
        let aspect = size[0] / size[1];
        let lens = glam::camera::rh::proj::directx::perspective_infinite(angle.to_radians(), aspect, near);
        Camera { clip: (lens * camera).to_cols_array_2d(), size, near }
    }
}

/// A [`Level`] as the pass `decide` reads it: a uniform of 112 bytes.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Target {
    pub clip: [[f32; 4]; 4],
    /// Half of the picture's width and height.
    pub half: [f32; 2],
    pub near: f32,
    pub tolerance: f32,
    /// What a cell that was split before must keep to.
    pub keep: f32,
    /// 1 if the tolerance is in pixels.
    pub pixels: u32,
    pub least: u32,
    pub most: u32,
    /// Triangles; 0 for as many as it takes.
    pub budget: u32,
    pub reserved: [u32; 3],
}

impl Target {
    /// Whether a cell is split, by its address alone; none where its net decides.
    #[inline]
    pub fn by_address(&self, node: &Node, least_of_root: u32) -> Option<bool> {
        let [du, dv] = node.depth();
        let (least, most) = (du.min(dv), du.max(dv));
        if node.is_hole() || most >= MAX_DEPTH {
            Some(false)
        } else if least < least_of_root {
            Some(true)
        } else if most >= self.most {
            Some(false)
        } else {
            (least < self.least).then_some(true)
        }
    }

    /// Whether a cell with these control points is split, by a tolerance that is raised by `coarser`. In pixels they are left as the camera sees them.
    #[inline]
    pub fn splits(&self, net: &mut Control, rational: bool, was_split: bool, coarser: u32) -> bool {
        let limit = if was_split { self.keep } else { self.tolerance } * raised(coarser);
        if self.pixels == 0 {
            return bound::error(net, rational) * net.place.size > limit;
        }
        let (inverse, moved) = (net.place.inverse(), self.moved(net.place));
        let near = self.near * inverse;
        let points = net.rows * net.columns;
        let [mut left, mut right, mut below, mut above, mut behind] = [true; 5];
        let mut crosses = false;
        for p in &mut net.points[..points] {
            let [x, y, w] = self.clipped(*p, moved);
            left &= x < -w;
            right &= x > w;
            below &= y < -w;
            above &= y > w;
            behind &= w < near;
            crosses |= w < near;
            *p = Vec4::new(x, y, 0.0, w);
        }
        if left || right || below || above || behind {
            return false;
        }
        // What the near plane cuts has no size in the picture, however small it is.
        crosses || bound::error_on(net, true, Vec3::new(self.half[0], self.half[1], 1.0)) > limit
    }

    /// x, y and w of a place in clip space, over its size.
    #[inline]
    fn moved(&self, place: Place) -> [f32; 3] {
        let ([a, b, c, d], o, inverse) = (self.clip, place.origin, place.inverse());
        [0, 1, 3].map(|k| ((a[k] * o.x + b[k] * o.y) + (c[k] * o.z + d[k])) * inverse)
    }

    /// x, y and w in clip space of a point about a place, all over the place's size: what they stand for is the same.
    #[inline]
    fn clipped(&self, p: Vec4, moved: [f32; 3]) -> [f32; 3] {
        let [a, b, c, _] = self.clip;
        let row = |k: usize, moved: f32| (a[k] * p.x + b[k] * p.y) + (c[k] * p.z + moved * p.w);
        [row(0, moved[0]), row(1, moved[1]), row(3, moved[2])]
    }
}
