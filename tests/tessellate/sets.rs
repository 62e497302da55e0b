//! Sets of patches to tessellate.

use crate::oracle::Random;
use burgeon::patch::Net;
use std::collections::HashMap;

fn point(random: &mut Random, near: [f64; 3], spread: f64) -> [f32; 4] {
    let p = near.map(|x| (x + spread * (random.unit() - 0.5)) as f32);
    [p[0], p[1], p[2], 1.0]
}

/// a × b bicubic patches closed to a torus, whose points are thrown about it. With one patch around, curves
/// are closed; with two, they share their ends.
pub fn torus(a: u32, b: u32, seed: u64) -> Vec<Net> {
    let mut random = Random::new(seed);
    let mut known: HashMap<(u32, u32), [f32; 4]> = HashMap::new();
    let (rows, columns) = (3 * a, 3 * b);
    let mut at = |i: u32, j: u32| {
        let (i, j) = (i % rows, j % columns);
        *known.entry((i, j)).or_insert_with(|| {
            let turn = |k: u32, of: u32| f64::from(k) / f64::from(of) * std::f64::consts::TAU;
            let (u, v) = (turn(i, rows), turn(j, columns));
            let r = 2.0 + v.cos();
            point(&mut random, [r * u.cos(), v.sin(), r * u.sin()], 0.5)
        })
    };
    let mut nets = Vec::new();
    for p in 0..a {
        for q in 0..b {
            let points = (0..4).flat_map(|i| (0..4).map(move |j| (3 * p + i, 3 * q + j)));
            nets.push(Net { degree: [3, 3], points: points.map(|(i, j)| at(i, j)).collect() });
        }
    }
    nets
}

/// Patches that share the curve u = 0, as pages do.
pub fn book(pages: usize, seed: u64) -> Vec<Net> {
    let mut random = Random::new(seed);
    let spine: Vec<[f32; 4]> = (0..4).map(|j| point(&mut random, [0.0, f64::from(j), 0.0], 0.8)).collect();
    let page = |n: usize| {
        let angle = n as f64 / pages as f64 * std::f64::consts::TAU;
        let mut points = spine.clone();
        for i in 1..4 {
            for j in 0..4 {
                let r = f64::from(i);
                points.push(point(&mut random, [r * angle.cos(), f64::from(j), r * angle.sin()], 0.8));
            }
        }
        Net { degree: [3, 3], points }
    };
    (0..pages).map(page).collect()
}

/// Each net in one of its eight orientations, by three bits of `choice` after another; and whether that
/// mirrors it.
pub fn reoriented(nets: &[Net], choice: u64) -> (Vec<Net>, Vec<bool>) {
    let mut random = Random::new(choice);
    let turned = nets.iter().map(|net| {
        let o = random.below(8);
        let mut net = net.clone();
        if o & 1 != 0 {
            net.points.reverse();
        }
        if o & 2 != 0 {
            net = net.transposed();
        }
        if o & 4 != 0 {
            // The rows the other way round.
            let columns = net.degree[1] as usize + 1;
            net.points = net.points.chunks(columns).rev().flatten().copied().collect();
        }
        (net, (o & 2 != 0) != (o & 4 != 0))
    });
    turned.unzip()
}

/// The same for any seed.
pub fn scrambled(nets: &[Net], seed: u64) -> (Vec<Net>, Vec<bool>) {
    reoriented(nets, seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}
