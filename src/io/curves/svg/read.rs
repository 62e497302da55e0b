//! Curves from `.svg`: the elements that are rendered, one after the other.

use super::shapes::Along;
use super::style::{Sheet, Style};
use super::transform::{self, Viewport, into_box, view_box};
use crate::curve::Polyline;
use crate::io::Noted;
use crate::io::notes::Tally;
use crate::io::text::{ParseError, Problem, Wrong};
use kurbo::Affine;
use roxmltree::{Document, Node, NodeId, ParsingOptions};
use std::collections::HashMap;
use std::rc::Rc;

const SVG: &str = "http://www.w3.org/2000/svg";
const XLINK: &str = "http://www.w3.org/1999/xlink";

/// Elements that are not rendered where they stand, and what belongs to others. The names of all others that are
/// neither shapes nor groups are said, since somebody sees them.
const NOT_RENDERED: [&str; 31] = [
    "defs",
    "symbol",
    "clipPath",
    "mask",
    "marker",
    "pattern",
    "linearGradient",
    "radialGradient",
    "meshgradient",
    "hatch",
    "solidcolor",
    "solidColor",
    "filter",
    "style",
    "script",
    "title",
    "desc",
    "metadata",
    "view",
    "cursor",
    "font",
    "font-face",
    "color-profile",
    "animate",
    "animateColor",
    "animateMotion",
    "animateTransform",
    "set",
    "discard",
    "mpath",
    "stop",
];

/// Elements that draw lines.
const SHAPES: [&str; 7] = ["path", "polyline", "polygon", "line", "rect", "circle", "ellipse"];

/// Elements drawn by `use`, and points in all: more come of a few lines that name each other, not of a drawing.
const MOST_ELEMENTS: usize = 1 << 20;
const MOST_POINTS: usize = 1 << 25;

/// Reads a curve for each `polyline`, `polygon`, `line`, `rect`, `circle` and `ellipse` and each subpath of a `path`,
/// with the transforms of their elements; y points down in the file and up in the points.
///
/// What is not rendered is not read: what `display` or `visibility` hides, by attribute, `style` or style sheet, what
/// stands in `defs`, `symbol`, `marker` and their like, and all but the first child of a `switch` whose conditions hold
/// (the language is English). `use` draws what it names, and an `svg` in another is fitted into its box. The `viewBox` of
/// the outermost gives the points no scale. Text, images, shapes without a size or in a transform that leaves none, those
/// with a length that is not read, and a `use` of what it is a part of are skipped, and a note counts them.
///
/// What is curved becomes so many points that lines between them are off it by a thousandth of the size of each piece at
/// most. A curve that ends at its first point has it once, and is closed; a path does also where rounded numbers miss the
/// start: by 10⁻⁵ of its size (of a dense one a quarter of a side), or, if it has relative commands and decimals, by 1 + √n units of its last decimal for n
/// segments, within a twentieth of its size. An arc to its own start adds no point.
///
/// # Errors
/// XML that is wrong, a value that is none, a number that is too large, a file without curves.
pub fn parse(text: &[u8]) -> Result<Noted<Vec<Polyline>>, ParseError> {
    read(text).map_err(|wrong| wrong.locate(text))
}

fn read(text: &[u8]) -> Result<Noted<Vec<Polyline>>, Wrong> {
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
    let reader = Reader::new(&document);
    let (curves, skipped) = reader.all(root)?;
    if curves.is_empty() {
        let shape = |node: &Node| is_svg(node) && SHAPES.contains(&node.tag_name().name());
        let skipped = skipped.note();
        let problem = match root.descendants().filter(shape).count() {
            0 => Problem::NoCurves { skipped: skipped.map(|note| format!(" ({note})")).unwrap_or_default() },
            count => {
                let shapes = format!("{count} shape{}", if count == 1 { "" } else { "s" });
                let why = skipped.unwrap_or_else(|| {
                    "hidden by display or visibility, in defs that nothing uses, or of a single point"
                        .to_string()
                });
                Problem::NoneRendered { shapes, why }
            }
        };
        return Err(Wrong { offset: root.range().start, problem });
    }
    Ok(Noted { value: curves, notes: skipped.note().into_iter().collect() })
}

/// The byte of a place that the XML reader names.
fn offset_of(text: &str, pos: roxmltree::TextPos) -> usize {
    let before: usize =
        text.split_inclusive('\n').take(pos.row.saturating_sub(1) as usize).map(str::len).sum();
    let column = pos.col.saturating_sub(1) as usize;
    before + text[before..].char_indices().nth(column).map_or(text.len() - before, |(at, _)| at)
}

/// An element that is to be read, and what it inherits.
#[derive(Clone)]
struct Place<'a> {
    node: Node<'a, 'a>,
    transform: Affine,
    visible: bool,
    viewport: Viewport,
    instance: Option<Rc<Instance<'a>>>,
}

/// What a `use` draws.
struct Instance<'a> {
    node: Node<'a, 'a>,
    target: NodeId,
    within: Option<Rc<Instance<'a>>>,
}

/// An element that is drawn.
pub struct Drawn<'a, 's> {
    pub node: Node<'a, 'a>,
    pub style: &'s Style<'a>,
    pub transform: Affine,
    pub viewport: Viewport,
}

/// Reads the elements of a document.
pub struct Reader<'a> {
    sheet: Sheet<'a>,
    /// Elements by their `id`.
    named: HashMap<&'a str, Node<'a, 'a>>,
    read: Vec<Polyline>,
    /// In all curves.
    pub points: usize,
    pub skipped: Tally,
    /// Elements read as parts of instances.
    instances: usize,
    /// No recursion: elements may be nested as deep as the file is long.
    rest: Vec<Place<'a>>,
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document) -> Reader<'a> {
        let mut named = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                named.entry(id).or_insert(node);
            }
        }
        Reader {
            sheet: Sheet::of(document),
            named,
            read: Vec::new(),
            points: 0,
            skipped: Tally::default(),
            instances: 0,
            rest: Vec::new(),
        }
    }

    fn all(mut self, root: Node<'a, 'a>) -> Result<(Vec<Polyline>, Tally), Wrong> {
        let transform = Affine::IDENTITY;
        self.rest.push(Place { node: root, transform, visible: true, viewport: None, instance: None });
        while let Some(place) = self.rest.pop() {
            self.element(place)?;
        }
        Ok((self.read, self.skipped))
    }

    /// Takes what was drawn.
    pub fn curves(&mut self, curve: Option<Polyline>) {
        if let Some(curve) = curve {
            self.points += curve.points.len();
            self.read.push(curve);
        }
    }

    fn element(&mut self, mut place: Place<'a>) -> Result<(), Wrong> {
        let node = place.node;
        let name = node.tag_name().name();
        let instantiated = place.instance.as_ref().is_some_and(|instance| instance.target == node.id());
        if (NOT_RENDERED.contains(&name) && !(instantiated && name == "symbol")) || !conditions_hold(&node) {
            return Ok(());
        }
        if let Some(instance) = &place.instance {
            self.instances += 1;
            if self.instances > MOST_ELEMENTS || self.points > MOST_POINTS {
                let problem = Problem::TooManyUses { elements: MOST_ELEMENTS, points: MOST_POINTS };
                return Err(Wrong { offset: instance.node.range().start, problem });
            }
        }
        let style = self.sheet.style(&node);
        if style.keyword(&node, "display").is_some_and(|value| value.eq_ignore_ascii_case("none")) {
            return Ok(());
        }
        if let Some(value) = style.keyword(&node, "visibility") {
            match value.to_ascii_lowercase().as_str() {
                "hidden" | "collapse" => place.visible = false,
                "visible" | "initial" => place.visible = true,
                _ => {}
            }
        }
        place.transform *= transform::of_element(&node, &style, place.viewport)?;
        let drawn = Drawn { node, style: &style, transform: place.transform, viewport: place.viewport };
        match name {
            "g" | "a" => self.children(&place),
            "switch" => {
                let chosen =
                    node.children().find(|child| is_svg(child) && is_choice(child) && conditions_hold(child));
                self.rest.extend(chosen.map(|node| Place { node, ..place }));
            }
            "svg" if node.parent_element().is_none() && !instantiated => {
                // What the drawing shows it in is none of the points' business.
                let size = [drawn.length("width", Along::X), drawn.length("height", Along::Y)];
                let size = size.map(|length| length.ok().flatten().filter(|&x| x > 0.0));
                place.viewport = match (view_box(&node).ok().flatten(), size) {
                    (Some(view), _) => Some([view.w, view.h]),
                    (None, [Some(width), Some(height)]) => Some([width, height]),
                    _ => None,
                };
                self.children(&place);
            }
            "svg" | "symbol" => {
                let read = self.framed(place, &drawn, name);
                self.or_skipped(read, name)?;
            }
            "use" => {
                let read = self.instance(&place, &drawn);
                self.or_skipped(read, name)?;
            }
            _ if !place.visible => {}
            _ if !SHAPES.contains(&name) => self.skipped.add(name),
            // As of sizes of zero, nothing is rendered of it.
            _ if is_flat(place.transform) => self.skipped.add(&format!("{name} in a transform of size zero")),
            _ => {
                let read = self.shape(&drawn, name);
                self.or_skipped(read, name)?;
            }
        }
        Ok(())
    }

    /// An element with a value that is not read is left out, and counted: it is no reason to refuse the others.
    fn or_skipped(&mut self, read: Result<(), Wrong>, element: &str) -> Result<(), Wrong> {
        match read {
            Err(Wrong { problem: Problem::Attribute { name, found, help }, .. }) => {
                self.skipped.add(&format!("{element} whose {name} is not read (`{found}`: {help})"));
                Ok(())
            }
            read => read,
        }
    }

    fn children(&mut self, parent: &Place<'a>) {
        let children = parent.node.children().rev().filter(is_svg);
        self.rest.extend(children.map(|node| Place { node, ..parent.clone() }));
    }

    /// An `svg` in another, or a `symbol`: its `viewBox` is fitted into its box, whose size a `use` may say.
    fn framed(&mut self, mut place: Place<'a>, drawn: &Drawn<'a, '_>, name: &str) -> Result<(), Wrong> {
        let by_use = place.instance.clone().filter(|instance| instance.target == place.node.id());
        let style = by_use.as_ref().map(|instance| self.sheet.style(&instance.node));
        let outer = |name, along| match (&by_use, &style) {
            (Some(instance), Some(style)) => {
                Drawn { node: instance.node, style, transform: place.transform, viewport: place.viewport }
                    .length(name, along)
            }
            _ => Ok(None),
        };
        let side = |name, along, whole: Option<f64>| -> Result<Option<f64>, Wrong> {
            Ok(outer(name, along)?.or(drawn.length(name, along)?).or(whole))
        };
        let whole = |axis: usize| place.viewport.map(|size| size[axis]);
        let size = [side("width", Along::X, whole(0))?, side("height", Along::Y, whole(1))?];
        if size.iter().flatten().any(|&x| x <= 0.0) {
            self.skipped.add(&format!("{name} without a size"));
            return Ok(());
        }
        let corner = [drawn.length("x", Along::X)?, drawn.length("y", Along::Y)?].map(|x| x.unwrap_or(0.0));
        place.transform *= Affine::translate((corner[0], corner[1]));
        let size = size[0].zip(size[1]).map(|(width, height)| [width, height]);
        if let Some(view) = view_box(&place.node)? {
            // Where nobody says how large the box is, it is as large as what it shows.
            place.transform *= into_box(&place.node, &view, size.unwrap_or([view.w, view.h]))?;
            place.viewport = Some([view.w, view.h]);
        } else {
            place.viewport = size;
        }
        self.children(&place);
        Ok(())
    }

    fn instance(&mut self, place: &Place<'a>, drawn: &Drawn<'a, '_>) -> Result<(), Wrong> {
        let node = place.node;
        let Some(href) = node.attribute_node("href").or(node.attribute_node((XLINK, "href"))) else {
            self.skipped.add("use of nothing");
            return Ok(());
        };
        let Some(target) = href.value().trim().strip_prefix('#') else {
            self.skipped.add("use of another file");
            return Ok(());
        };
        let Some(&target) = self.named.get(target).filter(|target| is_svg(target)) else {
            self.skipped.add("use of nothing");
            return Ok(());
        };
        let of_instance = |id| {
            std::iter::successors(place.instance.as_ref(), |instance| instance.within.as_ref())
                .any(|instance| instance.target == id)
        };
        if of_instance(target.id()) || node.ancestors().any(|around| around == target) {
            // It would never end.
            self.skipped.add("use of what it is a part of");
            return Ok(());
        }
        let corner = [drawn.length("x", Along::X)?, drawn.length("y", Along::Y)?].map(|x| x.unwrap_or(0.0));
        let transform = place.transform * Affine::translate((corner[0], corner[1]));
        let instance = Instance { node, target: target.id(), within: place.instance.clone() };
        self.rest.push(Place { node: target, transform, instance: Some(Rc::new(instance)), ..*place });
        Ok(())
    }
}

fn is_svg(node: &Node) -> bool {
    node.is_element() && node.tag_name().namespace().is_none_or(|ns| ns == SVG)
}

/// Whether what is transformed has no area, but for rounding.
fn is_flat(transform: Affine) -> bool {
    let [a, b, c, d, ..] = transform.as_coeffs();
    let (x, y) = (a.hypot(b), c.hypot(d));
    // Scaled to axes of length one, since both may be small.
    x == 0.0 || y == 0.0 || ((a / x) * (d / y) - (b / x) * (c / y)).abs() < 1e-12
}

/// Whether a `switch` may take it.
fn is_choice(node: &Node) -> bool {
    !NOT_RENDERED.contains(&node.tag_name().name())
}

/// Whether an element is for readers of English that know no extensions.
fn conditions_hold(node: &Node) -> bool {
    let english = |list: &str| {
        list.split(',')
            .map(|tag| tag.trim().to_ascii_lowercase())
            .any(|tag| tag == "en" || tag.starts_with("en-"))
    };
    node.attribute("requiredExtensions").is_none() && node.attribute("systemLanguage").is_none_or(english)
}
