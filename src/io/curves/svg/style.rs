//! What the style sheets, `style` and the attributes of an element say of it.

use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, Declaration, DeclarationTokenizer, PseudoClass, Rule, StyleSheet};

/// The properties that are looked at; rules that say nothing of them are not kept.
const PROPERTIES: [&str; 18] = [
    "display",
    "visibility",
    "transform",
    "transform-origin",
    "transform-box",
    "translate",
    "rotate",
    "scale",
    "x",
    "y",
    "width",
    "height",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "d",
];

/// The style sheets of a document, as one.
pub struct Sheet<'a>(Vec<Rule<'a>>);

impl<'a> Sheet<'a> {
    pub fn of(document: &'a Document) -> Sheet<'a> {
        let mut sheet = StyleSheet::new();
        for node in document.descendants().filter(|node| node.tag_name().name() == "style") {
            let css = node.attribute("type").is_none_or(|ty| ty.trim().eq_ignore_ascii_case("text/css"));
            let css = css && node.attribute("media").is_none_or(is_of_screens);
            for text in node.children().filter_map(|child| child.text()).filter(|_| css) {
                sheet.parse_more(text);
            }
        }
        for rule in &mut sheet.rules {
            rule.declarations.retain(is_looked_at);
        }
        sheet.rules.retain(|rule| !rule.declarations.is_empty());
        Sheet(sheet.rules)
    }

    /// All that is said of an element, what counts more later.
    pub fn style(&self, node: &Node<'a, 'a>) -> Style<'a> {
        let matching = self.0.iter().filter(|rule| rule.selector.matches(&Matched(*node)));
        let mut said: Vec<Declared> = Vec::new();
        for declaration in matching.flat_map(|rule| &rule.declarations) {
            let place = node.range().start;
            said.push(Declared::new(declaration, place));
        }
        if let Some(attribute) = node.attribute_node("style") {
            let place = attribute.range_value().start;
            let own = DeclarationTokenizer::from(attribute.value()).filter(is_looked_at);
            said.extend(own.map(|declaration| Declared::new(&declaration, place)));
        }
        // The order among equals stays.
        said.sort_by_key(|declared| declared.important);
        Style(said)
    }
}

/// Whether a list of media holds for a screen of which nothing else is known.
fn is_of_screens(media: &str) -> bool {
    let one = |query: &str| match query.trim().to_ascii_lowercase().split_whitespace().collect::<Vec<_>>()[..]
    {
        [] | ["all" | "screen"] | ["only", "all" | "screen"] => true,
        ["not", medium] => !matches!(medium, "all" | "screen"),
        _ => false,
    };
    media.split(',').any(one)
}

fn is_looked_at(declaration: &Declaration) -> bool {
    PROPERTIES.iter().any(|name| declaration.name.eq_ignore_ascii_case(name))
}

/// A value of CSS, and where in the file the element or its `style` says it.
#[derive(Clone, Copy)]
pub struct Declared<'a> {
    name: &'a str,
    pub value: &'a str,
    pub place: usize,
    important: bool,
}

impl<'a> Declared<'a> {
    fn new(declaration: &Declaration<'a>, place: usize) -> Declared<'a> {
        let &Declaration { name, value, important } = declaration;
        Declared { name, value: value.trim(), place, important }
    }
}

/// What CSS says of an element.
pub struct Style<'a>(Vec<Declared<'a>>);

impl<'a> Style<'a> {
    /// What CSS says of a property, apart from its attribute.
    pub fn css(&self, name: &str) -> Option<Declared<'a>> {
        self.0.iter().rfind(|declared| declared.name.eq_ignore_ascii_case(name)).copied()
    }

    /// The value of a property by CSS or else by its attribute.
    pub fn keyword(&self, node: &Node<'a, 'a>, name: &str) -> Option<&'a str> {
        self.css(name).map(|declared| declared.value).or(node.attribute(name).map(str::trim))
    }
}

/// An element as selectors see it.
struct Matched<'a>(Node<'a, 'a>);

impl simplecss::Element for Matched<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Matched)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Matched)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator) -> bool {
        self.0.attribute(local_name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}
