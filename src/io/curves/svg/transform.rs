//! Transforms: of attributes, of CSS, and of what shows one box in another.

use super::style::Style;
use super::wrong::{length, of_attribute, of_css};
use crate::io::text::{Problem, Wrong};
use kurbo::{Affine, Vec2};
use roxmltree::Node;
use std::str::FromStr;
use svgtypes::{Align, Angle, AspectRatio, Length, Transform, TransformOrigin, ViewBox};

/// Width and height of what lengths in percent are of.
pub type Viewport = Option<[f64; 2]>;

const TRANSFORM: &str = "a transform is made of matrix, translate, scale, rotate, skewX and skewY";

/// The transform of an element: what CSS says stands in place of its attribute.
pub fn of_element<'a>(node: &Node<'a, 'a>, style: &Style<'a>, viewport: Viewport) -> Result<Affine, Wrong> {
    for name in ["translate", "rotate", "scale"] {
        if let Some(declared) = style.css(name).filter(|declared| !is_none(declared.value)) {
            return Err(of_css(&declared, name, "it is not read; the property transform is"));
        }
    }
    let transform = match (style.css("transform"), node.attribute_node("transform")) {
        (Some(declared), _) => {
            css(declared.value, viewport).ok_or_else(|| of_css(&declared, "transform", TRANSFORM))?
        }
        (None, Some(attribute)) => {
            let own =
                Transform::from_str(attribute.value()).map(|t| Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]));
            let own = own.ok().or_else(|| css(attribute.value(), viewport));
            own.ok_or_else(|| of_attribute(&attribute, TRANSFORM))?
        }
        (None, None) => return Ok(Affine::IDENTITY),
    };
    if transform == Affine::IDENTITY {
        return Ok(transform);
    }
    let origin = origin(node, style, viewport)?;
    Ok(Affine::translate(origin) * transform * Affine::translate(-origin))
}

/// The point that stays, which is the origin where nothing is said.
fn origin<'a>(node: &Node<'a, 'a>, style: &Style<'a>, viewport: Viewport) -> Result<Vec2, Wrong> {
    const BOX: &str = "only view-box is read: apply the transform in the editor";
    const ORIGIN: &str = "it is not read unless it is two lengths: apply the transform in the editor";
    let refuse = |name: &str, help| match (style.css(name), node.attribute_node(name)) {
        (Some(declared), _) => of_css(&declared, name, help),
        (None, Some(attribute)) => of_attribute(&attribute, help),
        (None, None) => {
            let (name, found) = (name.to_string(), String::new());
            Wrong { offset: node.range().start, problem: Problem::Attribute { name, found, help } }
        }
    };
    // Where nobody names a point, it is a corner of the box.
    let box_of = style.keyword(node, "transform-box");
    if box_of.is_some_and(|value| !["view-box", "initial", ""].iter().any(|b| value.eq_ignore_ascii_case(b)))
    {
        return Err(refuse("transform-box", BOX));
    }
    let Some(value) = style.keyword(node, "transform-origin") else { return Ok(Vec2::ZERO) };
    let origin = TransformOrigin::from_str(value).map_err(|_| refuse("transform-origin", ORIGIN))?;
    let offset = |axis, length_of: Length| length(length_of, viewport.map(|size| size[axis]));
    match (offset(0, origin.x_offset), offset(1, origin.y_offset)) {
        (Some(x), Some(y)) => Ok(Vec2::new(x, y)),
        _ => Err(refuse("transform-origin", ORIGIN)),
    }
}

fn is_none(value: &str) -> bool {
    value.eq_ignore_ascii_case("none")
}

/// A transform as CSS writes it: lengths and angles have units.
fn css(text: &str, viewport: Viewport) -> Option<Affine> {
    let mut rest = text.trim();
    if is_none(rest) {
        return Some(Affine::IDENTITY);
    }
    let mut product = Affine::IDENTITY;
    while !rest.is_empty() {
        let (name, behind) = rest.split_once('(')?;
        let (arguments, behind) = behind.split_once(')')?;
        let arguments = arguments.split(|c: char| c == ',' || c.is_whitespace()).filter(|a| !a.is_empty());
        product *= function(&name.trim().to_ascii_lowercase(), &arguments.collect::<Vec<_>>(), viewport)?;
        rest = behind.trim_start_matches(|c: char| c == ',' || c.is_whitespace());
    }
    Some(product)
}

fn function(name: &str, arguments: &[&str], viewport: Viewport) -> Option<Affine> {
    let number = |n: usize| arguments.get(n)?.parse::<f64>().ok();
    let along = |axis: usize, n: usize| {
        length(Length::from_str(arguments.get(n)?).ok()?, viewport.map(|size| size[axis]))
    };
    let angle = |n: usize| Some(Angle::from_str(arguments.get(n)?).ok()?.to_degrees().to_radians());
    let skew = |x: f64, y: f64| Affine::new([1.0, y.tan(), x.tan(), 1.0, 0.0, 0.0]);
    Some(match (name, arguments.len()) {
        ("matrix", 6) => {
            let entries: Vec<f64> = (0..6).map_while(number).collect();
            Affine::new(entries.try_into().ok()?)
        }
        ("translate", 1) | ("translatex", 1) => Affine::translate((along(0, 0)?, 0.0)),
        ("translate", 2) => Affine::translate((along(0, 0)?, along(1, 1)?)),
        ("translatey", 1) => Affine::translate((0.0, along(1, 0)?)),
        ("scale", 1) => Affine::scale(number(0)?),
        ("scale", 2) => Affine::scale_non_uniform(number(0)?, number(1)?),
        ("scalex", 1) => Affine::scale_non_uniform(number(0)?, 1.0),
        ("scaley", 1) => Affine::scale_non_uniform(1.0, number(0)?),
        ("rotate", 1) => Affine::rotate(angle(0)?),
        ("skew", 1) | ("skewx", 1) => skew(angle(0)?, 0.0),
        ("skew", 2) => skew(angle(0)?, angle(1)?),
        ("skewy", 1) => skew(0.0, angle(0)?),
        _ => return None,
    })
}

/// The `viewBox` of an element; `None` if it has none.
pub fn view_box(node: &Node) -> Result<Option<ViewBox>, Wrong> {
    let Some(attribute) = node.attribute_node("viewBox") else { return Ok(None) };
    let help = "a viewBox is four numbers, of which width and height are positive";
    ViewBox::from_str(attribute.value()).map(Some).map_err(|_| of_attribute(&attribute, help))
}

/// From the `viewBox` of an element to a box of this size at the origin.
pub fn into_box(node: &Node, view: &ViewBox, [width, height]: [f64; 2]) -> Result<Affine, Wrong> {
    let ratio = match node.attribute_node("preserveAspectRatio") {
        Some(attribute) => AspectRatio::from_str(attribute.value().trim())
            .map_err(|_| of_attribute(&attribute, "it is none or one as xMidYMid, with meet or slice"))?,
        None => AspectRatio::default(),
    };
    let [x, y] = [width / view.w, height / view.h];
    let [x, y] = match ratio {
        AspectRatio { align: Align::None, .. } => [x, y],
        AspectRatio { slice: true, .. } => [x.max(y); 2],
        _ => [x.min(y); 2],
    };
    use Align::{XMaxYMax, XMaxYMid, XMaxYMin, XMidYMax, XMidYMid, XMidYMin, XMinYMax, XMinYMid};
    let part = |middle: bool, end: bool| {
        if end {
            1.0
        } else if middle {
            0.5
        } else {
            0.0
        }
    };
    let align = ratio.align;
    let at = [
        part(
            matches!(align, XMidYMin | XMidYMid | XMidYMax),
            matches!(align, XMaxYMin | XMaxYMid | XMaxYMax),
        ),
        part(
            matches!(align, XMinYMid | XMidYMid | XMaxYMid),
            matches!(align, XMinYMax | XMidYMax | XMaxYMax),
        ),
    ];
    let left = Vec2::new((width - view.w * x) * at[0], (height - view.h * y) * at[1]);
    Ok(Affine::translate(left) * Affine::scale_non_uniform(x, y) * Affine::translate((-view.x, -view.y)))
}
