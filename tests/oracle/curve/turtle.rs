//! The turtle: from a word of moves and turns to the points that it visits.

use super::super::expression::Constants;
use super::word::{Module, Token, Topology, Word};

/// Declared in every curve system, each with one float.
pub const SYMBOLS: [&str; 10] = ["F", "f", "+", "-", "&", "^", "/", "\\", "|", "!"];

/// What stands for the argument that is left out.
pub fn omitted(symbol: &str, constants: &Constants) -> f64 {
    match symbol {
        "F" | "f" | "!" => 1.0,
        // Turns around, whatever `angle` is.
        "|" => 180.0,
        _ => constants.get("angle").map_or(90.0, |angle| angle.clone().float()),
    }
}

/// A point that the turtle writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub position: [f64; 3],
    pub width: f64,
}

/// Where the turtle is: its own axes are heading, left and up.
#[derive(Clone, Copy, Debug)]
struct Turtle {
    position: [f64; 3],
    heading: [f64; 3],
    left: [f64; 3],
    up: [f64; 3],
    width: f64,
}

impl Turtle {
    /// At the origin, heading +y, +z up; so −x is left.
    fn new() -> Turtle {
        Turtle {
            position: [0.0; 3],
            heading: [0.0, 1.0, 0.0],
            left: [-1.0, 0.0, 0.0],
            up: [0.0, 0.0, 1.0],
            width: 1.0,
        }
    }

    /// Does what the symbol says.
    fn obey(&mut self, symbol: &str, argument: f64) {
        match symbol {
            "F" | "f" => self.position = sum(self.position, self.heading, argument),
            "!" => self.width = argument,
            // Turn left, turn right, turn around.
            "+" | "|" => (self.heading, self.left) = turned(self.heading, self.left, argument),
            "-" => (self.heading, self.left) = turned(self.heading, self.left, -argument),
            // Pitch down, pitch up.
            "&" => (self.heading, self.up) = turned(self.heading, self.up, -argument),
            "^" => (self.heading, self.up) = turned(self.heading, self.up, argument),
            // Roll left, the left side goes down; roll right.
            "\\" => (self.up, self.left) = turned(self.up, self.left, argument),
            "/" => (self.up, self.left) = turned(self.up, self.left, -argument),
            _ => {}
        }
    }

    fn point(&self) -> Point {
        Point { position: self.position, width: self.width }
    }
}

/// `a` turned towards `b`, which turns away from `a`.
fn turned(a: [f64; 3], b: [f64; 3], degrees: f64) -> ([f64; 3], [f64; 3]) {
    let (sin, cos) = degrees.to_radians().sin_cos();
    (sum(a.map(|x| x * cos), b, sin), sum(b.map(|x| x * cos), a, -sin))
}

fn sum(a: [f64; 3], b: [f64; 3], factor: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + factor * b[k])
}

/// One module at the start and one after each `F`; all other symbols vanish.
pub fn trace(word: &Word, module: &dyn Fn(Point) -> Module) -> Vec<Token> {
    let mut turtle = Turtle::new();
    let mut stack = Vec::new();
    let mut tokens = vec![Token::Module(module(turtle.point()))];
    for token in &word.tokens {
        match token {
            Token::Open => {
                stack.push(turtle);
                tokens.push(Token::Open);
            }
            Token::Close => {
                turtle = stack.pop().expect("brackets in pairs");
                tokens.push(Token::Close);
            }
            // A word that was traced before: each of its curves begins with a point.
            Token::Break => tokens.extend([Token::Break, Token::Module(module(turtle.point()))]),
            Token::Module(symbol) => {
                let argument = symbol.params.first().and_then(|p| p.floats().first().copied());
                turtle.obey(&symbol.symbol, argument.unwrap_or(0.0));
                if symbol.symbol == "f" {
                    assert_ne!(word.topology, Topology::Ring, "`f` begins a new curve, and a ring is one");
                    tokens.push(Token::Break);
                }
                if matches!(symbol.symbol.as_str(), "F" | "f") {
                    tokens.push(Token::Module(module(turtle.point())));
                }
            }
        }
    }
    // Of a ring the last point coincides with the first.
    if word.topology == Topology::Ring && tokens.len() > 1 {
        tokens.pop();
    }
    tokens
}
