//! The offscreen picture: a mesh, lit from both sides, as an image.
//!
//! Needs nothing but WebGPU's default limits, no optional feature, and borrows its device.

mod batch;
mod camera;
mod draw;
mod supersample;

use crate::io::png::Image;
use crate::tessellate::Mesh;
pub use crate::tessellate::Up;
use thiserror::Error;

/// What a picture shows and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// In pixels, 1..=8192.
    pub width: u32,
    /// In pixels, 1..=8192.
    pub height: u32,
    pub up: Up,
    pub camera: Camera,
    /// Each pixel is the mean of this many squared, for detail finer than pixels: 1 to 4 are useful;
    /// 0 is taken as 1.
    pub supersample: u32,
    /// sRGB of the side that the normals point to.
    pub front: [u8; 3],
    /// In place of `front` an sRGB for each vertex of the mesh; empty for none. For a colour a leaf take
    /// [`per_vertex`](crate::tessellate::per_vertex).
    pub colors: Vec<[u8; 3]>,
    /// sRGB of the other side.
    pub back: [u8; 3],
    /// sRGB of the background, at the top and at the bottom.
    pub background: [[u8; 3]; 2],
    /// Does the model stand on a ground that it throws a shadow on? Seen from below, it never does.
    pub ground: bool,
    /// Edges to draw as thin lines, as pairs of vertices of the mesh; for the sides of the leaves take
    /// [`borders`](crate::tessellate::grid::borders).
    pub lines: Vec<[u32; 2]>,
    /// sRGB of the lines.
    pub line_color: [u8; 3],
    /// In pixels.
    pub line_width: f32,
}

impl Default for Picture {
    fn default() -> Picture {
        Picture {
            width: 960,
            height: 720,
            up: Up::Y,
            camera: Camera::default(),
            supersample: 1,
            front: [217, 155, 108],
            colors: Vec::new(),
            back: [138, 163, 190],
            background: [[246, 247, 249], [205, 211, 219]],
            ground: true,
            lines: Vec::new(),
            line_color: [52, 40, 36],
            line_width: 1.5,
        }
    }
}

/// How dark a full shadow on the ground is, 0..=1.
const SHADOW_STRENGTH: f32 = 0.34;

/// From where the model is seen. The distance is such that it fills the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// In perspective; degrees from the front to the right and from the horizon up.
    Around { azimuth: f32, elevation: f32 },
    /// Straight from above, in parallel projection; the front is at the bottom.
    Top,
}

impl Default for Camera {
    /// Three quarters, from above.
    fn default() -> Camera {
        Camera::Around { azimuth: 28.0, elevation: 26.0 }
    }
}

/// Why there is no picture.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Error {
    /// `max` is what the device, or the supersampling, leaves.
    #[error("a picture of {width} × {height} pixels cannot be made; each side has 1 to {max}")]
    Size { width: u32, height: u32, max: u32 },
    #[error("vertex {vertex} is not finite, so there is nothing to frame")]
    NotFinite { vertex: usize },
    #[error("an index names vertex {index}, but the mesh has {vertices}")]
    Index { index: u32, vertices: usize },
    #[error("the mesh has {positions} positions but {normals} normals")]
    Normals { positions: usize, normals: usize },
    #[error("the mesh has {positions} positions but the picture {colors} colors")]
    Colors { positions: usize, colors: usize },
    /// The device refused or ran out of memory; in its words.
    #[error("the device cannot draw the picture: {0}")]
    Device(String),
}

/// Draws a mesh and waits for the image.
///
/// The same mesh, options and device give the same bytes. A mesh without triangles gives the
/// background.
///
/// # Errors
/// When the size, an index or a position is out of range, or the device fails; nothing is reported
/// through the device's uncaptured errors.
pub fn render(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    mesh: &Mesh,
    options: &Picture,
) -> Result<Image, Error> {
    check(device, mesh, options)?;
    let times = options.supersample.max(1);
    let unit = camera::Unit::of(&mesh.positions);
    let scene = draw::Scene {
        batches: batch::batches(mesh, &unit, &colors(options), draw::buffer_limit(device))?,
        lines: batch::lines(mesh, &unit, &options.lines)?,
        view: view(mesh, &unit, options, times),
        ground: ground(options),
    };
    let size = [options.width, options.height];
    let image = draw::draw(device, queue, &scene, size.map(|side| side * times))?;
    Ok(supersample::averaged(image, times))
}

fn check(device: &wgpu::Device, mesh: &Mesh, options: &Picture) -> Result<(), Error> {
    let (width, height) = (options.width, options.height);
    let max = device.limits().max_texture_dimension_2d.min(8192) / options.supersample.max(1);
    if width == 0 || height == 0 || width.max(height) > max {
        return Err(Error::Size { width, height, max });
    }
    let (positions, normals) = (mesh.positions.len(), mesh.normals.len());
    if positions != normals {
        return Err(Error::Normals { positions, normals });
    }
    let colors = options.colors.len();
    if colors != 0 && colors != positions {
        return Err(Error::Colors { positions, colors });
    }
    match mesh.positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        Some(vertex) => Err(Error::NotFinite { vertex }),
        None => Ok(()),
    }
}

/// Is the ground wanted, and seen from above?
fn ground(options: &Picture) -> bool {
    options.ground
        && match options.camera {
            Camera::Around { elevation, .. } => elevation > 0.0,
            Camera::Top => true,
        }
}

/// The linear colour of the front at each vertex.
fn colors(options: &Picture) -> impl Fn(usize) -> [f32; 3] + '_ {
    let table = supersample::linear_table();
    move |vertex| {
        let color = options.colors.get(vertex).copied().unwrap_or(options.front);
        color.map(|byte| table[usize::from(byte)])
    }
}

/// The record `View` of `wgsl/picture.wgsl`, for a picture so many `times` as wide and high.
fn view(mesh: &Mesh, unit: &camera::Unit, options: &Picture, times: u32) -> [[f32; 4]; 11] {
    let [width, height] = [options.width, options.height].map(|side| f64::from(side * times));
    let points: Vec<[f32; 3]> = mesh.positions.iter().map(|&p| unit.apply(p)).collect();
    let camera::Framed { right, up, back, projection, sky } =
        camera::frame(&points, options.camera, options.up, width / height);
    let [top, bottom] = options.background.map(linear);
    let up_axis = match options.up {
        Up::Y => 1,
        Up::Z => 2,
    };
    let lowest = points.iter().map(|p| p[up_axis]).fold(0.0, f32::min) - 0.004;
    let radius = points.iter().map(|p| p.iter().map(|x| x * x).sum()).fold(1e-6, f32::max).sqrt() * 1.02;
    [
        right,
        up,
        back,
        projection,
        sky,
        linear(options.back),
        top,
        bottom,
        linear(options.line_color),
        [width as f32, height as f32, options.line_width * times as f32, 0.0],
        [lowest, SHADOW_STRENGTH, radius, 0.0],
    ]
}

/// sRGB to linear light, alpha 1.
fn linear(color: [u8; 3]) -> [f32; 4] {
    let [r, g, b] = color.map(supersample::to_linear);
    [r, g, b, 1.0]
}
