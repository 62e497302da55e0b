//! Scan and compaction by themselves.

use super::{Case, Compared, Trouble, check};
use crate::codegen::{Mapping, Tuning};
use crate::gpu::{Engine, Measure, Scans};

/// Lengths around the sizes of workgroups and tiles.
pub const LENGTHS: [usize; 10] = [0, 1, 63, 255, 256, 257, 1025, 8193, 65_537, (1 << 20) + 1];

/// Counts 0..=4 that follow no pattern.
pub fn counts(length: usize) -> Vec<u32> {
    let mut state = 0x9e37_79b9u32;
    (0..length)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state % 5
        })
        .collect()
}

/// What must come of it, by the obvious loop.
pub fn expected(what: Measure, source: &[u32]) -> Vec<u32> {
    match what {
        Measure::Scan => {
            let mut sum = 0u32;
            let mut offsets = Vec::with_capacity(source.len() + 1);
            for count in source {
                offsets.push(sum);
                sum = sum.wrapping_add(*count);
            }
            offsets.push(sum);
            offsets
        }
        Measure::Compact { wanted } => {
            (0..source.len() as u32).filter(|&i| source[i as usize] == wanted).collect()
        }
    }
}

/// Runs both over these lengths.
pub fn compare(engine: &Engine, lengths: &[usize]) -> Result<Compared, Trouble> {
    let scans = Scans::new(engine)?;
    let mut all = Compared::default();
    for &length in lengths {
        let source = counts(length);
        for (pass, what) in [("scan", Measure::Scan), ("compact", Measure::Compact { wanted: 2 })] {
            let buffers = scans.prepare(what, &source)?;
            scans.run(what, &buffers)?;
            let got = scans.read(what, &buffers)?;
            same(&format!("{pass} of {length}"), &got, &expected(what, &source)).map_err(Trouble::Differs)?;
            all.add(Compared { runs: 1, passes: 1, values: got.len() as u64, rounding: 0.0 });
        }
    }
    Ok(all)
}

/// The first element that is not as it should be.
pub fn same(what: &str, got: &[u32], expected: &[u32]) -> Result<(), String> {
    if let Some(i) = (0..got.len().min(expected.len())).find(|&i| got[i] != expected[i]) {
        return Err(format!("{what}: element {i} is {} on the host and {} on the GPU", expected[i], got[i]));
    }
    match got.len() == expected.len() {
        true => Ok(()),
        false => Err(format!("{what}: {} elements on the host and {} on the GPU", expected.len(), got.len())),
    }
}

pub(super) fn cases() -> Vec<Case> {
    let tuning = |scan_workgroup, scan_items| Tuning {
        scan_workgroup,
        scan_items,
        workgroup: 64,
        mapping: Mapping::NetPerInvocation,
    };
    let case = |tuning: Tuning, lengths: &'static [usize]| {
        let name = format!("scan, compact: {} × {}", tuning.scan_workgroup, tuning.scan_items);
        Case::new(name, move |engine, stop| {
            let mut all = Compared::default();
            for length in lengths {
                check(stop)?;
                all.add(compare(&engine.retuned(tuning), &[*length])?);
            }
            Ok(all)
        })
    };
    vec![
        case(Tuning::CPU_DRIVER, &LENGTHS),
        case(Tuning::GPU, &LENGTHS),
        case(tuning(16, 64), &LENGTHS),
        // 64 elements a tile: more tiles than one dimension of workgroups holds.
        case(tuning(2, 32), &[32_769 * 64]),
    ]
}
