//! What a picture of curves shows; [`svg`](super::svg) and [`raster`](super::raster) draw it.

use super::super::write::WriteError;
use super::{Line, lines};
use crate::curve::Word;
use crate::tessellate::Up;

/// How curves are drawn.
#[derive(Clone, Debug)]
pub struct Style {
    /// Thin polygons under the curves: those of the axiom.
    pub control: Vec<Line>,
    /// A circle at each point.
    pub points: bool,
    /// What points up: y, so that z is left out, or z, so that y is.
    pub up: Up,
    /// The width of strokes, of the larger side of what is drawn. Modules with a float `r` have that width, in
    /// units of the model.
    pub stroke: f64,
}

impl Default for Style {
    fn default() -> Style {
        Style { control: Vec::new(), points: false, up: Up::Y, stroke: 0.005 }
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
        for control in &style.control {
            strokes.extend(strokes_of(control, style.up, CONTROL)?);
        }
        for (n, word) in words.iter().enumerate() {
            for line in &lines(word) {
                strokes.extend(strokes_of(line, style.up, COLORS[n % COLORS.len()])?);
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
            if stroke.width == 0.0 {
                stroke.width = if control { 0.6 * width } else { width };
            }
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

/// The strokes of a line: one, or where its width changes several. Of width 0 they are as wide as all.
fn strokes_of(line: &Line, up: Up, color: [u8; 3]) -> Result<Vec<Stroke>, WriteError> {
    let flat = |(n, &[x, y, z]): (usize, &[f32; 3])| match [x, y, z].iter().find(|x| !x.is_finite()) {
        Some(&x) => Err(WriteError::not_finite(format_args!("point {n}"), x)),
        None => Ok([x, if up == Up::Y { y } else { z }]),
    };
    let points: Vec<[f32; 2]> = line.points.iter().enumerate().map(flat).collect::<Result<_, _>>()?;
    let stroke = |points: &[[f32; 2]], width: f64| {
        let closed = line.closed && points.len() == line.points.len();
        Stroke { points: points.to_vec(), closed, color, width, dots: 0.0 }
    };
    if line.widths.len() != points.len() || color == CONTROL {
        return Ok(vec![stroke(&points, 0.0)]);
    }
    let mut strokes = Vec::new();
    let mut start = 0;
    for end in 1..points.len() {
        let ends = line.widths.get(end + 1) != line.widths.get(end);
        if ends {
            strokes.push(stroke(&points[start..=end], f64::from(line.widths[end]).abs()));
            start = end;
        }
    }
    Ok(if strokes.is_empty() { vec![stroke(&points, 0.0)] } else { strokes })
}
