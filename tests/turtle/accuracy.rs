//! How far f32 takes the turtle from f64, over a million moves.

use burgeon::cpu::motion::{Motion, STILL};
use burgeon::cpu::turtle::turtle;
use burgeon::plan::layout::{CurveHeader, Layout};
use burgeon::plan::turtle::{Command, ROW_WORDS, Turtle, bound, reach};

/// The symbols of the records that are made here, by their place.
const SYMBOLS: &str = "F+-&^/\\|!X";

pub fn plan(before: bool, layout: &Layout) -> Turtle {
    let commands = SYMBOLS.chars().map(|c| Command::of(&c.to_string())).collect();
    Turtle { commands, argument: layout.header_words, before }
}

pub fn layout(links: bool) -> Layout {
    Layout::of_curve(1, CurveHeader { links, ..CurveHeader::default() })
}

/// A word of symbols with their arguments.
pub type Moves = Vec<(char, f32)>;

pub fn records(moves: &[(char, f32)], layout: &Layout) -> Vec<u32> {
    let record = |&(symbol, argument): &(char, f32)| {
        let mut record = vec![0; layout.record_words];
        record[0] = SYMBOLS.find(symbol).expect("a symbol") as u32;
        record[layout.header_words] = argument.to_bits();
        record
    };
    moves.iter().flat_map(record).collect()
}

/// The turtle in f64, its axes as vectors: to the right, heading, up.
#[derive(Clone, Copy)]
pub struct Exact {
    pub position: [f64; 3],
    axes: [[f64; 3]; 3],
    width: f64,
    /// The width of the last move.
    pub drawn: f64,
}

impl Exact {
    pub const START: Exact = Exact {
        position: [0.0; 3],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        width: 1.0,
        drawn: 1.0,
    };

    pub fn then(mut self, (symbol, argument): (char, f32)) -> Exact {
        let argument = f64::from(argument);
        let turn = |from: usize, to: usize, degrees: f64| (from, to, degrees.to_radians());
        let (from, to, angle) = match symbol {
            'F' => {
                self.position = [0, 1, 2].map(|k| self.position[k] + argument * self.axes[1][k]);
                return Exact { drawn: self.width, ..self };
            }
            '!' => return Exact { width: argument, ..self },
            // Left is against the right axis.
            '+' | '|' => turn(0, 1, argument),
            '-' => turn(0, 1, -argument),
            '^' => turn(1, 2, argument),
            '&' => turn(1, 2, -argument),
            '/' => turn(2, 0, argument),
            '\\' => turn(2, 0, -argument),
            _ => return self,
        };
        // From the first axis towards the second.
        let (sin, cos) = angle.sin_cos();
        let (a, b) = (self.axes[from], self.axes[to]);
        self.axes[from] = [0, 1, 2].map(|k| cos * a[k] + sin * b[k]);
        self.axes[to] = [0, 1, 2].map(|k| cos * b[k] - sin * a[k]);
        self
    }
}

/// Symbols rewritten so many times, with one argument for turns.
fn grown(axiom: &str, rules: &[(char, &str)], steps: usize, angle: f32) -> Moves {
    let mut word = axiom.to_string();
    for _ in 0..steps {
        let of = |c: char| rules.iter().find(|r| r.0 == c).map_or(c.to_string(), |r| r.1.to_string());
        word = word.chars().map(of).collect();
    }
    let argument = |c: char| if c == 'F' { 1.0 } else { angle };
    word.chars().filter(|c| SYMBOLS.contains(*c)).map(|c| (c, argument(c))).collect()
}

/// Small numbers without a pattern.
pub fn random(mut state: u32) -> impl FnMut() -> u32 {
    move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state
    }
}

fn random_path(moves: usize) -> Moves {
    let mut next = random(0x2545_f491);
    let mut path = Moves::new();
    for _ in 0..moves {
        let turn = ['+', '-', '&', '^', '/', '\\'][next() as usize % 6];
        path.push((turn, (next() % 36_000) as f32 / 100.0));
        path.push(('F', (next() % 1000) as f32 / 500.0));
    }
    path
}

/// The greatest distance of a coordinate from the exact one, and the greatest coordinate.
fn apart(moves: &[(char, f32)]) -> (f64, f64) {
    let layout = layout(false);
    let mut rows = vec![0; moves.len() * ROW_WORDS];
    let plan = plan(false, &layout);
    turtle(&plan, &layout, &records(moves, &layout), STILL, &mut rows);
    let mut state = Exact::START;
    let (mut far, mut size) = (0f64, 0f64);
    for (row, &module) in rows.chunks_exact(ROW_WORDS).zip(moves) {
        state = state.then(module);
        for (&word, exact) in row.iter().zip(state.position) {
            far = far.max((f64::from(f32::from_bits(word)) - exact).abs());
            size = size.max(exact.abs());
        }
    }
    assert!(f64::from(reach(&rows)) <= 1.01 * size + far);
    (far, size)
}

/// What the page of the turtle says: right angles are exact, and what does not repeat one turn for ever is off by at most 4·ε·√n of the size of the word.
#[test]
fn a_million_moves_stay_within_the_bound() {
    let koch = grown("F", &[('F', "F+F--F+F")], 10, 60.0);
    let dragon = grown("FX", &[('X', "X+YF+"), ('Y', "-FX-Y")], 20, 90.0);
    // Arguments of a dragon whose folds are not right are of no closed form.
    let tilted: Moves =
        dragon.iter().map(|&(c, x)| if x == 90.0 { (c, 89.7) } else { (c, x * 0.7) }).collect();
    for (name, moves, exact) in [
        ("Koch's curve", &koch, false),
        ("the dragon", &dragon, true),
        ("a tilted dragon", &tilted, false),
        ("a random path", &random_path(1 << 20), false),
    ] {
        let n = moves.iter().filter(|m| m.0 == 'F').count();
        assert!(n >= 1_000_000, "{name} has {n} moves");
        let (far, size) = apart(moves);
        let unit = 4.0 * f64::from(f32::EPSILON) * (moves.len() as f64).sqrt() * size;
        println!("{name}: {n} moves, {far:e} of {size}, {:.3} of the bound", far / unit);
        assert!(far <= unit, "{name}: {far:e} of {size}, {unit:e} allowed");
        // f64 has no right angles.
        assert!(!exact || far < 1e-9, "{name}: {far:e}");
        assert!(far <= f64::from(bound(moves.len(), size as f32)), "{name}");
    }
}

/// One turn over and over: the worst that there is.
#[test]
fn a_long_spiral_stays_within_the_hard_bound() {
    for angle in [1.0f32, 0.1, 137.5, 33.3] {
        let moves: Moves = (0..100_000).flat_map(|_| [('F', 1.0), ('+', angle)]).collect();
        let (far, size) = apart(&moves);
        println!(
            "{angle}°: {far:e} of {size}, {:.4} of the bound",
            far / f64::from(bound(moves.len(), size as f32))
        );
        assert!(far <= f64::from(bound(moves.len(), size as f32)), "{angle}°: {far:e} of {size}");
    }
}

/// Motions compose as they are done one after the other, in whatever groups.
#[test]
fn composition_is_associative_within_rounding() {
    let moves = random_path(200);
    let layout = layout(false);
    let (plan, records) = (plan(false, &layout), records(&moves, &layout));
    let all = |records: &[u32]| {
        records.chunks_exact(layout.record_words).fold(STILL, |m: Motion, r| m.then_module(&plan, r))
    };
    let whole = all(&records);
    for cut in [1, 7, 64, 399] {
        let (a, b) = records.split_at(cut * layout.record_words);
        let joined = all(a).then(&all(b));
        let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(near(&joined.shift, &whole.shift), "{joined:?} and {whole:?}");
    }
}
