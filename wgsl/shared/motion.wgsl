// Rigid motions: how the turtle's place and axes change, and the width that it draws with.
//
// Turns are quaternions of any length, since only where they point matters; those of right angles are whole numbers. Products
// are brought back to a square of 1 to 4 by a power of two, which rounds nothing. So a word of right angles and whole
// lengths is traced without rounding, and comes out the same to the bit everywhere.

import elementary;
import commands;

struct Motion {
  turn: vec4f,
  shift: vec3f,
  // The bits of the width, or UNSET.
  width: u32,
  // The same of its last move: INHERITED where it was made before a width was set, UNSET where there is none.
  drawn: u32,
}

const UNSET = 0xffffffffu;
const INHERITED = 0xfffffffeu;

fn still() -> Motion {
  return Motion(vec4f(0.0, 0.0, 0.0, 1.0), vec3f(0.0), UNSET, UNSET);
}

fn square(q: vec4f) -> f32 {
  return q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
}

fn product(q: vec4f, p: vec4f) -> vec4f {
  let r = vec4f(
    q.w * p.x + q.x * p.w + q.y * p.z - q.z * p.y,
    q.w * p.y - q.x * p.z + q.y * p.w + q.z * p.x,
    q.w * p.z + q.x * p.y - q.y * p.x + q.z * p.w,
    q.w * p.w - q.x * p.x - q.y * p.y - q.z * p.z,
  );
  let length = square(r);
  if length >= 4.0 {
    return r * 0.5;
  }
  if length < 1.0 {
    return r * 2.0;
  }
  return r;
}

fn crossed(a: vec3f, b: vec3f) -> vec3f {
  return vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

// v + 2/|q|² · u × (u × v + w v)
fn turned(q: vec4f, v: vec3f) -> vec3f {
  let b = crossed(q.xyz, crossed(q.xyz, v) + v * q.w);
  return v + b * (2.0 / square(q));
}

// Where +y comes to lie.
fn heading(q: vec4f) -> vec3f {
  let scale = 2.0 / square(q);
  return vec3f(
    (q.x * q.y - q.w * q.z) * scale,
    1.0 - (q.x * q.x + q.z * q.z) * scale,
    (q.w * q.x + q.y * q.z) * scale,
  );
}

// The first, then the next in the axes as they then are.
fn composed(first: Motion, next: Motion) -> Motion {
  var drawn = next.drawn;
  if drawn == UNSET {
    drawn = first.drawn;
  } else if drawn == INHERITED && first.width != UNSET {
    drawn = first.width;
  }
  return Motion(
    product(first.turn, next.turn),
    first.shift + turned(first.turn, next.shift),
    select(next.width, first.width, next.width == UNSET),
    drawn,
  );
}

// Cosine and sine of half an angle in degrees, or numbers in their proportion: whole ones for right angles.
fn half_turn(degrees: f32) -> vec2f {
  let rest = degrees - 360.0 * round(degrees / 360.0);
  if abs(rest) == 90.0 {
    return vec2f(1.0, select(1.0, -1.0, rest < 0.0));
  }
  if abs(rest) == 180.0 {
    return vec2f(0.0, 1.0);
  }
  let half = rest * 0.008726646;
  return vec2f(portable_cos(half), portable_sin(half));
}

// A motion, then that of a module: what its symbol commands (plan/turtle.rs).
fn then_module(motion: Motion, m: Record) -> Motion {
  let command = command_of(symbol_of(m));
  let argument = argument_of(m);
  var next = motion;
  if command == 1u {
    next.shift += heading(motion.turn) * bitcast<f32>(argument);
    next.drawn = select(motion.width, INHERITED, motion.width == UNSET);
  } else if command == 2u {
    next.width = argument;
  } else if command >= 4u {
    let degrees = bitcast<f32>(argument);
    let half = half_turn(select(degrees, -degrees, (command & 1u) == 1u));
    let axis = (command - 4u) >> 1u;
    let turn = vec4f(
      select(0.0, half.y, axis == 0u),
      select(0.0, half.y, axis == 1u),
      select(0.0, half.y, axis == 2u),
      half.x,
    );
    next.turn = product(motion.turn, turn);
  }
  return next;
}

// The row of a module at which the turtle stands so; a width that is not set is 1.
fn write_row(i: u32, motion: Motion) {
  let row = extent.given + i * MEASURED;
  attributes[row] = bitcast<u32>(motion.shift.x);
  attributes[row + 1u] = bitcast<u32>(motion.shift.y);
  attributes[row + 2u] = bitcast<u32>(motion.shift.z);
  attributes[row + 3u] = select(motion.drawn, 0x3f800000u, motion.drawn >= INHERITED);
}
