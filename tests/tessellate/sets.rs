//! Sets of patches to tessellate.

use crate::oracle::Random;
use burgeon::patch::{Cell, Module, Net, Word};
use burgeon::word::{Params, Symbol};
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

/// Patches with sides that are points, or that are but a point.
pub fn degenerate() -> Vec<Net> {
    let net = |point: &dyn Fn(usize, usize) -> [f32; 4]| Net {
        degree: [3, 3],
        points: (0..16).map(|k| point(k / 4, k % 4)).collect(),
    };
    let mut nets = vec![net(&|_, _| [9.0, 9.0, 9.0, 1.0])];
    // Two opposite sides: nothing is left of an unsplit cell.
    nets.push(net(&|i, j| {
        let wide = if i == 0 || i == 3 { 0.0 } else { 1.0 };
        [i as f32 + 20.0, wide * (j as f32 - 1.5), wide, 1.0]
    }));
    // Two neighbouring sides, each way.
    for (low, high) in [(0, 0), (0, 3), (3, 0), (3, 3)] {
        let at = 30.0 + 5.0 * (low + 2 * high) as f32;
        nets.push(net(&|i, j| match i == low || j == high {
            true => [at, 0.0, 0.0, 1.0],
            false => [at + i as f32, j as f32, (i * j) as f32 * 0.3, 1.0],
        }));
    }
    // All four: a bag.
    nets.push(net(&|i, j| match (1..3).contains(&i) && (1..3).contains(&j) {
        true => [80.0 + i as f32, j as f32, 4.0, 1.0],
        false => [80.0, 0.0, 0.0, 1.0],
    }));
    nets
}

/// A random word over so many roots, as rules might make one: cells halved along one direction or both, and
/// holes, which are the symbol 1.
pub fn word(roots: u32, seed: u64) -> Word {
    fn grow(random: &mut Random, root: u32, cell: Cell, modules: &mut Vec<Module>) {
        let deep = u32::from(cell.du) + u32::from(cell.dv);
        if deep < 9 && random.below(10) < 10 - deep as usize {
            let halves = 1 + random.below(3) as u32;
            let (su, sv) = (halves & 1, halves >> 1);
            for c in 0..4u32 {
                let (hu, hv) = (c >> 1, c & 1);
                if hu <= su && hv <= sv {
                    let next = Cell {
                        du: cell.du + su as u8,
                        dv: cell.dv + sv as u8,
                        i: cell.i << su | hu,
                        j: cell.j << sv | hv,
                    };
                    grow(random, root, next, modules);
                }
            }
            return;
        }
        let symbol = usize::from(random.chance(30));
        let key = modules.len() as u64;
        modules.push(Module { symbol, row: 0, root, key, cell });
    }
    let (mut random, mut modules) = (Random::new(seed), Vec::new());
    for root in 0..roots {
        grow(&mut random, root, Cell::default(), &mut modules);
    }
    let symbol = |name: &str| Symbol { name: name.to_string(), fields: Vec::new() };
    let symbols = vec![symbol("P"), symbol("hole")];
    Word {
        system: "random".to_string(),
        steps: 9,
        params: Params::new(&symbols),
        symbols,
        degree: [3, 3],
        rational: false,
        modules,
        nets: Vec::new(),
    }
}
