//! Pictures of curves as `.svg`.

use super::super::super::number::{write_f32, write_f64};
use super::super::super::write::{WriteError, one_line};
use super::super::picture::{DOTS, Picture, Stroke};
use std::io::Write;

/// The larger side of the picture in pixels, where nobody scales it.
const PIXELS: f64 = 800.0;
/// Points on a line of the file.
const LINE: usize = 8;

/// Writes a picture.
///
/// # Errors
/// What the writer reports.
pub fn write(writer: &mut dyn Write, picture: &Picture) -> Result<(), WriteError> {
    let [width, height] = picture.size;
    let scale = PIXELS / width.max(height);
    write!(writer, "<svg xmlns=\"http://www.w3.org/2000/svg\"")?;
    number(writer, "width", (width * scale).round().max(1.0))?;
    number(writer, "height", (height * scale).round().max(1.0))?;
    // y runs down in the file: it is turned point by point, so that no reader has to know of a transform.
    write!(writer, " viewBox=\"")?;
    for (n, x) in [picture.corner[0], -picture.corner[1] - height, width, height].into_iter().enumerate() {
        let space = if n == 0 { "" } else { " " };
        write!(writer, "{space}")?;
        write_f64(writer, x + 0.0)?;
    }
    let title = one_line(&picture.title).replace('&', "&amp;").replace('<', "&lt;");
    writeln!(writer, "\" style=\"background:#fff\">\n<title>{title}</title>")?;
    // Circles are marks on the strokes, so that nobody who reads the file takes them for curves.
    if let Some(dots) = picture.strokes.iter().map(|stroke| stroke.dots).find(|&dots| dots > 0.0) {
        let color = hex(DOTS);
        write!(
            writer,
            "<defs><marker id=\"point\" markerUnits=\"userSpaceOnUse\" overflow=\"visible\"><circle fill=\"{color}\""
        )?;
        number(writer, "r", dots)?;
        writeln!(writer, "/></marker></defs>")?;
    }
    picture.strokes.iter().filter(|stroke| !stroke.points.is_empty()).try_for_each(|s| path(writer, s))?;
    Ok(writeln!(writer, "</svg>")?)
}

fn path(writer: &mut dyn Write, stroke: &Stroke) -> Result<(), WriteError> {
    let color = hex(stroke.color);
    write!(
        writer,
        "<path fill=\"none\" stroke=\"{color}\" stroke-linejoin=\"round\" stroke-linecap=\"round\""
    )?;
    number(writer, "stroke-width", stroke.width)?;
    if stroke.dots > 0.0 {
        for place in ["start", "mid", "end"] {
            write!(writer, " marker-{place}=\"url(#point)\"")?;
        }
    }
    write!(writer, " d=\"M")?;
    for (n, &[x, y]) in stroke.points.iter().enumerate() {
        writer.write_all(if n > 0 && n % LINE == 0 { b"\n" } else { b" " })?;
        write_f32(writer, x)?;
        writer.write_all(b" ")?;
        // −0 is a 0.
        write_f32(writer, -y + 0.0)?;
    }
    let end = if stroke.closed { " Z" } else { "" };
    Ok(writeln!(writer, "{end}\"/>")?)
}

fn number(writer: &mut dyn Write, name: &str, x: f64) -> Result<(), WriteError> {
    write!(writer, " {name}=\"")?;
    write_f64(writer, x)?;
    Ok(write!(writer, "\"")?)
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
