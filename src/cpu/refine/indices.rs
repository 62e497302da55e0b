//! The faces of a level, which no refinement is needed for.

use crate::mesh::{Roots, Topology};
use rayon::prelude::*;

/// The quads of a level, root after root, row by row; those of holes are left out. Level 0 of faces that are no quads has
/// none.
pub fn quads(topology: &Topology, level: u32) -> Vec<[u32; 4]> {
    let Some(depth) = level.checked_sub(topology.first_level()) else { return Vec::new() };
    let mut quads = vec![[0; 4]; topology.roots.solid << (2 * depth)];
    quads_into(topology, level, &mut quads);
    quads
}

/// The same into memory that is there.
///
/// # Panics
/// Where it is not as long as [`Topology::counts`] says.
pub fn quads_into(topology: &Topology, level: u32, out: &mut [[u32; 4]]) {
    assert_eq!(out.len() as u64, topology.counts(level).faces, "a quad for each face of level {level}");
    let (roots, s) = (&topology.roots, 1usize << (level - topology.first_level()));
    let at_once = (4096 / (s * s)).max(1);
    out.par_chunks_exact_mut(s * s).with_min_len(at_once).enumerate().for_each(|(root, out)| {
        of_root(roots, root, s, out);
    });
}

/// Two triangles for each quad of a level, parted from its first corner.
pub fn triangles(topology: &Topology, level: u32) -> Vec<[u32; 3]> {
    let quads = quads(topology, level);
    let mut triangles = vec![[0; 3]; 2 * quads.len()];
    triangles.par_chunks_exact_mut(2).with_min_len(4096).zip(quads).for_each(|(out, [a, b, c, d])| {
        out.copy_from_slice(&[[a, b, c], [a, c, d]]);
    });
    triangles
}

fn of_root(roots: &Roots, root: usize, s: usize, out: &mut [[u32; 4]]) {
    let halves = [0, 1, 2, 3].map(|k| (4 * root + k) as u32);
    let corner = halves.map(|half| roots.corner(roots.halves.origin(half), s));
    if s == 1 {
        out[0] = corner;
        return;
    }
    let m = s - 1;
    let side = halves.map(|half| roots.side(half, s));
    let inside = roots.inside(root, s);
    let on = |k: usize, t: usize| (side[k].0 as i32).wrapping_add(side[k].1 * (t as i32 - 1)) as u32;
    let left = |y: usize| match y {
        0 => corner[0],
        y if y == s => corner[3],
        y => on(3, s - y),
    };
    let right = |y: usize| match y {
        0 => corner[1],
        y if y == s => corner[2],
        y => on(1, y),
    };
    // The first inner vertex of a row, and the step to the next.
    let row = |y: usize| match y {
        0 => side[0],
        y if y == s => (on(2, s - 1), -side[2].1),
        y => (inside + ((y - 1) * m) as u32, 1),
    };
    for (y, out) in out.chunks_exact_mut(s).enumerate() {
        let ((a, i), (b, j)) = (row(y), row(y + 1));
        let at = |first: u32, step: i32, x: usize| first.wrapping_add((step * x as i32) as u32);
        out[0] = [left(y), a, b, left(y + 1)];
        for (x, quad) in out[1..m].iter_mut().enumerate() {
            *quad = [at(a, i, x), at(a, i, x + 1), at(b, j, x + 1), at(b, j, x)];
        }
        out[m] = [at(a, i, m - 1), right(y), right(y + 1), at(b, j, m - 1)];
    }
}
