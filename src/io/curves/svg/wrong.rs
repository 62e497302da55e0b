//! What is wrong with an `.svg`, at its place, and the lengths and lists that it is found in.

use super::style::Declared;
use crate::io::text::{Element, Problem, Wrong};
use roxmltree::Attribute;
use svgtypes::{Error, Length, LengthUnit};

pub fn of_attribute(attribute: &Attribute, help: &'static str) -> Wrong {
    let (name, found) = (attribute.name().to_string(), shown(attribute.value()));
    Wrong { offset: attribute.range_value().start, problem: Problem::Attribute { name, found, help } }
}

pub fn of_css(declared: &Declared, name: &str, help: &'static str) -> Wrong {
    let (name, found) = (name.to_string(), shown(declared.value));
    Wrong { offset: declared.place, problem: Problem::Attribute { name, found, help } }
}

/// As messages show it: cut short, since a value may be as long as the file.
pub fn shown(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}

/// A byte of an attribute's value as one of the file: the first where references stand between.
pub fn place(attribute: &Attribute, byte: usize) -> usize {
    let range = attribute.range_value();
    if attribute.value().len() == range.len() { range.start + byte } else { range.start }
}

/// In units of the picture, of which CSS has 96 an inch; `whole` is what percents are of.
pub fn length(length: Length, whole: Option<f64>) -> Option<f64> {
    const INCH: f64 = 96.0;
    let unit = match length.unit {
        LengthUnit::None | LengthUnit::Px => 1.0,
        LengthUnit::In => INCH,
        LengthUnit::Cm => INCH / 2.54,
        LengthUnit::Mm => INCH / 25.4,
        LengthUnit::Pt => INCH / 72.0,
        LengthUnit::Pc => INCH / 6.0,
        LengthUnit::Percent => whole? / 100.0,
        // Nothing here has a font.
        LengthUnit::Em | LengthUnit::Ex => return None,
    };
    Some(length.number * unit)
}

pub fn too_large(offset: usize, (element, x): (Element, f64)) -> Wrong {
    Wrong { offset, problem: Problem::Overflow { element, found: format!("{x:e}") } }
}

/// What stands where a number or a command should.
pub fn of_number(attribute: &Attribute, error: &Error) -> Wrong {
    let text = attribute.value();
    let character = match error {
        Error::UnexpectedData(at)
        | Error::InvalidNumber(at)
        | Error::InvalidChar(_, at)
        | Error::InvalidString(_, at) => at.saturating_sub(1),
        _ => usize::MAX,
    };
    let at = text.char_indices().nth(character).map_or(text.trim_end().len(), |(at, _)| at);
    let number = number_at(&text[at..]);
    let offset = place(attribute, at);
    if number.parse::<f64>().is_ok_and(f64::is_infinite) {
        return Wrong { offset, problem: Problem::TooLarge { found: shown(number) } };
    }
    // Where any other number may stand, a number is right.
    let command = text[..at].rfind(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E'));
    let of_arc = command.is_some_and(|command| text[command..].starts_with(['a', 'A']));
    if attribute.name() == "d" && of_arc && !number.is_empty() && !matches!(error, Error::InvalidNumber(_)) {
        return Wrong { offset, problem: Problem::ArcFlag { found: shown(number) } };
    }
    let word = text[at..].split(|c: char| c.is_whitespace() || c == ',').next().unwrap_or_default();
    let found =
        if word.is_empty() { "the end of the value".to_string() } else { format!("`{}`", shown(word)) };
    let problem = match attribute.name() {
        "d" => Problem::PathData { found },
        _ => Problem::PointList { found },
    };
    Wrong { offset, problem }
}

/// The number that a text begins with; empty if it begins with none.
fn number_at(text: &str) -> &str {
    let digits = |at: usize| at + text[at..].bytes().take_while(u8::is_ascii_digit).count();
    let sign = |at: usize| at + usize::from(text[at..].starts_with(['+', '-']));
    let whole = digits(sign(0));
    let end = if text[whole..].starts_with('.') { digits(whole + 1) } else { whole };
    if !text[..end].contains(|c: char| c.is_ascii_digit()) {
        return "";
    }
    let exponent = if text[end..].starts_with(['e', 'E']) { sign(end + 1) } else { end };
    let behind = digits(exponent);
    &text[..if behind > exponent { behind } else { end }]
}

/// Where item `n` of a list ends: the shortest beginning of the text that holds more than `n` whole ones.
pub fn end_of(text: &str, n: usize, whole: impl Fn(&str) -> usize) -> usize {
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
