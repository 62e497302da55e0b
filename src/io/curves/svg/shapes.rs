//! The shapes: what each draws.

use super::pen::{Pen, last_digit};
use super::read::{Drawn, Reader};
use super::wrong::{end_of, length, of_attribute, of_css, of_number, place, too_large};
use crate::io::text::{Problem, Wrong};
use kurbo::{Affine, Circle, PathEl, Point, RoundedRect, Shape};
use roxmltree::Attribute;
use std::str::FromStr;
use svgtypes::{Length, NumberListParser, SimplePathSegment, SimplifyingPathParser};

/// How far kurbo's cubic curves may be off an arc of radius 1.
const ROUND: f64 = 3e-4;

/// What lengths in percent are of.
#[derive(Clone, Copy)]
pub enum Along {
    X,
    Y,
    Diagonal,
}

impl Drawn<'_, '_> {
    /// A length, if it is given and not `auto`.
    pub fn length(&self, name: &str, along: Along) -> Result<Option<f64>, Wrong> {
        let help = |text: &str| match text {
            _ if text.ends_with('%') => "the svg has no viewBox and no size to be a part of",
            _ if ["em", "ex", "ch", "rem"].iter().any(|unit| text.ends_with(unit)) => "no font is known here",
            _ => "a length is a number, with px, mm, cm, in, pt or pc if it has a unit",
        };
        let whole = self.viewport.map(|[width, height]| match along {
            Along::X => width,
            Along::Y => height,
            Along::Diagonal => width.hypot(height) / std::f64::consts::SQRT_2,
        });
        let read = |text: &str| match text {
            "auto" | "" => Some(None),
            text => Length::from_str(text).ok().and_then(|l| length(l, whole)).map(Some),
        };
        match (self.style.css(name), self.node.attribute_node(name)) {
            (Some(declared), _) => {
                read(declared.value).ok_or_else(|| of_css(&declared, name, help(declared.value)))
            }
            (None, Some(attribute)) => read(attribute.value().trim())
                .ok_or_else(|| of_attribute(&attribute, help(attribute.value().trim()))),
            (None, None) => Ok(None),
        }
    }

    fn lengths<const N: usize>(&self, names: [(&str, Along); N]) -> Result<[Option<f64>; N], Wrong> {
        let mut values = [None; N];
        for (value, (name, along)) in values.iter_mut().zip(names) {
            *value = self.length(name, along)?;
        }
        Ok(values)
    }

    /// The two radii of an ellipse or of corners: one that is not given, or negative, is the other.
    fn radii(&self) -> Result<Option<[f64; 2]>, Wrong> {
        let [rx, ry] = self.lengths([("rx", Along::X), ("ry", Along::Y)])?.map(|r| r.filter(|&r| r >= 0.0));
        Ok(rx.or(ry).zip(ry.or(rx)).map(|(rx, ry)| [rx, ry]))
    }
}

impl Reader<'_> {
    /// Reads what a shape draws.
    pub fn shape(&mut self, drawn: &Drawn, name: &str) -> Result<(), Wrong> {
        match name {
            "path" => self.path(drawn),
            "polyline" => self.list(drawn, false),
            "polygon" => self.list(drawn, true),
            "line" => {
                let ends = [("x1", Along::X), ("y1", Along::Y), ("x2", Along::X), ("y2", Along::Y)];
                let [x1, y1, x2, y2] = drawn.lengths(ends)?.map(|x| x.unwrap_or(0.0));
                if (x1, y1) == (x2, y2) {
                    self.skipped.add("line without a length");
                    return Ok(());
                }
                let ends = [PathEl::MoveTo((x1, y1).into()), PathEl::LineTo((x2, y2).into())];
                self.elements(drawn, ends, false)
            }
            "rect" => self.rect(drawn),
            "circle" | "ellipse" => {
                let [cx, cy] = drawn.lengths([("cx", Along::X), ("cy", Along::Y)])?.map(|x| x.unwrap_or(0.0));
                let radii = match name {
                    "circle" => drawn.length("r", Along::Diagonal)?.map(|r| [r, r]),
                    _ => drawn.radii()?,
                };
                match radii.filter(|radii| radii.iter().all(|&r| r > 0.0)) {
                    // As a unit circle, so that accuracy is a part of it.
                    Some([rx, ry]) => {
                        let to = Affine::translate((cx, cy)) * Affine::scale_non_uniform(rx, ry);
                        let round = Circle::new(Point::ORIGIN, 1.0);
                        self.elements(drawn, round.path_elements(ROUND).map(|el| to * el), true)
                    }
                    None => {
                        self.skipped.add(&format!("{name} without a size"));
                        Ok(())
                    }
                }
            }
            // No shape: the caller knows them.
            _ => Ok(()),
        }
    }

    fn rect(&mut self, drawn: &Drawn) -> Result<(), Wrong> {
        let sides = [("x", Along::X), ("y", Along::Y), ("width", Along::X), ("height", Along::Y)];
        let [x, y, width, height] = drawn.lengths(sides)?.map(|x| x.unwrap_or(0.0));
        if !(width > 0.0 && height > 0.0) {
            self.skipped.add("rect without a size");
            return Ok(());
        }
        let [rx, ry] = drawn.radii()?.unwrap_or([0.0; 2]);
        let [rx, ry] = [rx.min(width / 2.0), ry.min(height / 2.0)];
        if rx == 0.0 || ry == 0.0 {
            let (right, bottom) = (x + width, y + height);
            let corners = [[x, y], [right, y], [right, bottom], [x, bottom]].map(|[x, y]| Point::new(x, y));
            let [first, rest @ ..] = corners;
            let lines = rest.into_iter().map(PathEl::LineTo);
            return self.elements(drawn, std::iter::once(PathEl::MoveTo(first)).chain(lines), true);
        }
        // With corners of radius 1.
        let to = Affine::translate((x, y)) * Affine::scale_non_uniform(rx, ry);
        let round = RoundedRect::new(0.0, 0.0, width / rx, height / ry, 1.0);
        self.elements(drawn, round.path_elements(ROUND).map(|el| to * el), true)
    }

    /// A curve of elements in which lines of no length are none.
    fn elements(
        &mut self,
        drawn: &Drawn,
        elements: impl IntoIterator<Item = PathEl>,
        closed: bool,
    ) -> Result<(), Wrong> {
        let mut pen = Pen::new(drawn.transform, self.points);
        let offset = drawn.node.range().start;
        for element in elements {
            let none = matches!(element, PathEl::LineTo(to) if closed && pen.at(to));
            if !none {
                pen.draw(element).map_err(|e| too_large(offset, e))?;
            }
        }
        self.curves(pen.end(closed, 0.0));
        Ok(())
    }

    /// The `points` of a polyline or a polygon.
    fn list(&mut self, drawn: &Drawn, closed: bool) -> Result<(), Wrong> {
        let name = drawn.node.tag_name().name();
        let attribute =
            drawn.node.attribute_node("points").filter(|list| !matches!(list.value().trim(), "" | "none"));
        let Some(attribute) = attribute else {
            self.skipped.add(&format!("{name} without points"));
            return Ok(());
        };
        let text = attribute.value();
        let list = NumberListParser::from(text).collect::<Result<Vec<f64>, _>>();
        let list = list.map_err(|e| of_number(&attribute, &e))?;
        if list.len() % 2 != 0 {
            let problem = Problem::OddPoints { found: list.len() };
            return Err(Wrong { offset: place(&attribute, text.trim_end().len()), problem });
        }
        let mut pen = Pen::new(drawn.transform, self.points);
        for (n, &[x, y]) in list.as_chunks().0.iter().enumerate() {
            let to = Point::new(x, y);
            let drawn = if n == 0 { pen.move_to(to) } else { pen.line_to(to) };
            drawn.map_err(|e| {
                let whole = |t: &str| NumberListParser::from(t).filter(Result::is_ok).count() / 2;
                too_large(place(&attribute, end_of(text, n, whole)), e)
            })?;
        }
        self.curves(pen.end(closed, 0.0));
        Ok(())
    }

    fn path(&mut self, drawn: &Drawn) -> Result<(), Wrong> {
        if let Some(declared) = drawn.style.css("d") {
            return Err(of_css(&declared, "d", "the data of a path are read from its attribute d"));
        }
        let Some(attribute) = drawn.node.attribute_node("d") else {
            self.skipped.add("path without data");
            return Ok(());
        };
        let text = attribute.value();
        if text.trim() == "none" {
            return Ok(());
        }
        // An arc to its own start is none, and comes as a line of no length.
        let arcs = text.contains(['a', 'A']);
        let relative = text.contains(['m', 'l', 'h', 'v', 'c', 's', 'q', 't', 'a']);
        let unit = if relative { last_digit(text) } else { 0.0 };
        let mut pen = Pen::new(drawn.transform, self.points);
        for (n, segment) in SimplifyingPathParser::from(text).enumerate() {
            let element = match segment.map_err(|e| of_number(&attribute, &e))? {
                SimplePathSegment::ClosePath => {
                    self.curves(pen.end(true, unit));
                    continue;
                }
                SimplePathSegment::MoveTo { x, y } => {
                    // A move alone draws nothing.
                    if pen.len() > 1 {
                        self.curves(pen.end(false, unit));
                    }
                    PathEl::MoveTo((x, y).into())
                }
                SimplePathSegment::LineTo { x, y } if arcs && pen.at((x, y).into()) => continue,
                SimplePathSegment::LineTo { x, y } => PathEl::LineTo((x, y).into()),
                SimplePathSegment::Quadratic { x1, y1, x, y } => {
                    PathEl::QuadTo((x1, y1).into(), (x, y).into())
                }
                SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => {
                    PathEl::CurveTo((x1, y1).into(), (x2, y2).into(), (x, y).into())
                }
            };
            pen.draw(element).map_err(|e| too_large(offset_of(&attribute, n), e))?;
        }
        if pen.len() > 1 {
            self.curves(pen.end(false, unit));
        }
        Ok(())
    }
}

/// Where segment `n` of a path ends.
fn offset_of(attribute: &Attribute, n: usize) -> usize {
    let whole = |t: &str| SimplifyingPathParser::from(t).filter(Result::is_ok).count();
    place(attribute, end_of(attribute.value(), n, whole))
}
