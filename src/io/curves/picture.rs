//! What a picture of curves shows; [`svg`](super::svg) and [`raster`](super::raster) draw it.

use super::super::write::WriteError;
use super::{Line, lines};
use crate::curve::Word;
use crate::tessellate::Up;

/// How curves are drawn.
#[derive(Clone, Debug)]
pub struct Style {
    /// A circle at each point.
    pub points: bool,
    /// What points up: y, so that z is left out, or z, so that y is.
    pub up: Up,
    /// The width of strokes, of the larger side of what is drawn, or of one panel. Modules with a float `r` have that width, in
    /// units of the model.
    pub stroke: f64,
}

impl Default for Style {
    fn default() -> Style {
        Style { points: false, up: Up::Y, stroke: 0.005 }
    }
}

/// Words drawn over each other.
#[derive(Clone, Debug, Default)]
pub struct Panel<'a> {
    pub words: Vec<&'a Word>,
    /// Thin polygons under the curves: those of the axiom.
    pub control: Vec<Line>,
}

/// Of the larger side.
const MARGIN: f64 = 0.05;

/// Between panels, of the larger side of one.
const GAP: f64 = 0.12;

/// Width to height of a sheet whose columns nobody has set, about.
const SHAPE: f64 = 1.5;

pub(super) const CONTROL: [u8; 3] = [185, 178, 167];
pub(super) const DOTS: [u8; 3] = [180, 71, 47];

const INK: [u8; 3] = [31, 95, 107];

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
    /// The curves of some words in one picture, where their coordinates are. Strokes are in proportion to it, however
    /// large these are.
    ///
    /// # Errors
    /// A coordinate that is not finite, naming the point.
    pub fn of(words: &[&Word], style: &Style) -> Result<Picture, WriteError> {
        Picture::sheet(&[Panel { words: words.to_vec(), control: Vec::new() }], None, style)
    }

    /// Panels side by side in rows, all of one scale: each stands in the middle of its column, on the lower end of its
    /// row. A single one stays where its coordinates are.
    ///
    /// # Errors
    /// As [`Picture::of`].
    pub fn sheet(panels: &[Panel], columns: Option<usize>, style: &Style) -> Result<Picture, WriteError> {
        let strokes = |(n, panel)| {
            strokes_of_panel(panel, style.up).map_err(|e: WriteError| e.of_word(n, panels.len()))
        };
        let drawn = panels.iter().enumerate().map(strokes);
        let mut drawn = drawn.collect::<Result<Vec<_>, _>>()?;
        let boxes: Vec<[[f64; 2]; 2]> = drawn.iter().map(|strokes| around(strokes)).collect();
        // Of the largest panel.
        let size = |[low, high]: &[[f64; 2]; 2]| [high[0] - low[0], high[1] - low[1]];
        let place = boxes.iter().map(size).fold([0.0; 2], |a: [f64; 2], b| [a[0].max(b[0]), a[1].max(b[1])]);
        let larger = match place[0].max(place[1]) {
            // A word of one point, or of none.
            0.0 => 1.0,
            larger => larger,
        };
        let (mut corner, mut whole) = (boxes.first().map_or([0.0; 2], |b| b[0]), place);
        if panels.len() > 1 {
            let gap = GAP * larger;
            let columns = columns.unwrap_or_else(|| columns_for(panels.len(), place.map(|side| side + gap)));
            let columns = columns.clamp(1, panels.len());
            let rows = panels.len().div_ceil(columns);
            // Each row is as high as its highest panel, each column as wide as its widest; rows count from below.
            let (mut widths, mut heights) = (vec![0.0f64; columns], vec![0.0f64; rows]);
            let cell = |n: usize| (n % columns, rows - 1 - n / columns);
            for (n, [width, height]) in boxes.iter().map(size).enumerate() {
                let (column, row) = cell(n);
                widths[column] = widths[column].max(width);
                heights[row] = heights[row].max(height);
            }
            let before = |sides: &[f64]| sides.iter().map(|side| side + gap).sum::<f64>();
            for (n, (strokes, [low, high])) in drawn.iter_mut().zip(&boxes).enumerate() {
                let (column, row) = cell(n);
                let left = before(&widths[..column]) + (widths[column] - (high[0] - low[0])) / 2.0;
                let by = [left - low[0], before(&heights[..row]) - low[1]];
                for point in strokes.iter_mut().flat_map(|stroke| &mut stroke.points) {
                    *point = [0, 1].map(|k| (f64::from(point[k]) + by[k]) as f32);
                }
            }
            (corner, whole) = ([0.0; 2], [before(&widths) - gap, before(&heights) - gap]);
        }
        let mut strokes: Vec<Stroke> = drawn.into_iter().flatten().collect();
        let (width, margin) = (larger * style.stroke, larger * MARGIN);
        for stroke in &mut strokes {
            let control = stroke.color == CONTROL;
            if stroke.width == 0.0 {
                stroke.width = if control { 0.6 * width } else { width };
            }
            stroke.dots = if style.points && !control { 2.0 * width } else { 0.0 };
        }
        let mut names: Vec<&str> =
            panels.iter().flat_map(|panel| &panel.words).map(|word| word.system.as_str()).collect();
        names.dedup();
        Ok(Picture {
            title: names.join(", "),
            corner: corner.map(|x| x - margin),
            size: whole.map(|side| side + 2.0 * margin),
            strokes,
        })
    }
}

/// Columns of so many panels of a size: a sheet of about [`SHAPE`], with few places left over.
fn columns_for(panels: usize, [width, height]: [f64; 2]) -> usize {
    let wanted = (panels as f64 * SHAPE * height / width).sqrt();
    let near = (0.7 * wanted).ceil() as usize..=(1.5 * wanted) as usize;
    let left_over = |columns: &usize| (columns - panels % columns) % columns;
    let best = near.filter(|&n| (1..=panels).contains(&n)).min_by(|a, b| {
        let off = |n: &usize| (*n as f64 - wanted).abs();
        left_over(a).cmp(&left_over(b)).then(off(a).total_cmp(&off(b)))
    });
    best.unwrap_or_else(|| (wanted.round() as usize).clamp(1, panels))
}

fn strokes_of_panel(panel: &Panel, up: Up) -> Result<Vec<Stroke>, WriteError> {
    let mut strokes = Vec::new();
    for control in &panel.control {
        strokes.extend(strokes_of(control, up, CONTROL)?);
    }
    for line in panel.words.iter().flat_map(|word| lines(word)) {
        strokes.extend(strokes_of(&line, up, INK)?);
    }
    Ok(strokes)
}

/// The lower left and the upper right corner of what is drawn; 0 of nothing.
fn around(strokes: &[Stroke]) -> [[f64; 2]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in strokes.iter().flat_map(|stroke| &stroke.points) {
        for k in 0..2 {
            low[k] = low[k].min(point[k].into());
            high[k] = high[k].max(point[k].into());
        }
    }
    if low[0] > high[0] { [[0.0; 2]; 2] } else { [low, high] }
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
