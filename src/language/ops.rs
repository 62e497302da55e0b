//! The table of pure operations.
//!
//! One row an operation feeds the type checker, the host's evaluator, the CPU's register program,
//! the WGSL generator and the reference page. A new pure operation is one row.
//!
//! Rows over `bool`, `int` and `float` whose result both backends can give bit by bit carry a CPU
//! function and a WGSL text. The others (vectors, transcendental functions) have their signature
//! and meaning only: the checker types them and the host evaluates them in constants
//! ([`super::eval`]), but no backend runs them yet.

use super::elementary;
use super::expr::Type;
use super::numbers::{self, plain};
use std::collections::HashMap;
use std::fmt;
use std::sync::OnceLock;

/// Index of a row of [`TABLE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Op(pub u16);

impl Op {
    /// Its row of the table.
    pub fn row(self) -> &'static Row {
        &TABLE[self.0 as usize]
    }
}

/// One overload of an operator or function.
#[derive(Clone, Debug)]
pub struct Row {
    /// The operator as written, or the function's name.
    pub name: &'static str,
    /// The arguments' names, for the reference page.
    pub parameters: &'static [&'static str],
    pub args: &'static [Type],
    pub result: Type,
    /// Over columns of 4-byte words. Absent: no backend runs the row yet.
    pub cpu: Option<Cpu>,
    /// WGSL text with `{0}`, `{1}`, `{2}` for the arguments; it may stand anywhere in an
    /// expression and may call functions of `wgsl/shared/ops.wgsl`. Empty where [`Row::cpu`] is absent.
    pub wgsl: &'static str,
    pub doc: &'static str,
}

/// As in the reference: `clamp(x: int, low: int, high: int) -> int`.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.is_operator() {
            return match self.args {
                [only] => write!(f, "{}{only} -> {}", self.name, self.result),
                args => write!(f, "{} {} {} -> {}", args[0], self.name, args[1], self.result),
            };
        }
        write!(f, "{}(", self.name)?;
        for (i, (name, ty)) in self.parameters.iter().zip(self.args).enumerate() {
            write!(f, "{}{name}: {ty}", if i == 0 { "" } else { ", " })?;
        }
        write!(f, ") -> {}", self.result)
    }
}

impl Row {
    /// The name, of rows that no text can name, too: `+` of `+ #`.
    pub fn symbol(&self) -> &'static str {
        self.name.strip_suffix(" #").unwrap_or(self.name)
    }

    /// Written between or before its arguments rather than with parentheses.
    pub fn is_operator(&self) -> bool {
        !self.name.starts_with(|c: char| c.is_ascii_alphabetic())
    }
}

/// A function over blocks: each argument and the result is a column of 4-byte words (bool as 0 or
/// 1, int as two's complement, float as its bits). All columns are as long as the result's.
#[derive(Clone, Copy, Debug)]
pub enum Cpu {
    One(fn(Column, &mut [u32])),
    Two(fn(Column, Column, &mut [u32])),
    Three(fn(Column, Column, Column, &mut [u32])),
}

/// One argument of each of a block of modules.
pub type Column<'a> = &'a [u32];

impl Cpu {
    /// One word: the function on columns of length 1. `args` holds as many words as it takes.
    pub fn word(self, args: &[u32]) -> Option<u32> {
        let mut out = [0];
        match (self, args) {
            (Cpu::One(f), [a]) => f(&[*a], &mut out),
            (Cpu::Two(f), [a, b]) => f(&[*a], &[*b], &mut out),
            (Cpu::Three(f), [a, b, c]) => f(&[*a], &[*b], &[*c], &mut out),
            _ => return None,
        }
        Some(out[0])
    }
}

/// How a scalar of the language lies in a 4-byte word.
trait Word {
    fn read(word: u32) -> Self;
    fn write(self) -> u32;
}
impl Word for bool {
    fn read(word: u32) -> bool {
        word != 0
    }
    fn write(self) -> u32 {
        self as u32
    }
}
impl Word for i32 {
    fn read(word: u32) -> i32 {
        word as i32
    }
    fn write(self) -> u32 {
        self as u32
    }
}
impl Word for f32 {
    fn read(word: u32) -> f32 {
        f32::from_bits(word)
    }
    fn write(self) -> u32 {
        self.to_bits()
    }
}

/// The Rust type of a scalar type of the language.
macro_rules! rust {
    (Bool) => {
        bool
    };
    (Int) => {
        i32
    };
    (Float) => {
        f32
    };
}

/// A block function from a scalar expression; one plain loop, so that it vectorises.
macro_rules! block {
    (($a:ident: $ta:ident) -> $r:ident, $body:expr) => {{
        fn run(a: &[u32], out: &mut [u32]) {
            for (out, a) in out.iter_mut().zip(a) {
                let $a = <rust!($ta)>::read(*a);
                let result: rust!($r) = $body;
                *out = result.write();
            }
        }
        Cpu::One(run)
    }};
    (($a:ident: $ta:ident, $b:ident: $tb:ident) -> $r:ident, $body:expr) => {{
        fn run(a: &[u32], b: &[u32], out: &mut [u32]) {
            for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
                let ($a, $b) = (<rust!($ta)>::read(*a), <rust!($tb)>::read(*b));
                let result: rust!($r) = $body;
                *out = result.write();
            }
        }
        Cpu::Two(run)
    }};
    (($a:ident: $ta:ident, $b:ident: $tb:ident, $c:ident: $tc:ident) -> $r:ident, $body:expr) => {{
        fn run(a: &[u32], b: &[u32], c: &[u32], out: &mut [u32]) {
            for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                let ($a, $b, $c) = (<rust!($ta)>::read(*a), <rust!($tb)>::read(*b), <rust!($tc)>::read(*c));
                let result: rust!($r) = $body;
                *out = result.write();
            }
        }
        Cpu::Three(run)
    }};
}

/// `V` stands for each vector type in turn.
macro_rules! vector_type {
    (V, $v:ident) => {
        Type::$v
    };
    ($t:ident, $v:ident) => {
        Type::$t
    };
}

macro_rules! table {
    (
        run { $( $name:literal ($($a:ident: $t:ident),*) -> $r:ident, $wgsl:literal, $body:expr, $doc:literal; )* }
        scalar { $( $sname:literal ($($sa:ident: $st:ident),*) -> $sr:ident, $sdoc:literal; )* }
        vector { $( $vname:literal ($($va:ident: $vt:ident),*) -> $vr:ident, $vdoc:literal; )* }
    ) => {
        &[
            $( Row {
                name: $name, parameters: &[$(stringify!($a)),*], args: &[$(Type::$t),*], result: Type::$r,
                cpu: Some(block!(($($a: $t),*) -> $r, $body)), wgsl: $wgsl, doc: $doc,
            }, )*
            $( Row {
                name: $sname, parameters: &[$(stringify!($sa)),*], args: &[$(Type::$st),*], result: Type::$sr,
                cpu: None, wgsl: "", doc: $sdoc,
            }, )*
            $( table!(@vector Vec2, $vname, ($($va: $vt),*), $vr, $vdoc), )*
            $( table!(@vector Vec3, $vname, ($($va: $vt),*), $vr, $vdoc), )*
            $( table!(@vector Vec4, $vname, ($($va: $vt),*), $vr, $vdoc), )*
        ]
    };
    (@vector $v:ident, $name:literal, ($($a:ident: $t:ident),*), $r:ident, $doc:literal) => {
        Row {
            name: $name, parameters: &[$(stringify!($a)),*], args: &[$(vector_type!($t, $v)),*],
            result: vector_type!($r, $v), cpu: None, wgsl: "", doc: $doc,
        }
    };
}

/// `x / y` as WGSL defines it: towards zero, `x / 0 = x`, `i32::MIN / -1 = i32::MIN`.
fn int_div(x: i32, y: i32) -> i32 {
    if y == 0 { x } else { x.wrapping_div(y) }
}

/// `x % y` as WGSL defines it: the sign of x, `x % 0 = 0`, `i32::MIN % -1 = 0`.
fn int_rem(x: i32, y: i32) -> i32 {
    if y == 0 { 0 } else { x.wrapping_rem(y) }
}

/// All operations. Rows of one name differ in arity or types; of rows with promotions
/// (int → float) the one with the fewest is taken, the earlier at a tie.
pub static TABLE: &[Row] = table! {
    run {
        "||" (a: Bool, b: Bool) -> Bool, "({0} || {1})", a | b, "Either holds.";
        "&&" (a: Bool, b: Bool) -> Bool, "({0} && {1})", a & b, "Both hold.";
        "!" (a: Bool) -> Bool, "(!{0})", !a, "It does not hold.";
        "==" (a: Bool, b: Bool) -> Bool, "({0} == {1})", a == b, "Equal.";
        "==" (a: Int, b: Int) -> Bool, "({0} == {1})", a == b, "Equal.";
        "==" (a: Float, b: Float) -> Bool, "is_equal({0}, {1})", a == b, "Equal, exactly.";
        "!=" (a: Bool, b: Bool) -> Bool, "({0} != {1})", a != b, "Not equal.";
        "!=" (a: Int, b: Int) -> Bool, "({0} != {1})", a != b, "Not equal.";
        "!=" (a: Float, b: Float) -> Bool, "(!is_equal({0}, {1}))", a != b, "Not equal.";
        "<" (a: Int, b: Int) -> Bool, "({0} < {1})", a < b, "Less.";
        "<" (a: Float, b: Float) -> Bool, "is_less({0}, {1})", a < b, "Less.";
        "<=" (a: Int, b: Int) -> Bool, "({0} <= {1})", a <= b, "Less or equal.";
        "<=" (a: Float, b: Float) -> Bool, "is_at_most({0}, {1})", a <= b, "Less or equal.";
        ">" (a: Int, b: Int) -> Bool, "({0} > {1})", a > b, "Greater.";
        ">" (a: Float, b: Float) -> Bool, "is_less({1}, {0})", a > b, "Greater.";
        ">=" (a: Int, b: Int) -> Bool, "({0} >= {1})", a >= b, "Greater or equal.";
        ">=" (a: Float, b: Float) -> Bool, "is_at_most({1}, {0})", a >= b, "Greater or equal.";
        "+" (a: Int, b: Int) -> Int, "({0} + {1})", a.wrapping_add(b), "Sum; wraps.";
        "+" (a: Float, b: Float) -> Float, "sum_of({0}, {1})", plain(a + b), "Sum.";
        "-" (a: Int, b: Int) -> Int, "({0} - {1})", a.wrapping_sub(b), "Difference; wraps.";
        "-" (a: Float, b: Float) -> Float, "difference_of({0}, {1})", plain(a - b), "Difference.";
        "-" (a: Int) -> Int, "(-({0}))", a.wrapping_neg(), "Negation; wraps.";
        "-" (a: Float) -> Float, "negative_of({0})", plain(-a), "Negation.";
        "*" (a: Int, b: Int) -> Int, "({0} * {1})", a.wrapping_mul(b), "Product; wraps.";
        "*" (a: Float, b: Float) -> Float, "scalar_product({0}, {1})", plain(a * b), "Product.";
        "/" (a: Int, b: Int) -> Int, "int_div({0}, {1})", int_div(a, b), "Quotient towards zero; x / 0 = x.";
        "/" (a: Float, b: Float) -> Float, "quotient_of({0}, {1})", plain(a / b), "Quotient; x / 0 is infinite, 0 / 0 is NaN.";
        "%" (a: Int, b: Int) -> Int, "int_rem({0}, {1})", int_rem(a, b), "Remainder, with the sign of the first; x % 0 = 0.";
        "int" (x: Int) -> Int, "({0})", x, "Itself.";
        "int" (x: Float) -> Int, "to_int({0})", numbers::to_int(x), "Towards zero; at least -2147483648, at most 2147483520, the greatest that float and int hold; 0 of NaN.";
        "int" (x: Bool) -> Int, "i32({0})", x as i32, "1 or 0.";
        "float" (x: Float) -> Float, "({0})", x, "Itself.";
        "float" (x: Int) -> Float, "f32({0})", x as f32, "The nearest float.";
        "float" (x: Bool) -> Float, "f32({0})", if x { 1.0 } else { 0.0 }, "1.0 or 0.0.";
        "if" (condition: Bool, then: Bool, otherwise: Bool) -> Bool, "select({2}, {1}, {0})", if condition { then } else { otherwise }, "One of two values; both are evaluated.";
        "if" (condition: Bool, then: Int, otherwise: Int) -> Int, "select({2}, {1}, {0})", if condition { then } else { otherwise }, "One of two values; both are evaluated.";
        "if" (condition: Bool, then: Float, otherwise: Float) -> Float, "select({2}, {1}, {0})", if condition { then } else { otherwise }, "One of two values; both are evaluated.";
        "abs" (x: Int) -> Int, "abs({0})", x.wrapping_abs(), "Absolute value; wraps.";
        "abs" (x: Float) -> Float, "of_bits(magnitude({0}))", x.abs(), "Absolute value.";
        "sign" (x: Int) -> Int, "sign({0})", x.signum(), "-1, 0 or 1.";
        "sign" (x: Float) -> Float, "sign_of({0})", if x > 0.0 { 1.0 } else if x < 0.0 { -1.0 } else { 0.0 }, "-1, 0 or 1; 0 of NaN.";
        "min" (a: Int, b: Int) -> Int, "min({0}, {1})", a.min(b), "The lesser.";
        "min" (a: Float, b: Float) -> Float, "least_of({0}, {1})", numbers::least(a, b), "The lesser; the first where one is NaN.";
        "max" (a: Int, b: Int) -> Int, "max({0}, {1})", a.max(b), "The greater.";
        "max" (a: Float, b: Float) -> Float, "greatest_of({0}, {1})", numbers::greatest(a, b), "The greater; the first where one is NaN.";
        "clamp" (x: Int, low: Int, high: Int) -> Int, "min(max({0}, {1}), {2})", x.max(low).min(high), "x, but at least low and at most high.";
        "clamp" (x: Float, low: Float, high: Float) -> Float, "clamped({0}, {1}, {2})", numbers::clamped(x, low, high), "x, but at least low and at most high.";
        "floor" (x: Float) -> Float, "whole_below({0})", x.floor(), "The greatest whole number not above.";
        "ceil" (x: Float) -> Float, "whole_above({0})", x.ceil(), "The least whole number not below.";
        "round" (x: Float) -> Float, "nearest_whole({0})", x.round_ties_even(), "The nearest whole number; halves go to the even one.";
        "trunc" (x: Float) -> Float, "whole_part({0})", x.trunc(), "Towards zero.";
        "sqrt" (x: Float) -> Float, "square_root({0})", plain(x.sqrt()), "Square root; NaN of what is below 0.";
        "pow" (x: Float, y: Float) -> Float, "portable_pow({0}, {1})", elementary::pow(x, y), "x to the power y, for x >= 0; of less 0. As exp, it lies within e^-87 and e^88.";
        "exp" (x: Float) -> Float, "portable_exp({0})", elementary::exp(x), "e to the power x, which is clamped to -87 to 88.";
        "exp2" (x: Float) -> Float, "portable_exp2({0})", elementary::exp2(x), "2 to the power x, which is clamped to -126 to 127.";
        "log" (x: Float) -> Float, "portable_log({0})", elementary::log(x), "Natural logarithm; the least float for x <= 0.";
        "log2" (x: Float) -> Float, "portable_log2({0})", elementary::log2(x), "Logarithm to base 2; the least float for x <= 0.";
        "sin" (x: Float) -> Float, "portable_sin({0})", elementary::sin(x), "Sine of an angle in radians, up to 8192 either way; beyond, it loses its digits.";
        "cos" (x: Float) -> Float, "portable_cos({0})", elementary::cos(x), "Cosine of an angle in radians, up to 8192 either way; beyond, it loses its digits.";
        "tan" (x: Float) -> Float, "portable_tan({0})", elementary::tan(x), "Tangent of an angle in radians, up to 8192 either way; beyond, it loses its digits.";
        "asin" (x: Float) -> Float, "portable_asin({0})", elementary::asin(x), "Arc sine, in radians.";
        "acos" (x: Float) -> Float, "portable_acos({0})", elementary::acos(x), "Arc cosine, in radians.";
        "atan" (x: Float) -> Float, "portable_atan({0})", elementary::atan(x), "Arc tangent, in radians.";
        "atan2" (y: Float, x: Float) -> Float, "portable_atan2({0}, {1})", elementary::atan2(y, x), "Angle of the point (x, y), in radians.";
        "radians" (x: Float) -> Float, "scalar_product({0}, 0.017453292)", plain(x * 0.017453292), "Degrees to radians.";
        "degrees" (x: Float) -> Float, "scalar_product({0}, 57.29578)", plain(x * 57.29578), "Radians to degrees.";
        "step" (edge: Float, x: Float) -> Float, "select(1.0, 0.0, is_less({1}, {0}))", if x < edge { 0.0 } else { 1.0 }, "0 below the edge, 1 from it on.";
        "+ #" (a: Float, b: Float) -> Float, "({0} + {1})", a + b, "Sum of components.";
        "- #" (a: Float, b: Float) -> Float, "({0} - {1})", a - b, "Difference of components.";
        "- #" (a: Float) -> Float, "(-({0}))", -a, "Negation of a component.";
        "* #" (a: Float, b: Float) -> Float, "({0} * {1})", a * b, "Product of components.";
        "/ #" (a: Float, b: Float) -> Float, "({0} / {1})", a / b, "Quotient of a component by a number that is not 0.";
        "noise #" (x: Float, y: Float, z: Float) -> Float, "gradient_noise({0}, {1}, {2})", elementary::noise(x, y, z), "Gradient noise by components; written `noise(p)`.";
        "hash #" (state: Int, word: Int) -> Int, "bitcast<i32>(hash_word(bitcast<u32>({0}), bitcast<u32>({1})))", elementary::hash(state as u32, word as u32) as i32, "Mixes a word into a hash; behind `rand`.";
        "scale #" (hash: Int, total: Int) -> Int, "bitcast<i32>(scale_word(bitcast<u32>({0}), bitcast<u32>({1})))", elementary::scale(hash as u32, total as u32) as i32, "A hash spread over 0 to total - 1; behind the draw among alternatives.";
        "unit #" (hash: Int) -> Float, "unit_of_hash(bitcast<u32>({0}))", elementary::unit(hash as u32), "The upper 24 bits of a hash as a number in [0, 1).";
        "slices #" (hash: Int) -> Int, "bitcast<i32>(slices_of_hash(bitcast<u32>({0})))", ((hash as u32 >> 16) + (hash as u32 & 0xffff)) as i32, "The sum of the two halves of a hash; behind `randn`.";
    }
    scalar {
        "%" (a: Float, b: Float) -> Float, "Remainder a - b * trunc(a / b), with the sign of the first.";
        "fract" (x: Float) -> Float, "x - floor(x).";
        "mix" (a: Float, b: Float, t: Float) -> Float, "(a - a * t) + b * t.";
        "smoothstep" (low: Float, high: Float, x: Float) -> Float, "From 0 at low to 1 at high, smooth at both ends.";
        "cross" (a: Vec2, b: Vec2) -> Float, "a.x * b.y - a.y * b.x.";
        "cross" (a: Vec3, b: Vec3) -> Vec3, "Vector product.";
        "rotate" (v: Vec2, angle: Float) -> Vec2, "v turned counter-clockwise by an angle in degrees.";
        "rotate" (v: Vec3, axis: Vec3, angle: Float) -> Vec3, "v turned about an axis by an angle in degrees, counter-clockwise seen from its tip.";
        "noise" (p: Vec3) -> Float, "3D gradient noise, -1 to 1, 0 at whole points.";
        "frame *" (frame: Vec4, v: Vec3) -> Vec3, "A vector given in a local frame, in the axes of the model. Written `frame * v`.";
    }
    vector {
        "+" (a: V, b: V) -> V, "Sum.";
        "+" (a: V, b: Float) -> V, "Sum, the number added to each component.";
        "+" (a: Float, b: V) -> V, "Sum, the number added to each component.";
        "-" (a: V, b: V) -> V, "Difference.";
        "-" (a: V, b: Float) -> V, "Difference, the number taken from each component.";
        "-" (a: Float, b: V) -> V, "Difference, each component taken from the number.";
        "-" (a: V) -> V, "Negation.";
        "*" (a: V, b: V) -> V, "Product by components.";
        "*" (a: V, b: Float) -> V, "Multiple.";
        "*" (a: Float, b: V) -> V, "Multiple.";
        "/" (a: V, b: V) -> V, "Quotient by components.";
        "/" (a: V, b: Float) -> V, "Each component over the number.";
        "/" (a: Float, b: V) -> V, "The number over each component.";
        "if" (condition: Bool, then: V, otherwise: V) -> V, "One of two values; both are evaluated.";
        "abs" (v: V) -> V, "Absolute value, by components.";
        "sign" (v: V) -> V, "-1, 0 or 1, by components.";
        "floor" (v: V) -> V, "The greatest whole number not above, by components.";
        "ceil" (v: V) -> V, "The least whole number not below, by components.";
        "round" (v: V) -> V, "The nearest whole number, by components.";
        "fract" (v: V) -> V, "v - floor(v).";
        "min" (a: V, b: V) -> V, "The lesser, by components.";
        "max" (a: V, b: V) -> V, "The greater, by components.";
        "clamp" (v: V, low: V, high: V) -> V, "v, but at least low and at most high, by components.";
        "mix" (a: V, b: V, t: Float) -> V, "(a - a * t) + b * t.";
        "length" (v: V) -> Float, "Euclidean length.";
        "distance" (a: V, b: V) -> Float, "Euclidean distance.";
        "dot" (a: V, b: V) -> Float, "Scalar product.";
        "normalize" (v: V) -> V, "v / length(v).";
    }
};

/// Why [`find`] found no row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// No row has the name.
    Name,
    /// None of that name takes so many arguments.
    Arity,
    /// None of that name and arity takes such types.
    Types,
}

/// The rows of one name, in the order of the table.
pub fn overloads(name: &str) -> &'static [Op] {
    static INDEX: OnceLock<HashMap<&'static str, Vec<Op>>> = OnceLock::new();
    let index = INDEX.get_or_init(|| {
        let mut index: HashMap<_, Vec<Op>> = HashMap::new();
        for (i, row) in TABLE.iter().enumerate() {
            index.entry(row.name).or_default().push(Op(i as u16));
        }
        index
    });
    index.get(name).map_or(&[], Vec::as_slice)
}

/// The row that takes arguments of these types, an int where a float is needed being promoted.
/// The arguments are to be promoted to [`Row::args`].
pub fn find(name: &str, args: &[Type]) -> Result<Op, Mismatch> {
    let rows = overloads(name);
    let mut best: Option<(usize, Op)> = None;
    let mut arity = false;
    for &op in rows {
        let row = op.row();
        if row.args.len() != args.len() {
            continue;
        }
        arity = true;
        if let Some(promotions) = promotions(row.args, args)
            && best.is_none_or(|(fewest, _)| promotions < fewest)
        {
            best = Some((promotions, op));
        }
    }
    match best {
        Some((_, op)) => Ok(op),
        None if rows.is_empty() => Err(Mismatch::Name),
        None if !arity => Err(Mismatch::Arity),
        None => Err(Mismatch::Types),
    }
}

/// How many of `given` become floats to fit `wanted`; `None` if they cannot fit.
fn promotions(wanted: &[Type], given: &[Type]) -> Option<usize> {
    let mut count = 0;
    for (wanted, given) in wanted.iter().zip(given) {
        match (wanted, given) {
            _ if wanted == given => {}
            (Type::Float, Type::Int) => count += 1,
            _ => return None,
        }
    }
    Some(count)
}
