//! Scan and compaction by themselves: CPU, GPU with both tunings, and the obvious loops.

use crate::device;
use burgeon::codegen::Tuning;
use burgeon::cpu;
use burgeon::gpu::{Engine, Measure, Scans};

const LENGTHS: [usize; 7] = [0, 1, 255, 256, 257, 65_537, (1 << 24) + 1];

/// Counts 0..=4 that follow no pattern.
fn counts(length: usize) -> Vec<u32> {
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

fn expected_offsets(counts: &[u32]) -> Vec<u32> {
    let mut sum = 0u32;
    let mut offsets: Vec<u32> = counts
        .iter()
        .map(|&c| {
            sum = sum.wrapping_add(c);
            sum.wrapping_sub(c)
        })
        .collect();
    offsets.push(sum);
    offsets
}

fn expected_indices(source: &[u32], wanted: u32) -> Vec<u32> {
    (0..source.len() as u32).filter(|&i| source[i as usize] == wanted).collect()
}

/// `assert_eq` would print 16 million numbers.
fn same(what: &str, got: &[u32], expected: &[u32]) {
    assert_eq!(got.len(), expected.len(), "{what}: length");
    if let Some(i) = (0..got.len()).find(|&i| got[i] != expected[i]) {
        panic!("{what}: element {i} is {} and should be {}", got[i], expected[i]);
    }
}

#[test]
fn cpu_scans_and_compacts_every_length() {
    for length in LENGTHS {
        let source = counts(length);
        let mut offsets = vec![7; length + 1];
        cpu::scan::scan(&source, &mut offsets);
        same(&format!("scan of {length}"), &offsets, &expected_offsets(&source));
        let mut indices = vec![7; 3];
        cpu::compact::compact(&source, 2, &mut indices);
        same(&format!("compaction of {length}"), &indices, &expected_indices(&source, 2));
    }
}

#[test]
fn gpu_scans_and_compacts_every_length_with_both_tunings() {
    let Some(headless) = device::headless() else { return };
    for tuning in [Tuning::CPU_DRIVER, Tuning::GPU] {
        let engine = Engine::with_tuning(&headless.device, &headless.queue, tuning);
        let scans = Scans::new(&engine).expect("the kernels compile");
        for length in LENGTHS {
            let source = counts(length);
            for (what, expected) in [
                (Measure::Scan, expected_offsets(&source)),
                (Measure::Compact { wanted: 2 }, expected_indices(&source, 2)),
            ] {
                let buffers = scans.prepare(what, &source).expect("buffers");
                scans.run(what, &buffers).expect("run");
                let got = scans.read(what, &buffers).expect("read");
                same(&format!("{what:?} of {length} with {tuning:?}"), &got, &expected);
            }
        }
    }
}

#[test]
fn sums_wrap() {
    let source = vec![u32::MAX, 2, u32::MAX, 5];
    let mut offsets = vec![0; 5];
    cpu::scan::scan(&source, &mut offsets);
    assert_eq!(offsets, [0, u32::MAX, 1, 0, 5]);
}
