//! Scan and compaction by themselves: CPU, GPU with both tunings, and the obvious loops.

use crate::device;
use burgeon::codegen::Tuning;
use burgeon::conformance::scans::{self, counts, expected, same};
use burgeon::cpu;
use burgeon::gpu::{Engine, Measure};

const LENGTHS: [usize; 7] = [0, 1, 255, 256, 257, 65_537, (1 << 24) + 1];

#[test]
fn cpu_scans_and_compacts_every_length() {
    for length in LENGTHS {
        let source = counts(length);
        let mut offsets = vec![7; length + 1];
        cpu::scan::scan(&source, &mut offsets);
        same(&format!("scan of {length}"), &offsets, &expected(Measure::Scan, &source)).unwrap();
        let mut indices = vec![7; 3];
        cpu::compact::compact(&source, 2, &mut indices);
        let what = Measure::Compact { wanted: 2 };
        same(&format!("compaction of {length}"), &indices, &expected(what, &source)).unwrap();
    }
}

#[test]
fn gpu_scans_and_compacts_every_length_with_both_tunings() {
    let Some(headless) = device::headless() else { return };
    for tuning in [Tuning::CPU_DRIVER, Tuning::GPU] {
        let engine = Engine::with_tuning(&headless.device, &headless.queue, tuning);
        scans::compare(&engine, &LENGTHS).unwrap_or_else(|e| panic!("{tuning:?}: {e}"));
    }
}

#[test]
fn sums_wrap() {
    let source = vec![u32::MAX, 2, u32::MAX, 5];
    let mut offsets = vec![0; 5];
    cpu::scan::scan(&source, &mut offsets);
    assert_eq!(offsets, [0, u32::MAX, 1, 0, 5]);
}
