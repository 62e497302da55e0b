//! Curves from `.svg`.

use super::super::super::text::{Element, ParseError, Problem, Wrong};
use super::super::Polyline;
use roxmltree::{Attribute, Document, Node, ParsingOptions};
use std::str::FromStr;
use svgtypes::{
    Error, Length, LengthUnit, NumberListParser, SimplePathSegment, SimplifyingPathParser, Transform,
};

const SVG: &str = "http://www.w3.org/2000/svg";

/// Reads a curve for each `polyline`, `polygon`, `line`, `rect` and subpath of a `path`, with the transforms of their
/// elements. What is curved in a path becomes so many points that lines between them are off it by a thousandth of the
/// size of each piece at most. y points down in the file and up in the points. A curve that ends at its first point
/// has it once. What is not drawn where it stands (`defs`, `symbol`, `marker`, …), text and images are passed over.
///
/// # Errors
/// XML that is wrong, another shape, what is no number or too large, a file without curves.
pub fn parse(text: &[u8]) -> Result<Vec<Polyline>, ParseError> {
    read(text).map_err(|wrong| wrong.locate(text))
}

fn read(text: &[u8]) -> Result<Vec<Polyline>, Wrong> {
    let wrong = |offset, problem: &str| Wrong { offset, problem: Problem::Xml(problem.to_string()) };
    if text.trim_ascii().is_empty() {
        return Err(wrong(0, "the file is empty: an .svg begins with <svg>"));
    }
    let text = str::from_utf8(text).map_err(|e| wrong(e.valid_up_to(), "the file is not UTF-8"))?;
    // Old editors write a DOCTYPE.
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        // The place stands before the message.
        let message = e.to_string();
        let message = message.rsplit_once(" at ").map_or(message.as_str(), |(message, _)| message);
        wrong(offset_of(text, e.pos()), message)
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let found = root.tag_name().name().to_string();
        return Err(Wrong { offset: root.range().start, problem: Problem::NotSvg { found } });
    }
    let mut curves = Curves { curves: Vec::new(), points: 0 };
    // No recursion: elements may be nested as deep as the file is long.
    let mut rest = vec![(root, Transform::default())];
    while let Some((node, outer)) = rest.pop() {
        let transform = match node.attribute_node("transform") {
            Some(attribute) => {
                let inner = Transform::from_str(attribute.value()).map_err(|_| of_attribute(&attribute))?;
                product(&outer, &inner)
            }
            None => outer,
        };
        if node == root || curves.element(&node, &transform)? {
            let drawn = |n: &Node| n.is_element() && n.tag_name().namespace().is_none_or(|ns| ns == SVG);
            rest.extend(node.children().rev().filter(drawn).map(|child| (child, transform)));
        }
    }
    if curves.curves.is_empty() {
        return Err(Wrong { offset: root.range().start, problem: Problem::NoCurves });
    }
    Ok(curves.curves)
}

/// The byte of a place that the XML reader names.
fn offset_of(text: &str, pos: roxmltree::TextPos) -> usize {
    let before: usize =
        text.split_inclusive('\n').take(pos.row.saturating_sub(1) as usize).map(str::len).sum();
    let column = pos.col.saturating_sub(1) as usize;
    before + text[before..].char_indices().nth(column).map_or(text.len() - before, |(at, _)| at)
}

fn of_attribute(attribute: &Attribute) -> Wrong {
    let (name, found) = (attribute.name().to_string(), shown(attribute.value()));
    Wrong { offset: attribute.range_value().start, problem: Problem::Attribute { name, found } }
}

/// As messages show it: cut short, since a value may be as long as the file.
fn shown(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// A byte of an attribute's value as one of the file: the first where references stand between.
fn place(attribute: &Attribute, byte: usize) -> usize {
    let range = attribute.range_value();
    if attribute.value().len() == range.len() { range.start + byte } else { range.start }
}

fn product(a: &Transform, b: &Transform) -> Transform {
    let linear = |x: f64, y: f64| [a.a * x + a.c * y, a.b * x + a.d * y];
    let ([p, q], [r, s], [t, u]) = (linear(b.a, b.b), linear(b.c, b.d), linear(b.e, b.f));
    Transform::new(p, q, r, s, t + a.e, u + a.f)
}

struct Curves {
    curves: Vec<Polyline>,
    /// In all of them.
    points: usize,
}

impl Curves {
    /// Reads what an element draws. Returns whether its children are to be read.
    fn element(&mut self, node: &Node, transform: &Transform) -> Result<bool, Wrong> {
        match node.tag_name().name() {
            "path" => self.path(node, transform)?,
            "polyline" | "polygon" => self.points(node, transform)?,
            "line" => {
                let [x1, y1, x2, y2] = numbers(node, ["x1", "y1", "x2", "y2"])?;
                self.shape(node, transform, &[[x1, y1], [x2, y2]])?;
            }
            "rect" => {
                let [x, y, width, height, rx, ry] = numbers(node, ["x", "y", "width", "height", "rx", "ry"])?;
                if rx != 0.0 || ry != 0.0 {
                    return Err(no_lines(node, "rect with round corners"));
                }
                let (right, bottom) = (x + width, y + height);
                self.shape(node, transform, &[[x, y], [right, y], [right, bottom], [x, bottom]])?;
            }
            found @ ("circle" | "ellipse" | "use" | "svg") => return Err(no_lines(node, found)),
            "g" | "a" | "switch" => return Ok(true),
            _ => {}
        }
        Ok(false)
    }

    /// A point where it is drawn, y up; its number if it is beyond the range.
    fn point(&self, t: &Transform, [x, y]: [f64; 2], so_far: usize) -> Result<[f32; 4], (Element, f64)> {
        let point = [t.a * x + t.c * y + t.e, -(t.b * x + t.d * y + t.f)];
        match point.iter().position(|&x| !(x as f32).is_finite()) {
            Some(axis) => Err((Element::CurveCoordinate { point: self.points + so_far, axis }, point[axis])),
            // −0 is a 0.
            None => Ok([point[0] as f32 + 0.0, point[1] as f32 + 0.0, 0.0, 1.0]),
        }
    }

    fn finish(&mut self, curve: &mut Polyline) {
        if curve.len() > 1 && curve.first() == curve.last() {
            curve.pop();
        }
        if !curve.is_empty() {
            self.points += curve.len();
            self.curves.push(std::mem::take(curve));
        }
    }

    fn shape(&mut self, node: &Node, transform: &Transform, corners: &[[f64; 2]]) -> Result<(), Wrong> {
        let mut curve = Polyline::new();
        for &corner in corners {
            let point = self.point(transform, corner, curve.len());
            curve.push(point.map_err(|e| too_large(node.range().start, e))?);
        }
        self.finish(&mut curve);
        Ok(())
    }

    fn points(&mut self, node: &Node, transform: &Transform) -> Result<(), Wrong> {
        let Some(attribute) = node.attribute_node("points") else { return Ok(()) };
        let text = attribute.value();
        let list = NumberListParser::from(text).collect::<Result<Vec<f64>, _>>();
        let list = list.map_err(|e| of_number(&attribute, &e))?;
        if list.len() % 2 != 0 {
            let problem = Problem::OddPoints { found: list.len() };
            return Err(Wrong { offset: place(&attribute, text.trim_end().len()), problem });
        }
        let mut curve = Polyline::new();
        for (n, &point) in list.as_chunks().0.iter().enumerate() {
            let point = self.point(transform, point, curve.len()).map_err(|e| {
                let whole = |t: &str| NumberListParser::from(t).filter(Result::is_ok).count() / 2;
                too_large(place(&attribute, end_of(text, n, whole)), e)
            });
            curve.push(point?);
        }
        self.finish(&mut curve);
        Ok(())
    }

    fn path(&mut self, node: &Node, transform: &Transform) -> Result<(), Wrong> {
        let Some(attribute) = node.attribute_node("d") else { return Ok(()) };
        let text = attribute.value();
        let (mut here, mut curve) = ([0.0; 2], Polyline::new());
        for (n, segment) in SimplifyingPathParser::from(text).enumerate() {
            let segment = segment.map_err(|e| of_number(&attribute, &e))?;
            let control = match segment {
                SimplePathSegment::ClosePath => {
                    self.finish(&mut curve);
                    continue;
                }
                SimplePathSegment::MoveTo { x, y } => {
                    // A move alone draws nothing.
                    if curve.len() > 1 {
                        self.finish(&mut curve);
                    }
                    curve.clear();
                    vec![[x, y]]
                }
                SimplePathSegment::LineTo { x, y } => vec![[x, y]],
                SimplePathSegment::Quadratic { x1, y1, x, y } => vec![here, [x1, y1], [x, y]],
                SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => {
                    vec![here, [x1, y1], [x2, y2], [x, y]]
                }
            };
            for point in flat(&control) {
                let point = self.point(transform, point, curve.len()).map_err(|e| {
                    let whole = |t: &str| SimplifyingPathParser::from(t).filter(Result::is_ok).count();
                    too_large(place(&attribute, end_of(text, n, whole)), e)
                });
                curve.push(point?);
            }
            here = control.last().copied().unwrap_or(here);
        }
        if curve.len() > 1 {
            self.finish(&mut curve);
        }
        Ok(())
    }
}

/// How far a line may be off the curve that it stands for, of the size of its control polygon.
const FLAT: f64 = 1e-3;

/// Points behind the first of a Bézier curve, evenly spaced in its parameter, so many that the lines between them are off
/// by [`FLAT`] at most: each is off by an eighth of the greatest second derivative (Wang's formula). A point alone is
/// itself.
fn flat(control: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let degree = control.len() - 1;
    if degree == 0 {
        return control.to_vec();
    }
    let away = |[x, y]: [f64; 2]| x.hypot(y);
    let bend = |p: &[[f64; 2]]| away([0, 1].map(|k| p[0][k] - 2.0 * p[1][k] + p[2][k]));
    let bend = control.windows(3).map(bend).fold(0.0, f64::max);
    let size = control.iter().map(|p| away([0, 1].map(|k| p[k] - control[0][k]))).fold(0.0, f64::max);
    let second = (degree * (degree - 1)) as f64 * bend;
    let pieces = (second / (8.0 * FLAT * size)).sqrt().ceil().max(1.0);
    let at = |n: u32| {
        // As de Casteljau cuts a curve.
        let (t, mut points) = (f64::from(n) / pieces, control.to_vec());
        for last in (1..points.len()).rev() {
            for i in 0..last {
                points[i] = [0, 1].map(|k| points[i][k] * (1.0 - t) + points[i + 1][k] * t);
            }
        }
        points[0]
    };
    let inner = (1..pieces as u32).map(at);
    inner.chain(control.last().copied()).collect()
}

/// Lengths in units of the picture; what is missing is 0.
fn numbers<const N: usize>(node: &Node, names: [&str; N]) -> Result<[f64; N], Wrong> {
    let mut values = [0.0; N];
    for (value, name) in values.iter_mut().zip(names) {
        let Some(attribute) = node.attribute_node(name) else { continue };
        *value = match Length::from_str(attribute.value()) {
            Ok(Length { number, unit: LengthUnit::None | LengthUnit::Px }) => number,
            _ => return Err(of_attribute(&attribute)),
        };
    }
    Ok(values)
}

fn no_lines(node: &Node, found: &str) -> Wrong {
    Wrong { offset: node.range().start, problem: Problem::NoLines { found: found.to_string() } }
}

fn too_large(offset: usize, (element, x): (Element, f64)) -> Wrong {
    Wrong { offset, problem: Problem::Overflow { element, found: format!("{x:e}") } }
}

/// What stands where a number or a command should.
fn of_number(attribute: &Attribute, error: &Error) -> Wrong {
    let text = attribute.value();
    let character = match error {
        Error::UnexpectedData(at)
        | Error::InvalidNumber(at)
        | Error::InvalidChar(_, at)
        | Error::InvalidString(_, at) => at.saturating_sub(1),
        _ => usize::MAX,
    };
    let at = text.char_indices().nth(character).map_or(text.trim_end().len(), |(at, _)| at);
    let word = text[at..].split(|c: char| c.is_whitespace() || c == ',').next().unwrap_or_default();
    let found =
        if word.is_empty() { "the end of the value".to_string() } else { format!("`{}`", shown(word)) };
    let problem = match attribute.name() {
        "d" => Problem::PathData { found },
        _ => Problem::PointList { found },
    };
    Wrong { offset: place(attribute, at), problem }
}

/// Where item `n` of a list ends: the shortest beginning of the text that holds more than `n` whole ones.
fn end_of(text: &str, n: usize, whole: impl Fn(&str) -> usize) -> usize {
    let (mut low, mut high) = (0, text.len());
    while low < high {
        let middle = text.floor_char_boundary((low + high) / 2);
        if whole(&text[..middle]) > n {
            high = middle;
        } else {
            low = text.ceil_char_boundary(middle + 1);
        }
    }
    high.saturating_sub(1)
}
