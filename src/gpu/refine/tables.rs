//! A topology as kernels read it: `wgsl/refine`.

use crate::codegen::Around;
use crate::mesh::{Creases, NONE, Roots, Rule, Topology};
use std::ops::Range;

/// Words of a root.
const ROOT_WORDS: usize = 24;

/// See `wgsl/refine/shared/roots.wgsl`.
pub struct Tables {
    pub roots: Vec<u32>,
    pub extras: Vec<u32>,
    pub rings: Vec<[u32; 8]>,
    pub plans: Vec<u32>,
}

impl Tables {
    pub fn new(topology: &Topology, creases: &Creases) -> Tables {
        let roots = &topology.roots;
        let mut tables = Tables {
            roots: Vec::with_capacity(ROOT_WORDS * roots.len()),
            extras: Vec::new(),
            rings: Vec::new(),
            plans: Vec::new(),
        };
        for root in 0..roots.len() {
            let extra = tables.extra(topology, creases, root);
            tables.roots.extend(roots.neighbourhoods[root]);
            tables.roots.extend([roots.corners[root], roots.edges[root], owned(roots, root), extra]);
            tables.roots.extend([roots.corners[root + 1], roots.edges[root + 1], 0, 0]);
        }
        tables.rings(topology, creases);
        tables
    }

    /// What a root is beside a grid, and where it stands.
    fn extra(&mut self, topology: &Topology, creases: &Creases, root: usize) -> u32 {
        let roots = &topology.roots;
        let Some(special) = roots.special(root) else { return NONE };
        let at = self.extras.len() as u32;
        for corner in &special.corners {
            let ring = topology.rings.rings.get(corner.ring as usize);
            let base = ring.map_or(NONE, |ring| ring.first * (creases.levels() as u32 + 1));
            let size = ring.map_or(0, |ring| ring.len() as u32);
            self.extras.extend([base, size, corner.beside[0], corner.beside[1]]);
        }
        for (k, &crease) in special.creases.iter().enumerate() {
            self.extras.extend(match crease {
                NONE => [NONE, 0],
                crease => {
                    let (weights, uniform) = creases.row(crease as usize);
                    [weights, u32::from(roots.owns_side(root, k)) | u32::from(uniform) << 1]
                }
            });
        }
        at
    }

    /// See `wgsl/refine/rings.wgsl`.
    fn rings(&mut self, topology: &Topology, creases: &Creases) {
        let levels = creases.levels();
        for ring in &topology.rings.rings {
            let [own, others] = ring.weights.map(f32::to_bits);
            let plan = if ring.sharp == NONE { NONE } else { self.plans.len() as u32 };
            let base = ring.first * (levels as u32 + 1);
            self.rings.push([base, ring.first, ring.faces, ring.edges, plan, own, others, 0]);
            for level in (0..levels).filter(|_| ring.sharp != NONE) {
                let (step, weights) = creases.ring(ring, level);
                let rules = step.rules.map(|rule| match rule {
                    Rule::Smooth => 0,
                    Rule::Crease => 1,
                    Rule::Corner => 2,
                });
                let [[a, b], [c, d]] = step.ends;
                self.plans.extend([rules[0], rules[1], step.weight.to_bits(), a, b, c, d, 0]);
                self.plans.extend(weights.iter().map(|w| w.to_bits()));
            }
        }
    }
}

fn owned(roots: &Roots, root: usize) -> u32 {
    let corners = (0..4).map(|k| u32::from(roots.owns_corner(root, k)) << k);
    let sides = (0..4).map(|k| u32::from(roots.owns_side(root, k)) << (4 + k));
    corners.chain(sides).sum()
}

/// The roots in runs around which the same may stand.
pub fn runs(roots: &Roots) -> Vec<(Around, Range<usize>)> {
    let around = |root: usize| match roots.special(root) {
        None => Around::Grid,
        Some(special) if special.creases == [NONE; 4] => Around::Corners,
        Some(_) => Around::Creases,
    };
    let mut runs: Vec<(Around, Range<usize>)> = Vec::new();
    for root in 0..roots.len() {
        match runs.last_mut() {
            Some((last, run)) if *last == around(root) => run.end = root + 1,
            _ => runs.push((around(root), root..root + 1)),
        }
    }
    runs
}

/// How vertices of sides and corners are numbered: see `wgsl/refine/faces.wgsl`.
pub fn sides(roots: &Roots) -> (Vec<[u32; 4]>, Vec<[u32; 2]>) {
    let mut sides = Vec::with_capacity(8 * roots.len());
    for root in 0..roots.len() {
        let halves = [0, 1, 2, 3].map(|k| (4 * root + k) as u32);
        sides.extend(halves.map(|half| {
            let (rank, owner) = roots.corner_place(roots.halves.origin(half));
            [rank, roots.edges[owner as usize], owner, 0]
        }));
        sides.extend(halves.map(|half| {
            let edge = roots.halves.edge(half);
            let owner = roots.edge_place(edge);
            [roots.corners[owner as usize + 1], edge, owner, u32::from(roots.halves.is_first(half))]
        }));
    }
    let owned = (0..roots.len()).map(|root| [roots.corners[root + 1], roots.edges[root + 1]]).collect();
    (sides, owned)
}
