//! What a picture of curves shows; [`svg`](super::svg) and [`raster`](super::raster) draw it.

use super::super::write::WriteError;
use super::polylines;
use crate::curve::Word;
use crate::tessellate::Up;

/// How curves are drawn.
#[derive(Clone, Debug)]
pub struct Style {
    /// A thin polygon under the curves: the points of the axiom, and whether they close.
    pub control: Option<(Vec<[f32; 3]>, bool)>,
    /// A circle at each point.
    pub points: bool,
    /// What points up: y, so that z is left out, or z, so that y is.
    pub up: Up,
    /// The width of strokes, of the larger side of what is drawn.
    pub stroke: f64,
}

impl Default for Style {
    fn default() -> Style {
        Style { control: None, points: false, up: Up::Y, stroke: 0.005 }
    }
}

/// Of the larger side.
const MARGIN: f64 = 0.05;

pub(super) const CONTROL: [u8; 3] = [185, 178, 167];
pub(super) const DOTS: [u8; 3] = [180, 71, 47];

/// One for each word.
const COLORS: [[u8; 3]; 4] = [[31, 95, 107], [176, 125, 43], [138, 62, 112], [74, 110, 44]];

/// Strokes on a white ground, in the order in which they are drawn. x points to the right, y up.
#[derive(Clone, Debug)]
pub struct Picture {
    pub title: String,
    /// The lower left corner.
    pub corner: [f64; 2],
    /// Width and height, margins and all; neither is 0.
    pub size: [f64; 2],
    pub strokes: Vec<Stroke>,
}

/// Points, joined by lines.
#[derive(Clone, Debug)]
pub struct Stroke {
    pub points: Vec<[f32; 2]>,
    pub closed: bool,
    pub color: [u8; 3],
    pub width: f64,
    /// The radius of a circle at each point; 0 for none.
    pub dots: f64,
}

impl Picture {
    /// The curves of some words in one picture. Strokes are in proportion to it, however large its coordinates are.
    ///
    /// # Errors
    /// A coordinate that is not finite, naming the point.
    pub fn of(words: &[&Word], style: &Style) -> Result<Picture, WriteError> {
        let mut strokes = Vec::new();
        if let Some(control) = &style.control {
            strokes.push(stroke(control, style.up, CONTROL)?);
        }
        for (n, word) in words.iter().enumerate() {
            for curve in &polylines(word) {
                strokes.push(stroke(curve, style.up, COLORS[n % COLORS.len()])?);
            }
        }
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in strokes.iter().flat_map(|stroke| &stroke.points) {
            for k in 0..2 {
                low[k] = low[k].min(point[k].into());
                high[k] = high[k].max(point[k].into());
            }
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        let size = [high[0] - low[0], high[1] - low[1]];
        let larger = match size[0].max(size[1]) {
            // A word of one point, or of none.
            0.0 => 1.0,
            larger => larger,
        };
        let (width, margin) = (larger * style.stroke, larger * MARGIN);
        for stroke in &mut strokes {
            let control = stroke.color == CONTROL;
            stroke.width = if control { 0.6 * width } else { width };
            stroke.dots = if style.points && !control { 2.0 * width } else { 0.0 };
        }
        Ok(Picture {
            title: words.iter().map(|word| word.system.as_str()).collect::<Vec<_>>().join(", "),
            corner: low.map(|x| x - margin),
            size: size.map(|side| side + 2.0 * margin),
            strokes,
        })
    }
}

fn stroke(curve: &(Vec<[f32; 3]>, bool), up: Up, color: [u8; 3]) -> Result<Stroke, WriteError> {
    let (points, closed) = curve;
    let flat = |(n, &[x, y, z]): (usize, &[f32; 3])| match [x, y, z].iter().find(|x| !x.is_finite()) {
        Some(&x) => Err(WriteError::not_finite(format_args!("point {n}"), x)),
        None => Ok([x, if up == Up::Y { y } else { z }]),
    };
    let points = points.iter().enumerate().map(flat).collect::<Result<_, _>>()?;
    Ok(Stroke { points, closed: *closed, color, width: 0.0, dots: 0.0 })
}
