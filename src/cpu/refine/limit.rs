//! Where the vertices of the last level go in the limit, from their tiles and rings.

use super::tile::Place;
use crate::mesh::schemes::{Limit, LimitMasks, QuadScheme, limit_masks};
use crate::mesh::{Creases, NONE, Ring, Rule, Topology};
use glam::{Vec3A, Vec4};
use std::collections::HashMap;
use std::sync::Arc;

/// Position, both tangents and the unit normal of a vertex in the limit.
pub type Values = [Vec4; 4];

/// The masks of special vertices, and of those inside sharp sides.
pub struct Masks {
    rings: Vec<Arc<LimitMasks>>,
    /// Of a vertex inside a border: the other ends of its edges along the side, inward and back, then its two faces.
    side: LimitMasks,
}

impl Masks {
    pub fn new(topology: &Topology, creases: &Creases) -> Masks {
        let scheme = topology.options.scheme;
        let mut smooth: HashMap<u32, Arc<LimitMasks>> = HashMap::new();
        let of_ring = |ring: &Ring| {
            let (faces, edges) = (ring.faces as usize, ring.edges as usize);
            match ring.sharp {
                NONE => {
                    let limit = Limit { rule: Rule::Smooth, faces, edges, sharp: &vec![0.0; edges], face: 0 };
                    smooth.entry(ring.faces).or_insert_with(|| Arc::new(limit_masks(scheme, &limit))).clone()
                }
                _ => {
                    let (rule, sharp) = creases.last(ring);
                    let limit = Limit { rule, faces, edges, sharp, face: ring.owner as usize };
                    Arc::new(limit_masks(scheme, &limit))
                }
            }
        };
        let border = Limit { rule: Rule::Crease, faces: 2, edges: 3, sharp: &[1.0, 0.0, 1.0], face: 0 };
        Masks {
            rings: topology.rings.rings.iter().map(of_ring).collect(),
            side: limit_masks(scheme, &border),
        }
    }

    /// Those of all special vertices, in the sector of the root that owns each.
    pub fn of_rings(&self, topology: &Topology, levels: usize, rings: &[Vec4]) -> Vec<Values> {
        let of = |(ring, masks): (&Ring, &Arc<LimitMasks>)| {
            let own = &rings[ring.first as usize * (levels + 1) + levels * ring.len()..][..ring.len()];
            applied(masks, own.iter().copied())
        };
        topology.rings.rings.iter().zip(&self.rings).map(of).collect()
    }
}

fn applied(masks: &LimitMasks, points: impl Iterator<Item = Vec4>) -> Values {
    let [p, t, u] = masks
        .apply(points.map(|p| p.to_array()))
        .map(|v| Vec4::new(v[0] as f32, v[1] as f32, v[2] as f32, 0.0));
    [p, t, u, normal(t, u)]
}

/// To where both tangents turn counter-clockwise; 0 where they have no area.
#[inline(always)]
fn normal(t: Vec4, u: Vec4) -> Vec4 {
    let n = Vec3A::from_vec4(t).cross(Vec3A::from_vec4(u));
    let square = n.dot(n);
    (n * if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 }).extend(0.0)
}

/// What a tile of the last level has in the limit, point by point as the tile has them.
pub struct LimitTile([Vec<Vec4>; 4]);

impl LimitTile {
    pub fn new(points: usize) -> LimitTile {
        LimitTile(std::array::from_fn(|_| vec![Vec4::ZERO; points]))
    }

    /// One kind of the values.
    pub fn of(&self, value: usize) -> &[Vec4] {
        &self.0[value]
    }

    /// All points of the quads of a tile.
    pub fn fill<S: QuadScheme>(
        &mut self,
        (topology, creases, masks): (&Topology, &Creases, &Masks),
        root: usize,
        place: Place,
        points: &[Vec4],
        rings: &[Values],
    ) {
        self.smooth::<S>(place.n, points);
        let Some(special) = topology.roots.special(root) else { return };
        let level = creases.levels();
        for k in 0..4 {
            if special.creases[k] != NONE && place.touches(k) {
                let forward = topology.roots.owns_side(root, k);
                let sharp = |at: usize| {
                    let t = place.along(k, at, forward);
                    [t - 1, t].iter().all(|&i| creases.sharpness(special.creases[k] as usize, level, i) > 0.0)
                };
                self.side(masks, k, place, points, sharp);
            }
            let corner = special.corners[k].ring;
            if corner != NONE && place.has_corner(k) {
                self.set(place.index(place.corner(k)), rings[corner as usize]);
            }
        }
    }

    fn set(&mut self, at: usize, values: Values) {
        for (all, value) in self.0.iter_mut().zip(values) {
            all[at] = value;
        }
    }

    /// The vertices inside a sharp side, in the sector of this root.
    fn side(
        &mut self,
        masks: &Masks,
        k: usize,
        place: Place,
        points: &[Vec4],
        sharp: impl Fn(usize) -> bool,
    ) {
        let width = place.n as isize + 3;
        let along = [1, width, -1, -width][k];
        let inward = [width, -1, -width, 1][k];
        for at in place.inside_side(k, 0).filter(|&at| sharp(at)) {
            let here = place.index(place.on_side(k, at));
            let p = |x: isize, y: isize| points[(here as isize + x * along + y * inward) as usize];
            let ring = [p(0, 0), p(1, 0), p(0, 1), p(-1, 0), p(1, 1), p(-1, 1)];
            self.set(here, applied(&masks.side, ring.into_iter()));
        }
    }

    #[inline(never)]
    fn smooth<S: QuadScheme>(&mut self, n: usize, points: &[Vec4]) {
        let width = n + 3;
        let [positions, along, across, normals] = &mut self.0;
        for y in 1..n + 2 {
            let [up, middle, down] = [y - 1, y, y + 1].map(|y| &points[y * width..][..width]);
            let row = y * width..y * width + width;
            let [positions, along, across, normals] =
                [positions.as_mut_slice(), along, across, normals].map(|all| &mut all[row.clone()]);
            let column = |x: usize| S::column([up[x], middle[x], down[x]]);
            let (mut before, mut here) = (column(0), column(1));
            for x in 1..n + 2 {
                let after = column(x + 1);
                let [p, t, u] = S::row([before, here, after]);
                (positions[x], along[x], across[x]) = (p, t, u);
                normals[x] = normal(t, u);
                (before, here) = (here, after);
            }
        }
    }
}
