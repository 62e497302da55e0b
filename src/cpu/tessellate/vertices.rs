//! Each vertex once, by the leaf that owns it: first those at its corners, in order, then its centre, then
//! those that its triangles bring.
//!
//! A vertex of 32 bytes takes a root's control points, which caches hold, and 312 flops: 279 for the point and its
//! derivatives, 33 for the normal. Where 4 by 4 cells of one size stand together, as most do, their far corners share
//! what they have in common, and take 150. What remains is computed eight at once, those of one root together; so is
//! what other patches say of a border's normals.

// Loops over lanes count them, so that the compiler takes them together.
#![allow(clippy::needless_range_loop)]

use super::tally::extra;
use super::{BLOCK, Trees};
use crate::tessellate::lattice::{FULL, Node};
use crate::tessellate::passes::{Corner, OWNS};
use crate::tessellate::placement::on_side;
use crate::tessellate::surface::{Control, LANES, Patches, Samples, TILE};
use crate::tessellate::tree::Tree;
use crate::tessellate::vertex::{Format, Vertex};
use crate::tessellate::vertices::{Own, Rim};
use rayon::prelude::*;
use std::ops::Range;

/// Nodes of a task: more than elsewhere, since tiles do not reach from one to the next.
const TASK: usize = 4 * BLOCK;

/// Cells of a tile.
const CELLS: usize = TILE * TILE;

/// So many vertices of a tile take as long as the whole of it.
const WORTH: u32 = 5;

/// Writes all vertices in the format.
pub fn vertices(patches: &Patches, tree: &Tree, trees: &Trees, format: &Format, out: &mut [u32]) {
    let tasks = tasks(trees, TASK, format, out);
    tasks.into_par_iter().for_each_init(Work::default, |work, (nodes, out)| {
        let mut task = Task { patches, tree, trees, out };
        task.tiles(work, nodes);
        task.others(work);
    });
}

/// So many nodes a task, and its own part of each section to write their vertices to.
pub(super) fn tasks<'a, 'b>(
    trees: &Trees,
    nodes: usize,
    format: &'a Format,
    out: &'b mut [u32],
) -> Vec<(Range<usize>, Out<'a, 'b>)> {
    let count = *trees.offsets.last().unwrap_or(&0);
    let mut sections: Vec<(usize, &mut [u32])> = Vec::new();
    let mut rest = out;
    for place in format.places(count).iter().flatten() {
        if format.separate || sections.is_empty() {
            let stride = place.stride as usize / 4;
            let (section, behind) = rest.split_at_mut(stride * count as usize);
            sections.push((stride, section));
            rest = behind;
        }
    }
    let plain = *format == Format::default();
    let all = trees.nodes.len();
    let mut tasks = Vec::with_capacity(all.div_ceil(nodes));
    for start in (0..all).step_by(nodes) {
        let end = all.min(start + nodes);
        let vertices = (trees.offsets[end] - trees.offsets[start]) as usize;
        let mut parts = Vec::with_capacity(sections.len());
        for (stride, section) in &mut sections {
            let (part, behind) = std::mem::take(section).split_at_mut(*stride * vertices);
            *section = behind;
            parts.push((*stride, part));
        }
        tasks.push((start..end, Out { format, plain, parts }));
    }
    tasks
}

/// A vertex to be computed.
#[derive(Clone, Copy)]
struct Place {
    at: usize,
    root: u32,
    p: [u32; 2],
    symbol: u32,
}

/// A point of a patch that shares a vertex, and which one.
struct Ask {
    root: u32,
    p: [u32; 2],
    rim: usize,
}

/// What a thread works with, task after task.
#[derive(Default)]
struct Work {
    net: Control,
    samples: Samples<LANES>,
    tile: [Samples<TILE>; TILE],
    places: Vec<Place>,
    /// Vertices on borders, and where they go.
    rims: Vec<(usize, Rim)>,
    asks: Vec<Ask>,
}

struct Task<'a, 'b> {
    patches: &'a Patches<'a>,
    tree: &'a Tree<'a>,
    trees: &'a Trees,
    out: Out<'a, 'b>,
}

impl Task<'_, '_> {
    /// The vertices of some nodes: those of tiles are written, the others stand in `work.places` then.
    fn tiles(&mut self, work: &mut Work, nodes: Range<usize>) {
        work.places.clear();
        let start = self.trees.offsets[nodes.start];
        let mut node = nodes.start;
        while node < nodes.end {
            let (mut len, mut done) = (1, 0);
            if let Some(cells) = self.tree.nodes[node..nodes.end].first_chunk()
                && is_tile(cells)
            {
                len = CELLS;
                let (mut far, mut others) = (0, 0);
                for (m, marks) in self.trees.marks[node..][..CELLS].iter().enumerate() {
                    far |= (marks >> (OWNS + 3) & 1) << m;
                    others |= marks >> OWNS & 0b10111;
                }
                done = self.tile(work, node, far, start);
                if self.tree.shared && done == far && others == 0 {
                    node += len;
                    continue;
                }
            }
            for n in node..node + len {
                // Inside a root a point comes but once.
                let far = (done & 1 != 0).then(|| self.tree.nodes[n].corner(3));
                done >>= 1;
                let mut at = (self.trees.offsets[n] - start) as usize;
                each(self.tree, n as u32, self.trees.marks[n], |root, p, symbol| {
                    if far != Some(p) {
                        work.places.push(Place { at, root, p, symbol });
                    }
                    at += 1;
                });
            }
            node += len;
        }
    }

    /// Writes the vertices at the far corners of some cells of a tile, but for those on borders, and says which ones
    /// by bits.
    fn tile(&mut self, work: &mut Work, first: usize, mut wanted: u32, start: u32) -> u32 {
        let cell = &self.tree.nodes[first];
        let (low, size) = (cell.low(), cell.size());
        let (mut x, mut y) = ([0; TILE], [0; TILE]);
        for l in 0..TILE {
            (x[l], y[l]) = (low[0] + (l as u32 + 1) * size[0], low[1] + (l as u32 + 1) * size[1]);
        }
        // None of the last column or row where it ends on a border.
        let last = TILE - 1;
        wanted &= if x[last] == FULL { !LAST[0] } else { !0 };
        wanted &= if y[last] == FULL { !LAST[1] } else { !0 };
        if wanted.count_ones() < WORTH {
            return 0;
        }
        let (nets, trees) = ((&mut work.net, &mut work.tile), self.trees);
        let rows = self.tree.own_tile(self.patches, nets, cell.root, [&x, &y]);
        let (marks, offsets) = (&trees.marks[first..][..CELLS], &trees.offsets[first..][..CELLS]);
        for (r, row) in rows.iter().enumerate() {
            let mut points = [[0, y[r]]; TILE];
            for l in 0..TILE {
                points[l][0] = x[l];
            }
            let uv = row.uv(&points);
            for l in 0..TILE {
                let m = l & 1 | l << 1 & 4 | r << 1 & 2 | r << 2 & 8;
                if wanted >> m & 1 == 0 {
                    continue;
                }
                let mut at = offsets[m] - start;
                // Behind those at its other corners.
                let before = marks[m] >> OWNS & 7;
                if before != 0 {
                    at += before.count_ones();
                }
                let symbol = if self.out.plain { 0 } else { self.tree.nodes[first + m].symbol() };
                self.out.inner(at as usize, row, l, points[l], &uv, symbol);
            }
        }
        wanted
    }

    /// The vertices of `work.places`.
    fn others(&mut self, work: &mut Work) {
        let Work { net, samples, places, rims, asks, .. } = work;
        rims.clear();
        asks.clear();
        let (tree, format) = (self.tree, self.out.format);
        let shares = tree.shared && (format.normal.is_some() || format.tangent.is_some());
        let mut rest = places.as_slice();
        while let [place, ..] = rest {
            let (len, points) = run(rest, |place| (place.root, place.p));
            let own = tree.own(self.patches, (net, samples), place.root, &points);
            let uv = own.uv(&points);
            for (l, &Place { at, root, p, symbol }) in rest[..len].iter().enumerate() {
                if !on_side(p) {
                    self.out.inner(at, &own, l, p, &uv, symbol);
                    continue;
                }
                if shares {
                    let rim = rims.len();
                    tree.sharing(root, p, |root, p, own| {
                        if !own {
                            asks.push(Ask { root, p, rim });
                        }
                    });
                }
                rims.push((at, own.rim(net, l, p, symbol)));
            }
            rest = &rest[len..];
        }
        // Those of one root together. It is in the order of their roots that a vertex sums them anyway.
        asks.sort_by_key(|ask| ask.root);
        let mut rest = asks.as_slice();
        while let [ask, ..] = rest {
            let (len, points) = run(rest, |ask| (ask.root, ask.p));
            let other = tree.own(self.patches, (net, samples), ask.root, &points);
            for (l, ask) in rest[..len].iter().enumerate() {
                rims[ask.rim].1.see(other.normal(l));
            }
            rest = &rest[len..];
        }
        for (at, rim) in rims {
            self.out.write(*at, &rim.vertex(tree.shared, format.tangent.is_some()));
        }
    }
}

/// Where the cells of a tile are along x and y.
const IN_TILE: [[u32; 2]; CELLS] = {
    let mut places = [[0; 2]; CELLS];
    let mut m = 0;
    while m < CELLS {
        places[m] = [m as u32 & 1 | m as u32 >> 1 & 2, m as u32 >> 1 & 1 | m as u32 >> 2 & 2];
        m += 1;
    }
    places
};

/// The cells at the far ends of x and y, by bits.
const LAST: [u32; 2] = {
    let mut last = [0; 2];
    let mut m = 0;
    while m < CELLS {
        last[0] |= ((IN_TILE[m][0] == TILE as u32 - 1) as u32) << m;
        last[1] |= ((IN_TILE[m][1] == TILE as u32 - 1) as u32) << m;
        m += 1;
    }
    last
};

/// Whether these are 4 by 4 cells, in the order in which two levels of quarters stand.
#[inline(always)]
fn is_tile(cells: &[Node; CELLS]) -> bool {
    let [first, .., last] = cells;
    if (first.i | first.j) % TILE as u32 != 0 || [last.i, last.j] != [first.i + 3, first.j + 3] {
        return false;
    }
    let mut different = 0;
    for (cell, [l, r]) in cells.iter().zip(IN_TILE) {
        different |= cell.root ^ first.root | cell.shape ^ first.shape;
        different |= cell.i ^ (first.i + l) | cell.j ^ (first.j + r);
    }
    different == 0
}

/// How many of these lie on the root of the first, up to [`LANES`], and their points; behind the last stands the first
/// again.
fn run<T>(all: &[T], of: impl Fn(&T) -> (u32, [u32; 2])) -> (usize, [[u32; 2]; LANES]) {
    let (root, first) = of(&all[0]);
    let mut points = [first; LANES];
    let mut len = 0;
    for (point, item) in points.iter_mut().zip(all) {
        let (r, p) = of(item);
        if r != root {
            break;
        }
        *point = p;
        len += 1;
    }
    (len, points)
}

/// Where the vertices of a task go.
pub(super) struct Out<'a, 'b> {
    format: &'a Format,
    /// It is [`Format::default`].
    plain: bool,
    /// Words of a vertex, and all of them, for each section.
    parts: Vec<(usize, &'b mut [u32])>,
}

impl Out<'_, '_> {
    /// A vertex that no other patch shares.
    #[inline(always)]
    fn inner<const L: usize>(
        &mut self,
        at: usize,
        own: &Own<L>,
        lane: usize,
        p: [u32; 2],
        uv: &[[f32; L]; 2],
        symbol: u32,
    ) {
        if !self.plain {
            return self.write(at, &own.vertex(lane, p, symbol, self.format.tangent.is_some()));
        }
        let Samples { points, normal } = own.samples;
        let place = |k: usize| (points.position[k][lane] + 0.0).to_bits();
        let bits = |column: &[f32; L]| column[lane].to_bits();
        let vertices = self.parts[0].1.as_chunks_mut().0;
        vertices[at] = [
            place(0),
            place(1),
            place(2),
            bits(&normal[0]),
            bits(&normal[1]),
            bits(&normal[2]),
            bits(&uv[0]),
            bits(&uv[1]),
        ];
    }

    pub fn write(&mut self, at: usize, vertex: &Vertex) {
        if self.plain {
            let Vertex { position: p, normal: n, uv, .. } = vertex;
            let words = [p.x, p.y, p.z, n.x, n.y, n.z, uv[0], uv[1]].map(f32::to_bits);
            self.parts[0].1.as_chunks_mut().0[at] = words;
            return;
        }
        let (words, counts) = vertex.words(self.format);
        if let [(stride, part)] = self.parts.as_mut_slice() {
            return part[at * *stride..][..*stride].copy_from_slice(&words[..*stride]);
        }
        let mut from = 0;
        let there = counts.into_iter().filter(|&n| n > 0);
        for ((stride, part), count) in self.parts.iter_mut().zip(there) {
            part[at * *stride..][..count].copy_from_slice(&words[from..from + count]);
            from += count;
        }
    }
}

/// The vertices of a leaf, in order: root, lattice point and symbol.
#[inline(always)]
pub(super) fn each(tree: &Tree, node: u32, marks: u32, mut see: impl FnMut(u32, [u32; 2], u32)) {
    let cell = &tree.nodes[node as usize];
    // Corners in order, then the centre. A cell that is split owns none.
    let mut owned = marks >> OWNS & 31;
    while owned != 0 {
        let c = owned.trailing_zeros();
        owned &= owned - 1;
        see(cell.root, if c < 4 { cell.corner(c) } else { cell.centre() }, cell.symbol());
    }
    if !tree.shared && tree.is_leaf(node) {
        tree.triangles(node, marks, |triangle| {
            let (corners, of) = tree.corners(node, triangle);
            for (corner, own) in corners.into_iter().zip(extra(tree, node, triangle)) {
                if let (true, Corner::At { root, p }) = (own, corner) {
                    see(root, p, tree.nodes[of as usize].symbol());
                }
            }
        });
    }
}
