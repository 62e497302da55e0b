//! Each vertex once, by the leaf that owns it: first those at its corners, in order, then its centre, then
//! those that its triangles bring.
//!
//! A vertex of 32 bytes takes a root's control points, which caches hold, and about 350 flops. Those inside a root
//! are computed several at once.

use super::tally::extra;
use super::{BLOCK, Trees};
use crate::tessellate::passes::{Corner, FAN, OWNS};
use crate::tessellate::surface::{Control, Patches};
use crate::tessellate::topology::side_at;
use crate::tessellate::tree::Tree;
use crate::tessellate::vertex::{self, Format};
use crate::tessellate::vertices::LANES;
use glam::Vec3;
use rayon::prelude::*;

/// Writes all vertices in the format.
pub fn vertices(patches: &Patches, tree: &Tree, trees: &Trees, format: &Format, out: &mut [u32]) {
    let count = *trees.offsets.last().unwrap_or(&0);
    // Each block of leaves writes to its own part of each section.
    let places = format.places(count);
    let mut sections: Vec<(usize, &mut [u32])> = Vec::new();
    let mut rest = out;
    for place in places.iter().flatten() {
        if format.separate || sections.is_empty() {
            let stride = place.stride as usize / 4;
            let (section, behind) = rest.split_at_mut(stride * count as usize);
            sections.push((stride, section));
            rest = behind;
        }
    }
    let mut blocks = Vec::new();
    for start in (0..tree.nodes.len()).step_by(BLOCK) {
        let end = tree.nodes.len().min(start + BLOCK);
        let vertices = (trees.offsets[end] - trees.offsets[start]) as usize;
        let mut parts = Vec::with_capacity(sections.len());
        for (stride, section) in &mut sections {
            let (part, behind) = std::mem::take(section).split_at_mut(*stride * vertices);
            *section = behind;
            parts.push((*stride, part));
        }
        blocks.push((start..end, parts));
    }
    let tangents = format.tangent.is_some();
    let plain = *format == Format::default();
    let work = || (Batch::default(), [Control::default(), Control::default()]);
    blocks.into_par_iter().for_each_init(work, |(batch, nets), (nodes, mut parts)| {
        let mut write = |at: usize, vertex: &vertex::Vertex| match parts.as_mut_slice() {
            [(_, part)] if plain => {
                let vertex::Vertex { position, normal, uv, .. } = vertex;
                let [p, n] = [position, normal].map(Vec3::to_array);
                let words = [p[0], p[1], p[2], n[0], n[1], n[2], uv[0], uv[1]].map(f32::to_bits);
                part[8 * at..][..8].copy_from_slice(&words);
            }
            [(stride, part)] => {
                let (words, _) = vertex.words(format);
                part[at * *stride..][..*stride].copy_from_slice(&words[..*stride]);
            }
            parts => {
                let (words, counts) = vertex.words(format);
                let mut from = 0;
                let there = counts.into_iter().filter(|&n| n > 0);
                for ((stride, part), count) in parts.iter_mut().zip(there) {
                    part[at * *stride..][..count].copy_from_slice(&words[from..from + count]);
                    from += count;
                }
            }
        };
        let mut at = 0;
        for node in nodes {
            each(tree, node as u32, trees.marks[node], |root, p, symbol| {
                if side_at(p[0], 0).or(side_at(p[1], 1)).is_some() {
                    write(at, &tree.vertex(patches, nets, root, p, symbol, tangents));
                } else {
                    if batch.root != root || batch.len == LANES {
                        batch.flush(patches, tree, &mut nets[0], tangents, &mut write);
                        batch.root = root;
                    }
                    (batch.points[batch.len], batch.places[batch.len]) = (p, (at, symbol));
                    batch.len += 1;
                }
                at += 1;
            });
        }
        batch.flush(patches, tree, &mut nets[0], tangents, &mut write);
    });
}

/// Vertices inside one root that wait to be computed together.
#[derive(Default)]
struct Batch {
    root: u32,
    len: usize,
    points: [[u32; 2]; LANES],
    /// Where each goes, and its symbol.
    places: [(usize, u32); LANES],
}

impl Batch {
    fn flush(
        &mut self,
        patches: &Patches,
        tree: &Tree,
        net: &mut Control,
        tangents: bool,
        write: &mut impl FnMut(usize, &vertex::Vertex),
    ) {
        if self.len == 0 {
            return;
        }
        let points = &self.points[..self.len];
        let vertices = tree.vertices_inside(patches, net, self.root, points, tangents);
        for (mut vertex, &(at, symbol)) in vertices.into_iter().zip(&self.places[..self.len]) {
            vertex.source[1] = symbol;
            write(at, &vertex);
        }
        self.len = 0;
    }
}

/// The vertices of a leaf, in order: root, lattice point and symbol.
pub(super) fn each(tree: &Tree, node: u32, marks: u32, mut see: impl FnMut(u32, [u32; 2], u32)) {
    if !tree.is_leaf(node) {
        return;
    }
    let cell = &tree.nodes[node as usize];
    for corner in (0..4).filter(|c| marks >> (OWNS + c) & 1 != 0) {
        see(cell.root, cell.corner(corner), cell.symbol());
    }
    if marks & FAN != 0 {
        see(cell.root, cell.centre(), cell.symbol());
    }
    if !tree.shared {
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
