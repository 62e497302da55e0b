//! Rigid motions, operation by operation as in `wgsl/shared/motion.wgsl`.

use crate::language::elementary::{cos, sin};
use crate::plan::turtle::{Command, INHERITED, ROW_WORDS, Turtle, UNSET};

/// How the turtle's place and axes change, and the width that it draws with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// A quaternion x, y, z, w of any length but 0: only where it points matters.
    pub turn: [f32; 4],
    pub shift: [f32; 3],
    /// The bits of the width, or [`UNSET`].
    pub width: u32,
    /// The same of its last move; [`INHERITED`] where it was made before a width was set, [`UNSET`] where there is none.
    pub drawn: u32,
}

/// Changes nothing.
pub const STILL: Motion = Motion { turn: [0.0, 0.0, 0.0, 1.0], shift: [0.0; 3], width: UNSET, drawn: UNSET };

impl Default for Motion {
    fn default() -> Motion {
        STILL
    }
}

impl Motion {
    /// This one, then that of a module, in the axes as they then are.
    pub fn then_module(&self, turtle: &Turtle, record: &[u32]) -> Motion {
        let argument = || f32::from_bits(record[turtle.argument]);
        match turtle.commands[(record[0] & 0xffff) as usize] {
            None => *self,
            Some(Command::Width) => Motion { width: record[turtle.argument], ..*self },
            Some(Command::Move) => {
                let (heading, length) = (heading(self.turn), argument());
                let shift = std::array::from_fn(|k| self.shift[k] + heading[k] * length);
                let drawn = if self.width == UNSET { INHERITED } else { self.width };
                Motion { shift, drawn, ..*self }
            }
            Some(Command::Turn { axis, backwards }) => {
                let half = half_turn(if backwards { -argument() } else { argument() });
                let mut turn = [0.0, 0.0, 0.0, half[0]];
                turn[axis] = half[1];
                Motion { turn: product(self.turn, turn), ..*self }
            }
        }
    }

    /// This one, then another in the axes as they then are.
    pub fn then(&self, next: &Motion) -> Motion {
        let moved = turned(self.turn, next.shift);
        Motion {
            turn: product(self.turn, next.turn),
            shift: std::array::from_fn(|k| self.shift[k] + moved[k]),
            width: if next.width == UNSET { self.width } else { next.width },
            drawn: match next.drawn {
                UNSET => self.drawn,
                INHERITED if self.width == UNSET => INHERITED,
                INHERITED => self.width,
                drawn => drawn,
            },
        }
    }

    /// The row of a module at which the turtle stands so.
    pub fn write(&self, row: &mut [u32]) {
        let width = if self.drawn >= INHERITED { 1f32.to_bits() } else { self.drawn };
        let [x, y, z] = self.shift.map(f32::to_bits);
        row[..ROW_WORDS].copy_from_slice(&[x, y, z, width]);
    }
}

/// Cosine and sine of half an angle in degrees, or numbers in their proportion: whole ones for right angles.
fn half_turn(degrees: f32) -> [f32; 2] {
    let rest = degrees - 360.0 * (degrees / 360.0).round_ties_even();
    if rest.abs() == 90.0 {
        return [1.0, if rest < 0.0 { -1.0 } else { 1.0 }];
    }
    if rest.abs() == 180.0 {
        return [0.0, 1.0];
    }
    let half = rest * 0.008_726_646;
    [cos(half), sin(half)]
}

fn square(q: [f32; 4]) -> f32 {
    q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
}

/// The product, its square brought back to 1 … 4 by a power of two, which rounds nothing.
fn product(q: [f32; 4], p: [f32; 4]) -> [f32; 4] {
    let r = [
        q[3] * p[0] + q[0] * p[3] + q[1] * p[2] - q[2] * p[1],
        q[3] * p[1] - q[0] * p[2] + q[1] * p[3] + q[2] * p[0],
        q[3] * p[2] + q[0] * p[1] - q[1] * p[0] + q[2] * p[3],
        q[3] * p[3] - q[0] * p[0] - q[1] * p[1] - q[2] * p[2],
    ];
    let length = square(r);
    if length >= 4.0 {
        r.map(|x| x * 0.5)
    } else if length < 1.0 {
        r.map(|x| x * 2.0)
    } else {
        r
    }
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// v + 2/|q|² · u × (u × v + w v)
fn turned(q: [f32; 4], v: [f32; 3]) -> [f32; 3] {
    let u = [q[0], q[1], q[2]];
    let a = cross(u, v);
    let b = cross(u, std::array::from_fn(|k| a[k] + v[k] * q[3]));
    let scale = 2.0 / square(q);
    std::array::from_fn(|k| v[k] + b[k] * scale)
}

/// Where +y comes to lie.
fn heading(q: [f32; 4]) -> [f32; 3] {
    let scale = 2.0 / square(q);
    [
        (q[0] * q[1] - q[3] * q[2]) * scale,
        1.0 - (q[0] * q[0] + q[2] * q[2]) * scale,
        (q[3] * q[0] + q[1] * q[2]) * scale,
    ]
}
