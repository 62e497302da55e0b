//! Elementary functions against the truth in f64.

use super::operations::Expressions;
use super::{Compared, Trouble};
use crate::gpu::Engine;
use crate::language::elementary;
use crate::language::{Type, Value};
use crate::plan::step::Clock;

/// A function of one float, and how far from the truth it may be.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// As rules write it.
    pub name: &'static str,
    pub cpu: fn(f32) -> f32,
    pub exact: fn(f64) -> f64,
    pub low: f32,
    pub high: f32,
    /// Errors count in units in the last place of the result, or of this where it is greater.
    pub floor: f64,
    /// The bound on the CPU, in such units.
    pub ulps: f64,
    /// What comes to it on a device: fused or reordered sums, and what WGSL grants a quotient
    /// (2.5 ulp) and a square root.
    pub device: f64,
}

impl Function {
    /// The error of a value, in units in the last place.
    pub fn error(&self, x: f32, value: f32) -> f64 {
        let truth = (self.exact)(f64::from(x));
        let unit = truth.abs().max(self.floor) * f64::from(f32::EPSILON);
        (f64::from(value) - truth).abs() / unit
    }

    /// Number `n` of `count` arguments, from one end of the range to the other.
    pub fn argument(&self, n: usize, count: usize) -> f32 {
        self.low + (self.high - self.low) * (n as f32 / (count - 1) as f32)
    }
}

/// On the CPU, and in truth.
type Definitions = (fn(f32) -> f32, fn(f64) -> f64);

/// Functions whose bound is stated; the others are made of these.
pub const FUNCTIONS: [Function; 10] = {
    const fn function(
        name: &'static str,
        (cpu, exact): Definitions,
        [low, high]: [f32; 2],
        floor: f64,
        [ulps, device]: [f64; 2],
    ) -> Function {
        Function { name, cpu, exact, low, high, floor, ulps, device }
    }
    [
        function("sin", (elementary::sin, f64::sin), [-100.0, 100.0], 1.0, [1.5, 1.0]),
        // Far out.
        function("sin", (elementary::sin, f64::sin), [100.0, 8192.0], 1.0, [2.0, 1.0]),
        function("cos", (elementary::cos, f64::cos), [-100.0, 100.0], 1.0, [1.5, 1.0]),
        function("exp", (elementary::exp, f64::exp), [-87.0, 88.0], 0.0, [2.0, 1.0]),
        function("exp2", (elementary::exp2, f64::exp2), [-126.0, 126.9], 0.0, [2.0, 1.0]),
        function("log", (elementary::log, f64::ln), [1e-6, 1000.0], 1.0, [2.0, 1.0]),
        function("log2", (elementary::log2, f64::log2), [1e-6, 1000.0], 1.0, [3.0, 1.0]),
        function("atan", (elementary::atan, f64::atan), [-50.0, 50.0], 0.0, [2.5, 2.0]),
        function("asin", (elementary::asin, f64::asin), [-1.0, 1.0], 0.1, [4.0, 6.0]),
        function("acos", (elementary::acos, f64::acos), [-1.0, 1.0], 0.1, [4.0, 6.0]),
    ]
};

/// Arguments of each.
const ARGUMENTS: usize = 4096;

/// Works all of them out on the device.
pub fn compare(engine: &Engine) -> Result<Compared, Trouble> {
    let names: Vec<String> = (0..FUNCTIONS.len()).map(|n| format!("x{n}")).collect();
    let fields: Vec<(&str, Type)> = names.iter().map(|n| (n.as_str(), Type::Float)).collect();
    let calls = FUNCTIONS.iter().zip(&names).map(|(f, x)| (format!("{}({x})", f.name), Type::Float));
    let arguments = |n| FUNCTIONS.map(|f| Value::Float(f.argument(n, ARGUMENTS))).to_vec();
    let modules: Vec<Vec<Value>> = (0..ARGUMENTS).map(arguments).collect();
    let both = Expressions::new(&fields, calls.collect()).both(engine, Clock::default(), &modules)?;
    let mut worst = 0.0;
    for (values, args) in both.gpu.iter().zip(&modules) {
        for ((f, value), x) in FUNCTIONS.iter().zip(values).zip(args) {
            let (Value::Float(x), Value::Float(value)) = (x, value) else { continue };
            let part = f.error(*x, *value) / (f.ulps + f.device);
            if part.is_nan() || part > 1.0 {
                let (truth, bound) = ((f.exact)(f64::from(*x)), f.ulps + f.device);
                let error = f.error(*x, *value);
                let what = format!("emit: {}({x:?}) is {truth} and {value:?} on the GPU", f.name);
                return Err(Trouble::Differs(format!(
                    "{what}, {error:.1} ulp apart where {bound} are allowed"
                )));
            }
            worst = f64::max(worst, part);
        }
    }
    let values = (ARGUMENTS * FUNCTIONS.len()) as u64;
    Ok(Compared { runs: 1, passes: 1, values, rounding: worst as f32 })
}
