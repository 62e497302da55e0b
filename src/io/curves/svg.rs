//! Curves as `.svg` pictures: x to the right, y up, z left out.

use super::super::number::write_f64;
use super::super::write::{WriteError, one_line};
use super::polylines;
use crate::curve::Word;
use std::io::Write;

/// What a picture shows beside the curve.
#[derive(Clone, Debug, Default)]
pub struct Style {
    /// A thin polygon under the curve: the points of the axiom, and whether they close.
    pub control: Option<(Vec<[f32; 3]>, bool)>,
    /// A circle at each point.
    pub points: bool,
}

/// Of the larger side of the picture.
const STROKE: f64 = 0.005;
const MARGIN: f64 = 0.05;

/// The side of the picture in pixels, where nobody scales it.
const PIXELS: f64 = 800.0;

/// Writes the curve of a word. Strokes are in proportion to the picture, however large its coordinates are.
///
/// # Errors
/// What the writer reports; a coordinate that is not finite, naming the module.
pub fn write(writer: &mut dyn Write, word: &Word, style: &Style) -> Result<(), WriteError> {
    let curves = polylines(word);
    let control = style.control.as_slice();
    let all = || curves.iter().chain(control).flat_map(|(points, _)| points);
    for (n, point) in all().enumerate() {
        if let Some(&x) = point.iter().find(|x| !x.is_finite()) {
            return Err(WriteError::not_finite(format_args!("point {n}"), x));
        }
    }
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in all() {
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
    let (stroke, margin) = (larger * STROKE, larger * MARGIN);
    let [width, height] = size.map(|side| side + 2.0 * margin);
    let scale = PIXELS / width.max(height);
    write!(writer, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"")?;
    write_f64(writer, (width * scale).round())?;
    write!(writer, "\" height=\"")?;
    write_f64(writer, (height * scale).round())?;
    write!(writer, "\" viewBox=\"")?;
    // y runs down in the file: it is turned point by point, so that no reader has to know of a transform.
    numbers(writer, &[low[0] - margin, -high[1] - margin, width, height])?;
    let title = one_line(&word.system).replace('&', "&amp;").replace('<', "&lt;");
    writeln!(writer, "\">\n<title>{title}</title>")?;
    let mut path = |(points, closed): &(Vec<[f32; 3]>, bool), stroke: f64, colour: &str| {
        if points.is_empty() {
            return Ok(());
        }
        write!(
            writer,
            "<path fill=\"none\" stroke=\"{colour}\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke-width=\""
        )?;
        write_f64(writer, stroke)?;
        write!(writer, "\" d=\"M")?;
        for [x, y, _] in points {
            write!(writer, " ")?;
            numbers(writer, &[f64::from(*x), -f64::from(*y)])?;
        }
        let end = if *closed { " Z" } else { "" };
        writeln!(writer, "{end}\"/>").map_err(WriteError::from)
    };
    for curve in control {
        path(curve, stroke * 0.6, "#b9b2a7")?;
    }
    for curve in &curves {
        path(curve, stroke, "#1f5f6b")?;
    }
    if style.points {
        writeln!(writer, "<g fill=\"#b4472f\">")?;
        for [x, y, _] in curves.iter().flat_map(|(points, _)| points) {
            write!(writer, "<circle r=\"")?;
            write_f64(writer, 2.0 * stroke)?;
            write!(writer, "\" cx=\"")?;
            write_f64(writer, f64::from(*x))?;
            write!(writer, "\" cy=\"")?;
            write_f64(writer, -f64::from(*y))?;
            writeln!(writer, "\"/>")?;
        }
        writeln!(writer, "</g>")?;
    }
    Ok(writeln!(writer, "</svg>")?)
}

/// Numbers with spaces between them.
fn numbers(writer: &mut dyn Write, list: &[f64]) -> Result<(), WriteError> {
    for (n, &x) in list.iter().enumerate() {
        if n > 0 {
            write!(writer, " ")?;
        }
        // −0 is a 0.
        write_f64(writer, x + 0.0)?;
    }
    Ok(())
}
