//! A curve as it is drawn: what is curved becomes lines, and a way back to the start closes it.

use crate::curve::Polyline;
use crate::io::text::Element;
use kurbo::{Affine, CubicBez, ParamCurve, PathEl, Point, QuadBez, Rect, Vec2};

/// How far a line may be off the curve that it stands for, of the size of its control polygon.
const FLAT: f64 = 1e-3;
/// Curves that end so near to their start close, of their size, however their numbers are written; of a dense curve a
/// quarter of a side, so that no point of it is taken for the first.
const SAME: f64 = 1e-5;
/// And those do that end so near to it as their numbers may have been rounded, but no farther.
const NEAR: f64 = 0.05;

/// Draws one curve after the other.
pub struct Pen {
    pub transform: Affine,
    /// Points of the curves before.
    before: usize,
    curve: Vec<[f32; 4]>,
    /// In the coordinates of the element, as is all that follows.
    start: Point,
    here: Point,
    bounds: Rect,
    length: f64,
    segments: usize,
}

impl Pen {
    pub fn new(transform: Affine, before: usize) -> Pen {
        let (curve, start) = (Vec::new(), Point::ORIGIN);
        Pen { transform, before, curve, start, here: start, bounds: Rect::ZERO, length: 0.0, segments: 0 }
    }

    /// Begins a curve. What was drawn is taken away by [`end`](Pen::end) before.
    pub fn move_to(&mut self, to: Point) -> Result<(), (Element, f64)> {
        self.curve.clear();
        (self.start, self.here, self.bounds) = (to, to, Rect::from_points(to, to));
        (self.length, self.segments) = (0.0, 0);
        self.point(to)
    }

    pub fn line_to(&mut self, to: Point) -> Result<(), (Element, f64)> {
        self.segments += 1;
        self.point(to)
    }

    /// Draws a line or a Bézier curve.
    pub fn draw(&mut self, element: PathEl) -> Result<(), (Element, f64)> {
        match element {
            PathEl::MoveTo(to) => self.move_to(to),
            PathEl::LineTo(to) => self.line_to(to),
            PathEl::QuadTo(a, to) => {
                let curve = QuadBez::new(self.here, a, to);
                self.curve(&[curve.p0, a, to], |t| curve.eval(t))
            }
            PathEl::CurveTo(a, b, to) => {
                let curve = CubicBez::new(self.here, a, b, to);
                self.curve(&[curve.p0, a, b, to], |t| curve.eval(t))
            }
            PathEl::ClosePath => Ok(()),
        }
    }

    /// Points after the first of a Bézier curve, evenly spaced in its parameter, so many that the lines between them are
    /// off by [`FLAT`] at most: each is off by an eighth of the greatest second derivative (Wang's formula). Curves of no
    /// size have none. (kurbo's `flatten` spends fewer points, but a quadratic curve that runs back along itself is its
    /// chord there.)
    fn curve(&mut self, control: &[Point], at: impl Fn(f64) -> Point) -> Result<(), (Element, f64)> {
        let degree = control.len() - 1;
        let bend = |p: &[Point]| (p[0].to_vec2() - 2.0 * p[1].to_vec2() + p[2].to_vec2()).hypot();
        let bend = control.windows(3).map(bend).fold(0.0, f64::max);
        let size = control.iter().map(|p| p.distance(control[0])).fold(0.0, f64::max);
        self.segments += 1;
        if size == 0.0 {
            return Ok(());
        }
        let second = (degree * (degree - 1)) as f64 * bend;
        let pieces = (second / (8.0 * FLAT * size)).sqrt().ceil().max(1.0);
        for n in 1..pieces as u32 {
            self.point(at(f64::from(n) / pieces))?;
        }
        self.point(control[degree])
    }

    /// A point where it is drawn, y up; its number if it is beyond the range.
    fn point(&mut self, to: Point) -> Result<(), (Element, f64)> {
        self.length += self.here.distance(to);
        self.here = to;
        self.bounds = self.bounds.union_pt(to);
        let Vec2 { x, y } = (self.transform * to).to_vec2();
        let point = [x, -y];
        if let Some(axis) = point.iter().position(|&x| !(x as f32).is_finite()) {
            return Err((
                Element::CurveCoordinate { point: self.before + self.curve.len(), axis },
                point[axis],
            ));
        }
        // −0 is a 0.
        self.curve.push([point[0] as f32 + 0.0, point[1] as f32 + 0.0, 0.0, 1.0]);
        Ok(())
    }

    /// The curve that was drawn, if it has a point, closed where it is said to be or where it ends at its start but for
    /// rounding: by a [`SAME`] part of its size, or if `unit` is what its last digits count, by one of them and √n more
    /// for n segments, each rounded by itself, yet never by more than a [`NEAR`] part of its size.
    pub fn end(&mut self, closed: bool, unit: f64) -> Option<Polyline> {
        let mut points = std::mem::take(&mut self.curve);
        let size = self.bounds.width().max(self.bounds.height());
        let rounding = unit * (1.0 + (self.segments as f64).sqrt());
        let same = (SAME * size).min(self.length / self.segments as f64 / 4.0);
        let near = (same + rounding).min(NEAR * size);
        let Vec2 { x, y } = self.here - self.start;
        let back = (x.abs() <= near && y.abs() <= near) || points.first() == points.last();
        if points.len() > 1 && back {
            points.pop();
        }
        if points.is_empty() {
            return None;
        }
        self.before += points.len();
        self.here = self.start;
        Some(Polyline { closed: Some(closed || back), points })
    }

    /// How many points were drawn of this curve.
    pub fn len(&self) -> usize {
        self.curve.len()
    }

    /// Whether a line to there had no length, but for rounding.
    pub fn at(&self, to: Point) -> bool {
        let size = self.bounds.union_pt(to).size().max_side();
        !self.curve.is_empty() && self.here.distance(to) <= 1e-9 * size
    }
}

/// What the last digit of the numbers of a text counts: those with the most decimals say it. 0 where none has a
/// decimal, since whole numbers are no rounded ones.
pub fn last_digit(text: &str) -> f64 {
    let mut decimals = 0i32;
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = 0;
    while at < bytes.len() {
        let (point, start) = (bytes[at] == b'.', at);
        if !point && !bytes[at].is_ascii_digit() {
            at += 1;
            continue;
        }
        if !point {
            at += digits(at);
        }
        let mut own = 0i32;
        if bytes.get(at) == Some(&b'.') {
            let count = digits(at + 1);
            own = i32::try_from(count).unwrap_or(i32::MAX / 2);
            at += 1 + count;
        }
        if let Some(b'e' | b'E') = bytes.get(at) {
            let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
            let count = digits(at + 1 + sign);
            if count > 0 {
                let exponent = text[at + 1..at + 1 + sign + count].parse::<i32>().unwrap_or(0);
                own = own.saturating_sub(exponent);
                at += 1 + sign + count;
            }
        }
        decimals = decimals.max(own);
        at = at.max(start + 1);
    }
    if decimals > 0 { 10f64.powi(-decimals) } else { 0.0 }
}
