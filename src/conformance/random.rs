//! Random numbers against frozen ones.

use super::operations::Expressions;
use super::{Compared, Trouble};
use crate::gpu::Engine;
use crate::language::{Type, Value};
use crate::plan::step::Clock;

/// The seed, and the steps of the whole run, of [`FROZEN`].
pub const CLOCK: Clock = Clock { step: 2, run_step: 3, seed: 0x9e37_79b9 };

/// The bits of `rand()`, another `rand()` and `randn()` of the first roots. They may never change: a
/// picture made from a seed stays as it is.
pub const FROZEN: [[u32; 3]; 8] = [
    [0x3ea2_55cc, 0x3ec5_0804, 0x3d56_3000],
    [0x3d84_77b0, 0x3eca_8406, 0x3fc1_8300],
    [0x3f52_6ecb, 0x3df1_8e28, 0xbf36_2d00],
    [0x3f48_8f6c, 0x3e44_41c0, 0x3e47_ac00],
    [0x3c93_e600, 0x3eae_9494, 0x3f1b_6f00],
    [0x3f02_69d3, 0x3e85_413a, 0x3f45_9100],
    [0x3f6a_8a00, 0x3d80_9dd0, 0x3eba_8c00],
    [0x3e77_6c6c, 0x3f7a_c98e, 0x3efd_d400],
];

/// The expressions behind [`FROZEN`].
pub fn expressions() -> Expressions {
    let call = |name: &str| (name.to_string(), Type::Float);
    Expressions::new(&[("n", Type::Int)], vec![call("rand()"), call("rand()"), call("randn()")])
}

/// Parameters of the modules.
pub fn modules() -> Vec<Vec<Value>> {
    (0..FROZEN.len() as i32).map(|n| vec![Value::Int(n)]).collect()
}

/// Draws them on both, to the bit.
pub fn compare(engine: &Engine) -> Result<Compared, Trouble> {
    let both = expressions().both(engine, CLOCK, &modules())?;
    for (name, values) in [("CPU", &both.cpu), ("GPU", &both.gpu)] {
        for (n, (values, frozen)) in values.iter().zip(FROZEN).enumerate() {
            for (call, (value, bits)) in values.iter().zip(frozen).enumerate() {
                if value.words() != [bits] {
                    let frozen = f32::from_bits(bits);
                    let what = format!("emit: number {call} of module {n} is frozen as {frozen:?}");
                    return Err(Trouble::Differs(format!("{what} and {value:?} on the {name}")));
                }
            }
        }
    }
    Ok(Compared { runs: 1, passes: 1, values: 3 * FROZEN.len() as u64, rounding: 0.0 })
}
