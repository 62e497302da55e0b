//! Each vertex once, by the leaf that owns it: first those at its corners, in order, then its centre, then
//! those that its triangles bring.
//!
//! A vertex of 32 bytes takes a root's control points, which caches hold, and about 350 flops.

use super::tally::extra;
use super::{BLOCK, Trees};
use crate::tessellate::passes::{Corner, FAN, OWNS};
use crate::tessellate::surface::{Control, Patches};
use crate::tessellate::tree::Tree;
use crate::tessellate::vertex::{self, Format};
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
    let nets = || [Control::default(), Control::default()];
    blocks.into_par_iter().for_each_init(nets, |nets, (nodes, mut parts)| {
        let mut at = 0;
        for node in nodes {
            each(patches, tree, node as u32, trees.marks[node], nets, |vertex| {
                let (words, counts) = vertex.words(format);
                if let [(stride, part)] = parts.as_mut_slice() {
                    part[at * *stride..][..*stride].copy_from_slice(&words[..*stride]);
                } else {
                    let mut from = 0;
                    let there = counts.into_iter().filter(|&n| n > 0);
                    for ((stride, part), count) in parts.iter_mut().zip(there) {
                        part[at * *stride..][..count].copy_from_slice(&words[from..from + count]);
                        from += count;
                    }
                }
                at += 1;
            });
        }
    });
}

/// The vertices of a leaf, in order.
fn each(
    patches: &Patches,
    tree: &Tree,
    node: u32,
    marks: u32,
    nets: &mut [Control; 2],
    mut see: impl FnMut(vertex::Vertex),
) {
    if !tree.is_leaf(node) {
        return;
    }
    let cell = &tree.nodes[node as usize];
    if marks & (15 << OWNS | FAN) != 0 {
        for corner in (0..4).filter(|c| marks >> (OWNS + c) & 1 != 0) {
            see(tree.vertex(patches, nets, cell.root, cell.corner(corner), cell.symbol()));
        }
        if marks & FAN != 0 {
            see(tree.vertex(patches, nets, cell.root, cell.centre(), cell.symbol()));
        }
    }
    if !tree.shared {
        tree.triangles(node, marks, |triangle| {
            let (corners, of) = tree.corners(node, triangle);
            for (corner, own) in corners.into_iter().zip(extra(tree, node, triangle)) {
                if let (true, Corner::At { root, p }) = (own, corner) {
                    see(tree.vertex(patches, nets, root, p, tree.nodes[of as usize].symbol()));
                }
            }
        });
    }
}
