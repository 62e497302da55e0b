//! Meshes refined on the CPU.
//!
//! A level of a root is computed in a tile, all levels one after the other, and only what the root owns is written, once:
//! what a neighbour computes of it has the same bits and is dropped. So roots are independent, and threads and chunks need
//! nothing of each other.

mod indices;
mod limit;
mod output;
mod rings;
mod tile;

pub use indices::{quads, quads_into, triangles};

use crate::mesh::schemes::{QuadScheme, Visit};
use crate::mesh::{Creases, Topology, TopologyError};
use glam::Vec4;
use limit::LimitTile;
use output::Output;
use rayon::prelude::*;
use std::sync::Arc;
use tile::{GROWS, Tile, WIDEST};

/// Refines a mesh whose vertices move, without allocating once it has run. It uses the threads of the pool of `rayon` that
/// calls it.
///
/// ```
/// use burgeon::cpu::refine::{Refiner, quads};
/// use burgeon::mesh::{Faces, Mesh, Options, Topology};
/// use std::sync::Arc;
///
/// let corner = |n: u32| [n & 1, n >> 1 & 1, n >> 2].map(|bit| bit as f32);
/// let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
/// let cube = Mesh::new((0..8).map(corner).collect(), Faces::from_iter(faces));
///
/// let topology = Arc::new(Topology::new(&cube, &Options::default())?);
/// let mut refiner = Refiner::new(topology.clone(), 3)?;
/// let mut positions = vec![[0.0f32; 3]; topology.counts(3).vertices as usize];
/// refiner.refine(&cube.positions, &mut positions);
/// assert_eq!(positions.len(), 386);
/// assert_eq!(quads(&topology, 3).len(), 384);
/// # Ok::<(), burgeon::mesh::TopologyError>(())
/// ```
pub struct Refiner {
    topology: Arc<Topology>,
    creases: Creases,
    /// Of the last level, once they were asked for.
    masks: Option<limit::Masks>,
    level: u32,
    points: Vec<Vec4>,
    rings: Vec<Vec4>,
}

/// A level to be written: which, and its points.
pub type Level<'a, const N: usize> = (u32, &'a mut [[f32; N]]);

/// Where the vertices of the last level go in the limit. Where a vertex is on a crease or a corner, tangents and normal are
/// those of the faces of the first root that has it. The masks are OpenSubdiv's, which are not always the surface's: an edge
/// that is still semi-sharp counts as sharp, at a dart the smooth mask stands for what no mask says, and a vertex inside
/// that has two faces alone stays where it is.
pub struct Limits<'a> {
    pub positions: &'a mut [[f32; 3]],
    /// Of unit length; 0 where both tangents have one direction, or none.
    pub normals: &'a mut [[f32; 3]],
    /// Two that the normal turns counter-clockwise from the first to the second, of any length.
    pub tangents: Option<[&'a mut [[f32; 3]]; 2]>,
}

/// What is written of a level: its points, or a kind of [`limit::Values`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Points,
    Limit(usize),
}

/// What is asked for: at which level, counted from the roots, what, and where to.
type Wanted<'a, const N: usize> = (u32, What, &'a mut [[f32; N]]);

impl Refiner {
    /// To refine to this level, or any before it.
    ///
    /// # Errors
    /// A level of more vertices than 32-bit indices can name.
    pub fn new(topology: Arc<Topology>, level: u32) -> Result<Refiner, TopologyError> {
        let creases = topology.creases(level)?;
        Ok(Refiner { topology, creases, masks: None, level, points: Vec::new(), rings: Vec::new() })
    }

    /// The points of the last level, from those of the mesh: positions, or other numbers that vertices have, up to four at
    /// once.
    ///
    /// # Panics
    /// Where `mesh` or `out` are not as long as the topology says: see [`Topology::counts`].
    pub fn refine<const N: usize>(&mut self, mesh: &[[f32; N]], out: &mut [[f32; N]]) {
        self.refine_levels(mesh, &mut [(self.level, out)]);
    }

    /// The points of any levels, each once, of which none is beyond the last.
    ///
    /// # Panics
    /// As [`Refiner::refine`].
    pub fn refine_levels<const N: usize>(&mut self, mesh: &[[f32; N]], levels: &mut [Level<N>]) {
        const { assert!(N > 0 && N <= 4, "a point has one to four numbers") };
        let topology = self.topology.clone();
        assert_eq!(mesh.len(), topology.mesh_vertices(), "a point for each vertex of the mesh");
        for (level, out) in levels.iter() {
            assert!(*level <= self.level, "level {level} is beyond {}", self.level);
            let vertices = topology.counts(*level).vertices;
            assert_eq!(out.len() as u64, vertices, "a point for each vertex of level {level}");
        }
        let first = topology.first_level();
        let mut wanted: Vec<Wanted<N>> = Vec::with_capacity(levels.len());
        for (level, out) in levels.iter_mut() {
            match level.checked_sub(first) {
                Some(depth) => wanted.push((depth, What::Points, out)),
                // The mesh itself, where its faces are no roots.
                None => out.copy_from_slice(mesh),
            }
        }
        wanted.sort_by_key(|(depth, ..)| *depth);
        self.run(mesh, wanted);
    }

    /// The vertices of the last level in the limit.
    ///
    /// # Panics
    /// As [`Refiner::refine`], and where the last level is that of a mesh whose faces are no quads.
    pub fn refine_limit(&mut self, mesh: &[[f32; 3]], out: &mut Limits) {
        let topology = self.topology.clone();
        let vertices = topology.counts(self.level).vertices;
        let depth = self.level.checked_sub(topology.first_level()).expect("a level of quads");
        let mut wanted: Vec<Wanted<3>> =
            vec![(depth, What::Limit(0), &mut *out.positions), (depth, What::Limit(3), &mut *out.normals)];
        if let Some([along, across]) = &mut out.tangents {
            wanted.extend([(depth, What::Limit(1), &mut **along), (depth, What::Limit(2), &mut **across)]);
        }
        for (.., out) in &wanted {
            assert_eq!(out.len() as u64, vertices, "a point for each vertex of level {}", self.level);
        }
        if self.masks.is_none() {
            self.masks = Some(limit::Masks::new(&topology, &self.creases));
        }
        self.run(mesh, wanted);
    }

    fn run<const N: usize>(&mut self, mesh: &[[f32; N]], wanted: Vec<Wanted<N>>) {
        self.begin(mesh);
        let points = std::mem::take(&mut self.points);
        let rings = std::mem::take(&mut self.rings);
        let run = Run { refiner: self, points: &points, rings, limits: Vec::new(), wanted };
        self.rings = self.topology.options.scheme.visit(run);
        self.points = points;
    }

    /// The points of the roots.
    fn begin<const N: usize>(&mut self, mesh: &[[f32; N]]) {
        let point = |p: &[f32; N]| {
            let mut all = [0.0; 4];
            all[..N].copy_from_slice(p);
            Vec4::from_array(all)
        };
        self.points.clear();
        match &self.topology.first {
            None => self.points.extend(mesh.iter().map(point)),
            Some(first) => {
                let rows = (0..first.len()).into_par_iter().with_min_len(1024);
                rows.map(|row| first.row(row).map(|(at, w)| point(&mesh[at as usize]) * w).sum())
                    .collect_into_vec(&mut self.points);
            }
        }
    }
}

/// A refinement with masks that are known.
struct Run<'a, 'b, const N: usize> {
    refiner: &'a Refiner,
    points: &'a [Vec4],
    rings: Vec<Vec4>,
    /// Of the vertices of rings, where any are asked for.
    limits: Vec<limit::Values>,
    /// From the coarsest level on.
    wanted: Vec<Wanted<'b, N>>,
}

/// Gives the buffer of the rings back.
impl<const N: usize> Visit for Run<'_, '_, N> {
    type Output = Vec<Vec4>;

    fn quads<S: QuadScheme>(mut self) -> Vec<Vec4> {
        let (topology, creases) = (&*self.refiner.topology, &self.refiner.creases);
        self.rings.resize(topology.rings.points.len() * (creases.levels() + 1), Vec4::ZERO);
        rings::refine::<S>(topology, creases, self.points, &mut self.rings);
        let is_limit = |(_, what, _): &Wanted<N>| *what != What::Points;
        if let (Some(masks), true) = (&self.refiner.masks, self.wanted.iter().any(is_limit)) {
            self.limits = masks.of_rings(topology, creases.levels(), &self.rings);
        }
        // The finest levels at once: as many as a tile grows through.
        while let Some(&(last, ..)) = self.wanted.last() {
            let begin = last.saturating_sub(GROWS);
            let split =
                self.wanted.partition_point(|(depth, ..)| *depth < begin || *depth == begin && begin > 0);
            let together = self.wanted.split_off(split);
            self.together::<S>(last, together);
        }
        self.rings
    }
}

impl<const N: usize> Run<'_, '_, N> {
    /// Levels that one tile goes through while it grows, up to `last`.
    fn together<S: QuadScheme>(&self, last: u32, mut levels: Vec<Wanted<N>>) {
        let roots = &self.refiner.topology.roots;
        let limits = levels.iter().any(|(_, what, _)| *what != What::Points);
        // Rows of blocks in a root.
        let bands = 1usize << last.saturating_sub(GROWS);
        // Roots that are done in one piece.
        let block = if bands > 1 { 1 } else { (16384usize >> (2 * last)).clamp(1, 256) };
        let mut work: Vec<Piece<N>> = Vec::with_capacity(roots.len().div_ceil(block) * bands);
        for from in (0..roots.len()).step_by(block) {
            let to = (from + block).min(roots.len());
            let own = levels.iter_mut().map(|(depth, what, rest)| {
                let s = 1usize << *depth;
                let size = roots.base(to, s) - roots.base(from, s);
                let (own, after) = std::mem::take(rest).split_at_mut(size);
                *rest = after;
                (*depth, *what, own)
            });
            let own: Vec<Wanted<N>> = own.collect();
            if bands == 1 {
                work.push(Piece::Roots { from, to, levels: own });
                continue;
            }
            let own = own.into_iter();
            let mut outputs: Vec<Owned<N>> = own
                .map(|(depth, what, level)| (depth, what, Output::of(roots, from, 1usize << depth, level).0))
                .collect();
            for band in 0..bands {
                let mut here = Vec::with_capacity(outputs.len());
                let mut rest = Vec::with_capacity(outputs.len());
                for (depth, what, output) in outputs {
                    let s = 1usize << depth;
                    if band + 1 == bands {
                        here.push((depth, what, output));
                        continue;
                    }
                    let (own, after) = output.split((band + 1) * s / bands, s);
                    here.push((depth, what, own));
                    rest.push((depth, what, after));
                }
                outputs = rest;
                work.push(Piece::Band { root: from, band, levels: here });
            }
        }
        let tiles = || (Tile::new(), LimitTile::new(if limits { WIDEST } else { 0 }));
        work.into_par_iter().for_each_init(tiles, |tiles, piece| match piece {
            Piece::Roots { from, to, mut levels } => {
                for root in from..to {
                    let outputs = levels.iter_mut().map(|(depth, what, rest)| {
                        let (own, after) = Output::of(roots, root, 1 << *depth, std::mem::take(rest));
                        *rest = after;
                        (*depth, *what, own)
                    });
                    self.block::<S>(tiles, root, [0, 0], last, &mut outputs.collect::<Vec<_>>());
                }
            }
            Piece::Band { root, band, mut levels } => {
                let size = 1usize << GROWS;
                for x in 0..bands {
                    self.block::<S>(tiles, root, [x * size, band * size], last, &mut levels);
                }
            }
        });
    }

    /// The block of the last level that begins at (x, y), and what comes before it.
    fn block<S: QuadScheme>(
        &self,
        (tile, limits): &mut (Tile, LimitTile),
        root: usize,
        [x, y]: [usize; 2],
        last: u32,
        levels: &mut [Owned<N>],
    ) {
        let Refiner { topology, creases, masks, .. } = self.refiner;
        tile.begin(topology, root, self.points, &self.rings, creases.levels());
        let mut write = |tile: &Tile, depth: u32| {
            let here = || levels.iter().filter(|(wanted, ..)| *wanted == depth);
            if let (Some(masks), true) = (masks, here().any(|(_, what, _)| *what != What::Points)) {
                limits.fill::<S>((topology, creases, masks), root, tile.place, &tile.points, &self.limits);
            }
            for (_, what, output) in levels.iter_mut().filter(|(wanted, ..)| *wanted == depth) {
                match what {
                    What::Points => output.write(tile.place, &tile.points),
                    What::Limit(value) => output.write(tile.place, limits.of(*value)),
                }
            }
        };
        write(tile, 0);
        for depth in 0..last {
            tile.refine::<S>(topology, creases, root, depth as usize, &self.rings);
            let finer = last - depth - 1;
            if finer >= GROWS {
                tile.cut([x, y], finer);
            } else {
                write(tile, depth + 1);
            }
        }
    }
}

/// What a root or a band of one owns of what is asked for.
type Owned<'a, const N: usize> = (u32, What, Output<'a, N>);

/// What one thread does at once.
enum Piece<'a, const N: usize> {
    Roots { from: usize, to: usize, levels: Vec<Wanted<'a, N>> },
    Band { root: usize, band: usize, levels: Vec<Owned<'a, N>> },
}
