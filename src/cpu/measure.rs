//! The attributes of nets that the rules read: see [`crate::plan::measure`].
//!
//! Every sum runs over the net row by row, and lengths are spelled out, as in the kernel.

use super::BLOCK;
use super::program::Input;
use crate::plan::layout::Header;
use crate::plan::measure::Row;
use glam::Vec4;
use rayon::prelude::*;

/// The net of one module, and what is the same for all.
struct Measured<'a> {
    columns: usize,
    /// The parameters of rows and of columns, from 0 to 1.
    parameters: &'a [Vec<f32>; 2],
    /// As they stand in memory.
    homogeneous: &'a [[f32; 4]],
    /// In space: divided by their weights where the net is rational.
    points: &'a [Vec4],
    /// The words of the view.
    view: &'a [u32],
}

/// Fills `out`, a row of words a module. `view` is where the environment holds the view.
pub fn measure(row: &Row, input: &Input, nets: &[[f32; 4]], rational: bool, view: usize, out: &mut [u32]) {
    let n = input.layout.net_points();
    let spread = |degree: u8| -> Vec<f32> { (0..=degree).map(|i| i as f32 / degree as f32).collect() };
    let parameters = input.layout.net.unwrap_or([1; 2]).map(spread);
    let columns = parameters[1].len();
    let view = &input.environment[view..];
    out.par_chunks_mut(BLOCK * row.words).enumerate().for_each(|(block, out)| {
        let start = block * BLOCK;
        let mut points = vec![Vec4::ZERO; n];
        let mut pixels = vec![Vec4::ZERO; n];
        for (i, out) in out.chunks_exact_mut(row.words).enumerate() {
            let homogeneous = &nets[(start + i) * n..][..n];
            if row.reads_nets() {
                for (p, h) in points.iter_mut().zip(homogeneous) {
                    let h = Vec4::from_array(*h);
                    *p = if rational { h / h.w } else { h };
                }
            }
            let net = Measured { columns, parameters: &parameters, homogeneous, points: &points, view };
            net.fill(row, &mut pixels, out);
            if let Some(at) = row.place("uv") {
                put(out, at, &centre(&Header::read(input.record(start + i))));
            }
        }
    });
}

fn put(out: &mut [u32], at: usize, values: &[f32]) {
    out[at..].iter_mut().zip(values).for_each(|(word, x)| *word = x.to_bits());
}

/// The centre of the module's cell in its root's square.
fn centre(header: &Header) -> [f32; 2] {
    let middle = |index: u32, halvings: u8| (2 * index + 1) as f32 * (-(halvings as f32) - 1.0).exp2();
    [middle(header.cell.i, header.cell.du), middle(header.cell.j, header.cell.dv)]
}

/// x² + y² + z²
fn square(d: Vec4) -> f32 {
    d.x * d.x + d.y * d.y + d.z * d.z
}

impl Measured<'_> {
    /// All that is read of the net; `pixels` is room for its points on the screen.
    fn fill(&self, row: &Row, pixels: &mut [Vec4], out: &mut [u32]) {
        let [centroid, flatness, bend_u, bend_v, area, bbox_px, area_px, _] = row.places;
        if let Some(at) = centroid {
            put(out, at, &self.centroid()[..3]);
        }
        if let Some(at) = flatness {
            put(out, at, &[self.flatness()]);
        }
        if let Some(at) = bend_u {
            put(out, at, &[self.bend(self.columns)]);
        }
        if let Some(at) = bend_v {
            put(out, at, &[self.bend(1)]);
        }
        if let Some(at) = area {
            put(out, at, &[self.area()]);
        }
        if bbox_px.or(area_px).is_some() {
            let known = self.project(pixels);
            if let Some(at) = bbox_px {
                put(out, at, &[known.unwrap_or_else(|| bbox_px_of(pixels))]);
            }
            if let Some(at) = area_px {
                put(out, at, &[known.unwrap_or_else(|| self.area_px(pixels))]);
            }
        }
    }

    fn rows(&self) -> usize {
        self.points.len() / self.columns
    }

    /// Mean of the control points.
    fn centroid(&self) -> [f32; 4] {
        let sum = self.points.iter().copied().reduce(|a, b| a + b).unwrap_or(Vec4::ZERO);
        (sum / self.points.len() as f32).to_array()
    }

    /// Greatest distance of a point from the bilinear patch of the corners at its parameters.
    fn flatness(&self) -> f32 {
        let (m, n) = (self.rows() - 1, self.columns - 1);
        let corner = |i: usize, j: usize| self.points[i * self.columns + j];
        let (c00, c01, c10, c11) = (corner(0, 0), corner(0, n), corner(m, 0), corner(m, n));
        let mut greatest = 0f32;
        let [us, vs] = self.parameters;
        for (row, &u) in self.points.chunks_exact(self.columns).zip(us) {
            let (left, right) = (c00 + (c10 - c00) * u, c01 + (c11 - c01) * u);
            for (&p, &v) in row.iter().zip(vs) {
                greatest = greatest.max(square(p - (left + (right - left) * v)));
            }
        }
        greatest.sqrt()
    }

    /// Greatest second difference of points that stand `stride` apart.
    fn bend(&self, stride: usize) -> f32 {
        let mut greatest = 0f32;
        let [down, across] = if stride == 1 { [0, 1] } else { [1, 0] };
        for i in 0..self.rows().saturating_sub(2 * down) {
            for j in 0..self.columns.saturating_sub(2 * across) {
                let at = |k: usize| self.points[i * self.columns + j + k * stride];
                greatest = greatest.max(square((at(2) + at(0)) - at(1) * 2.0));
            }
        }
        greatest.sqrt()
    }

    /// Calls `visit` with the diagonals of every quad of the net.
    fn quads(&self, point: impl Fn(usize) -> Vec4, mut visit: impl FnMut(Vec4, Vec4)) {
        for i in 0..self.rows() - 1 {
            for j in 0..self.columns - 1 {
                let at = |r: usize, c: usize| point((i + r) * self.columns + j + c);
                visit(at(1, 1) - at(0, 0), at(0, 1) - at(1, 0));
            }
        }
    }

    /// Areas of the net's quads, summed: half the cross product of the diagonals each.
    fn area(&self) -> f32 {
        let mut sum = 0f32;
        let cross = |a: Vec4, b: Vec4| {
            Vec4::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x, 0.0)
        };
        self.quads(|k| self.points[k], |a, b| sum += square(cross(a, b)).sqrt());
        sum * 0.5
    }

    /// A point in clip space.
    fn clip(&self, k: usize) -> Vec4 {
        let column =
            |c: usize| Vec4::from_array(std::array::from_fn(|r| f32::from_bits(self.view[4 * c + r])));
        let [x, y, z, w] = self.homogeneous[k];
        column(0) * x + column(1) * y + column(2) * z + column(3) * w
    }

    /// The points on the screen, in pixels; or how large the net is there, where that is known
    /// without: nothing behind the eye, and beyond all bounds where it reaches through its plane.
    fn project(&self, pixels: &mut [Vec4]) -> Option<f32> {
        let half = |at: usize| f32::from_bits(self.view[at]) * 0.5;
        let scale = Vec4::new(half(16), half(17), 0.0, 0.0);
        let mut before = 0;
        for (k, pixel) in pixels.iter_mut().enumerate() {
            let clip = self.clip(k);
            before += usize::from(clip.w > 0.0);
            *pixel = clip / clip.w * scale;
        }
        match before {
            0 => Some(0.0),
            n if n < pixels.len() => Some(f32::MAX),
            _ => None,
        }
    }

    /// Areas of the net's quads on the screen, summed.
    fn area_px(&self, pixels: &[Vec4]) -> f32 {
        let mut sum = 0f32;
        self.quads(|k| pixels[k], |a, b| sum += (a.x * b.y - a.y * b.x).abs());
        sum * 0.5
    }
}

/// Greater side of the points' box on the screen.
fn bbox_px_of(pixels: &[Vec4]) -> f32 {
    let least = pixels.iter().copied().reduce(Vec4::min).unwrap_or(Vec4::ZERO);
    let greatest = pixels.iter().copied().reduce(Vec4::max).unwrap_or(Vec4::ZERO);
    (greatest.x - least.x).max(greatest.y - least.y)
}
