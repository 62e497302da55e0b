//! Text that is read word by word: the scanner, and what can be wrong at a place.

use super::obj::GridError;
use crate::language::Type;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a file could not be read.
#[derive(Debug, Error)]
pub enum ReadError {
    #[error("cannot read {}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}:{error}", path.display())]
    Text { path: PathBuf, error: ParseError },
    /// The text is well formed, but not what it should be.
    #[error("{}: {error}", path.display())]
    Word { path: PathBuf, error: Box<super::json::WordReadError> },
    /// A value of a grid is not of the query's type.
    #[error("{}: {message}", path.display())]
    Values { path: PathBuf, message: String },
    /// Nobody reads such things from a file of this name.
    #[error("cannot read {}: {help}", path.display())]
    Format { path: PathBuf, help: &'static str },
}

impl ReadError {
    /// Reads a file and parses it, with the path in every error.
    pub(super) fn in_file<T>(
        path: &Path,
        parse: impl FnOnce(&[u8]) -> Result<T, ParseError>,
    ) -> Result<T, ReadError> {
        let text = ReadError::bytes(path)?;
        parse(&text).map_err(|error| ReadError::Text { path: path.into(), error })
    }

    /// The text of a file, as [`plain`] gives it.
    pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, ReadError> {
        let bytes = std::fs::read(path).map_err(|source| ReadError::Io { path: path.into(), source })?;
        plain(bytes).map_err(|problem| ReadError::Text {
            path: path.into(),
            error: ParseError { line: 1, column: 1, problem },
        })
    }
}

/// The text of a file as readers expect it: in UTF-8 without a mark before it, lines ended by a line feed. Spreadsheets
/// write UTF-16 as their Unicode text, and old programs end lines in a carriage return alone.
fn plain(bytes: Vec<u8>) -> Result<Vec<u8>, Problem> {
    let mut text = match bytes[..] {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => return Err(Problem::Encoding("UTF-32")),
        [0xff, 0xfe, ..] => from_utf16(&bytes[2..], u16::from_le_bytes)?,
        [0xfe, 0xff, ..] => from_utf16(&bytes[2..], u16::from_be_bytes)?,
        // No text has zeros: this is the half of a character.
        [1..=0x7f, 0, ..] => from_utf16(&bytes, u16::from_le_bytes)?,
        [0, 1..=0x7f, ..] => from_utf16(&bytes, u16::from_be_bytes)?,
        [0xef, 0xbb, 0xbf, ..] => bytes[3..].to_vec(),
        _ => bytes,
    };
    let mut at = 0;
    while let Some(found) = text[at..].iter().position(|&byte| byte == b'\r') {
        let start = at + found;
        at = start + text[start..].iter().take_while(|&&byte| byte == b'\r').count();
        if text.get(at) != Some(&b'\n') {
            text[start..at].fill(b'\n');
        }
    }
    Ok(text)
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<Vec<u8>, Problem> {
    let (units, rest) = bytes.as_chunks();
    let text: Result<String, _> = char::decode_utf16(units.iter().copied().map(unit)).collect();
    match (text, rest) {
        (Ok(text), []) => Ok(text.into_bytes()),
        _ => Err(Problem::Encoding("UTF-16, which is broken in places")),
    }
}

/// What is wrong with a text, and where. Lines and columns (in characters) count from 1; what is
/// missing at the end of the text lies just behind its last character.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{line}:{column}: {problem}")]
pub struct ParseError {
    pub line: usize,
    pub column: usize,
    pub problem: Problem,
}

/// What is wrong, and what would be right. Patches and points count from 0, the vertices and faces of
/// an `.obj` from 1, as its own indices do.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Problem {
    #[error("the file is in {0}: save it as UTF-8")]
    Encoding(&'static str),
    #[error("the file ends where {0} should stand")]
    Missing(Element),
    #[error("`{found}` stands where {expected} should: a whole number is needed")]
    NotACount { expected: Element, found: String },
    #[error(
        "{count} patches are announced, but a file of {bytes} bytes cannot hold more than {possible}: \
         the number of patches comes first"
    )]
    TooMany { count: String, bytes: usize, possible: usize },
    #[error("{degree} is `{found}`; degrees are from 1 to 8")]
    Degree { degree: Element, found: String },
    #[error("`{found}` stands where {expected} should: a number is needed")]
    NotANumber { expected: Element, found: String },
    #[error("{element} is `{found}`; coordinates must be finite")]
    NotFinite { element: Element, found: String },
    #[error("{element} is `{found}`, beyond the range of 32-bit floats (3.4e38)")]
    Overflow { element: Element, found: String },
    #[error("{element} is `{found}`; weights must be positive")]
    NotPositive { element: Element, found: String },
    #[error("{element} is `{found}`, but the nets wanted are polynomial: weights must be 1 or left out")]
    NotOne { element: Element, found: String },
    #[error("{found} numbers on this line where {point} should stand: write `x y z` or `x y z w`")]
    Line { point: Element, found: usize },
    #[error("`{found}` follows after the last of {patches} patches: nothing may")]
    Trailing { patches: usize, found: String },
    #[error(
        "patch {patch} is a {name}, of kind {kind}; kinds 4, 5 and 8 are read, and none was found (where the end of \
         another kind is not known, all up to the next `Group` is taken for a part of it)"
    )]
    Kind { patch: usize, kind: String, name: &'static str },
    #[error("`{found}` stands where the kind of patch {patch} should: 4, 5, 8 or `Group` is needed")]
    NotAKind { patch: usize, found: String },
    #[error("`{found}` is no statement of an .obj that is known here")]
    Statement { found: String },
    #[error("{found} numbers for {vertex}: write `x y z`, `x y z w` or `x y z r g b`")]
    Vertex { vertex: Element, found: usize },
    #[error("`{found}` is no corner of {face}: write `v`, `v/vt`, `v//vn` or `v/vt/vn` with indices from 1")]
    Corner { face: Element, found: String },
    #[error("{face} names the vertex {found}, but the file has {vertices}")]
    NoVertex { face: Element, found: String, vertices: usize },
    #[error(
        "`{found}` does not fit its tag: write `t crease 2/1/0 V W S`, `t corner 1/1/0 V S` or `t hole 1/0/0 F`, \
         where S is a sharpness and vertices V, W and faces F are counted from 0"
    )]
    Tag { found: String },
    #[error("{line} has {found} of the two vertices that a line has at least")]
    ShortLine { line: Element, found: usize },
    #[error(transparent)]
    Grid(GridError),
    #[error("columns of this row: {found}, of the first: {first}; all points have as many")]
    Row { found: usize, first: usize },
    #[error(
        "{found} where a point is {wanted}, with commas between the columns and points in decimals, as in 0.5,1.5"
    )]
    Columns { found: String, wanted: &'static str },
    #[error("the columns are {found}; they should be {wanted}, in this order and nothing else")]
    ColumnNames { found: String, wanted: &'static str },
    #[error(
        "columns of this row: {found}, of the row of their names: {names}; there is a name for each, or no such row"
    )]
    Names { found: usize, names: usize },
    #[error("`{found}` stands where {expected} should: a number is written with a point, as in 0.5")]
    DecimalComma { expected: Element, found: String },
    #[error("`{found}` stands where a number, true or false should")]
    NotAValue { found: String },
    #[error("this line is no {ty}: {wanted}")]
    OtherType { ty: Type, wanted: &'static str },
    #[error(
        "{found} stands where a number or one of the path commands M, L, H, V, C, S, Q, T, A and Z should, of which M is the first"
    )]
    PathData { found: String },
    #[error("`{found}` stands where a flag of an arc should, which is 0 or 1")]
    ArcFlag { found: String },
    #[error("`{found}` is beyond the range of 32-bit floats (3.4e38)")]
    TooLarge { found: String },
    #[error("{found} stands where a coordinate should: points are numbers, `x,y x,y`")]
    PointList { found: String },
    #[error("{found} numbers for points: each has an x and a y")]
    OddPoints { found: usize },
    #[error("{name} is `{found}`: {help}")]
    Attribute { name: String, found: String, help: &'static str },
    #[error("this use draws more than {elements} elements or {points} points with all that it names in turn")]
    TooManyUses { elements: usize, points: usize },
    #[error("the file begins with <{found}>; an .svg begins with <svg>")]
    NotSvg { found: String },
    #[error(
        "the file draws no lines; path, polyline, polygon, line, rect, circle and ellipse are read{skipped}"
    )]
    NoCurves { skipped: String },
    #[error("the file draws no lines: it has {shapes}, but renders none ({why})")]
    NoneRendered { shapes: String, why: String },
    /// In the words of the XML reader.
    #[error("{0}")]
    Xml(String),
    /// In the words of the JSON reader.
    #[error("{0}")]
    Json(String),
}

/// Something that a file names or should name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// Of patches.
    Count,
    /// Of a `.bv`.
    Kind {
        patch: usize,
    },
    /// The number of one in a `.bv`.
    Group,
    /// A number of a `.bv` in a patch of a kind that is not read.
    Skipped,
    /// Direction 0 is u (rows), 1 is v (columns).
    Degree {
        patch: usize,
        direction: usize,
    },
    Point {
        patch: usize,
        point: usize,
    },
    /// Axis 0..=2 is x, y, z; 3 is the weight.
    Coordinate {
        patch: usize,
        point: usize,
        axis: usize,
    },
    /// Of an `.obj`, from 1.
    Vertex {
        vertex: usize,
    },
    /// As in `Coordinate`.
    VertexCoordinate {
        vertex: usize,
        axis: usize,
    },
    /// Of an `.obj`, from 1.
    Face {
        face: usize,
    },
    /// Of an `.obj`, from 1.
    Line {
        line: usize,
    },
    /// Of all curves of a file together.
    CurvePoint {
        point: usize,
    },
    /// As in `Coordinate`.
    CurveCoordinate {
        point: usize,
        axis: usize,
    },
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const AXES: [&str; 4] = ["x", "y", "z", "the weight"];
        match *self {
            Element::Count => f.write_str("the number of patches"),
            Element::Kind { patch } => write!(f, "the kind of patch {patch}"),
            Element::Group => f.write_str("the number of a group"),
            Element::Skipped => f.write_str("a number of a patch of a kind that is not read"),
            Element::Degree { patch, direction } => {
                write!(f, "the degree along {} of patch {patch}", ["u", "v"][direction])
            }
            Element::Point { patch, point } => write!(f, "point {point} of patch {patch}"),
            Element::Coordinate { patch, point, axis } => {
                write!(f, "{} of point {point} of patch {patch}", AXES[axis])
            }
            Element::Vertex { vertex } => write!(f, "vertex {vertex}"),
            Element::VertexCoordinate { vertex, axis } => write!(f, "{} of vertex {vertex}", AXES[axis]),
            Element::Face { face } => write!(f, "face {face}"),
            Element::Line { line } => write!(f, "line {line}"),
            Element::CurvePoint { point } => write!(f, "point {point}"),
            Element::CurveCoordinate { point, axis } => {
                write!(f, "{} of point {point}", ["x", "y", "z", "w"][axis.min(3)])
            }
        }
    }
}

/// A problem at a byte of the text.
pub(super) struct Wrong {
    pub offset: usize,
    pub problem: Problem,
}

impl Wrong {
    pub fn locate(self, text: &[u8]) -> ParseError {
        let before = &text[..self.offset.min(text.len())];
        let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
        ParseError {
            line: before.iter().filter(|&&byte| byte == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[start..]).chars().count() + 1,
            problem: self.problem,
        }
    }
}

/// A run of bytes between white space.
#[derive(Clone, Copy)]
pub(super) struct Token<'a> {
    pub text: &'a [u8],
    pub offset: usize,
}

impl Token<'_> {
    /// As messages show it: cut short, since a token may be as long as the file.
    pub fn shown(&self) -> String {
        let text = String::from_utf8_lossy(self.text);
        match text.char_indices().nth(40) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text.into_owned(),
        }
    }

    pub fn parse<T: std::str::FromStr>(&self) -> Option<T> {
        std::str::from_utf8(self.text).ok()?.parse().ok()
    }

    pub fn wrong(&self, problem: Problem) -> Wrong {
        Wrong { offset: self.offset, problem }
    }

    /// Whether this is a whole number, of whatever size, without a sign.
    pub fn is_whole(&self) -> bool {
        !self.text.is_empty() && self.text.iter().all(u8::is_ascii_digit)
    }

    /// This number, the `element`.
    pub fn finite(&self, element: Element) -> Result<f32, Wrong> {
        let Some(value) = self.parse::<f32>() else {
            return Err(self.wrong(Problem::NotANumber { expected: element, found: self.shown() }));
        };
        // Rust reads `inf` and `nan` as numbers; a number with digits that is infinite was too large.
        let digits = self.text.iter().any(u8::is_ascii_digit);
        match value.is_finite() {
            true => Ok(value),
            false if digits => Err(self.wrong(Problem::Overflow { element, found: self.shown() })),
            false => Err(self.wrong(Problem::NotFinite { element, found: self.shown() })),
        }
    }

    /// This weight: positive, and 1 unless `rational`.
    pub fn weight(&self, element: Element, rational: bool) -> Result<f32, Wrong> {
        let weight = self.finite(element)?;
        if weight <= 0.0 {
            return Err(self.wrong(Problem::NotPositive { element, found: self.shown() }));
        }
        if weight != 1.0 && !rational {
            return Err(self.wrong(Problem::NotOne { element, found: self.shown() }));
        }
        Ok(weight)
    }
}

/// The tokens from a place on. Cheap to copy: looking ahead is reading a copy.
#[derive(Clone)]
pub(super) struct Tokens<'a> {
    pub text: &'a [u8],
    pub offset: usize,
}

impl<'a> Tokens<'a> {
    pub fn new(text: &'a [u8]) -> Tokens<'a> {
        // Some editors open every file with this mark.
        let offset = if text.starts_with("\u{feff}".as_bytes()) { 3 } else { 0 };
        Tokens { text, offset }
    }

    /// The next token, which should be `element`.
    pub fn expect(&mut self, element: Element) -> Result<Token<'a>, Wrong> {
        let end = self.text.trim_ascii_end().len();
        self.next().ok_or(Wrong { offset: end, problem: Problem::Missing(element) })
    }

    /// How many tokens are left on the line of the next one.
    pub fn on_line(&self) -> usize {
        let Some(next) = self.clone().next() else { return 0 };
        let line = self.text[next.offset..].split(|&byte| byte == b'\n').next().unwrap_or_default();
        Tokens { text: line, offset: 0 }.count()
    }

    /// Leaves out what is left of this line.
    pub fn skip_line(&mut self) {
        let rest = &self.text[self.offset..];
        self.offset += rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let rest = &self.text[self.offset..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let rest = &rest[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let offset = self.offset + start;
        self.offset = offset + length;
        Some(Token { text: &rest[..length], offset })
    }
}

/// One degree of a net; degrees bound its points to 81.
pub(super) fn degree(tokens: &mut Tokens, patch: usize, direction: usize) -> Result<u8, Wrong> {
    let element = Element::Degree { patch, direction };
    let token = tokens.expect(element)?;
    match token.parse::<u8>() {
        Some(degree) if (1..=crate::patch::MAX_DEGREE).contains(&degree) => Ok(degree),
        _ => Err(token.wrong(Problem::Degree { degree: element, found: token.shown() })),
    }
}
