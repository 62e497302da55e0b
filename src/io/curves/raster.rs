//! Pictures of curves as pixels.

use super::super::png::Image;
use super::picture::{DOTS, Picture, Stroke};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Transform};

/// The longest side that is drawn.
const MOST: u32 = 8192;
/// Points of one path: what the rasteriser takes for a path grows faster than its length.
const PIECE: usize = 1024;
/// Points nearer to the last one than this, in pixels, are left out: nobody would see them.
const NEAR: f32 = 1.0 / 16.0;

/// Draws a picture with anti-aliased strokes; its larger side has so many pixels, 1 to 8192.
pub fn draw(picture: &Picture, side: u32) -> Image {
    let side = side.clamp(1, MOST);
    let scale = f64::from(side) / picture.size[0].max(picture.size[1]);
    let [width, height] = picture.size.map(|size| ((size * scale).round() as u32).clamp(1, side));
    let mut pixels = Pixmap::new(width, height).expect("sides of 1 to 8192 pixels");
    pixels.fill(Color::WHITE);
    let top = picture.corner[1] + picture.size[1];
    let place = |&[x, y]: &[f32; 2]| {
        let [x, y] = [f64::from(x) - picture.corner[0], top - f64::from(y)].map(|x| (x * scale) as f32);
        [x, y]
    };
    for stroke in &picture.strokes {
        let all = stroke.points.iter().map(place);
        lines(&mut pixels, stroke, all.clone(), (stroke.width * scale) as f32);
        if stroke.dots > 0.0 {
            dots(&mut pixels, all, (stroke.dots * scale) as f32);
        }
    }
    // The ground is opaque, so all pixels are.
    Image { width, height, pixels: pixels.take() }
}

fn paint([r, g, b]: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

fn lines(pixels: &mut Pixmap, stroke: &Stroke, all: impl Iterator<Item = [f32; 2]>, width: f32) {
    let mut points: Vec<[f32; 2]> = Vec::new();
    let mut left_out = None;
    for point in all {
        let near = |last: &[f32; 2]| (point[0] - last[0]).hypot(point[1] - last[1]) < NEAR;
        left_out = points.last().is_some_and(near).then_some(point);
        if left_out.is_none() {
            points.push(point);
        }
    }
    points.extend(left_out);
    let whole = points.len() <= PIECE;
    if stroke.closed && !whole {
        points.push(points[0]);
    }
    let pen = tiny_skia::Stroke {
        width,
        line_cap: LineCap::Round,
        line_join: LineJoin::Round,
        ..tiny_skia::Stroke::default()
    };
    for start in (0..points.len().saturating_sub(1)).step_by(PIECE - 1) {
        let mut path = PathBuilder::new();
        for (n, &[x, y]) in points[start..points.len().min(start + PIECE)].iter().enumerate() {
            if n == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if stroke.closed && whole {
            path.close();
        }
        if let Some(path) = path.finish() {
            pixels.stroke_path(&path, &paint(stroke.color), &pen, Transform::identity(), None);
        }
    }
}

fn dots(pixels: &mut Pixmap, all: impl Iterator<Item = [f32; 2]>, radius: f32) {
    for [x, y] in all {
        let mut path = PathBuilder::new();
        path.push_circle(x, y, radius);
        if let Some(path) = path.finish() {
            pixels.fill_path(&path, &paint(DOTS), FillRule::Winding, Transform::identity(), None);
        }
    }
}
