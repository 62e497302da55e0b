//! The vertices of a displaced tessellation: see [`crate::tessellate::placement`] and, for the kernel,
//! `wgsl/tessellate/shared/placement.wgsl`.
//!
//! Of a block of leaves all places that the expression is asked for are gathered first (for each vertex its own,
//! and four for the slopes on each patch that shares it); then it runs over them as columns.

use super::super::program::{self, Input, Registers};
use super::vertices::{Out, each, tasks};
use super::{BLOCK, Trees};
use crate::plan::layout::{HEADER_WORDS, Layout};
use crate::plan::placement::{Displacement, RECORD_WORDS};
use crate::plan::step::Clock;
use crate::tessellate::lattice::FULL;
use crate::tessellate::placement::{Mean, STEPS, Site, on_side, stencil};
use crate::tessellate::surface::{Control, Patches, Sample};
use crate::tessellate::tree::Tree;
use crate::tessellate::vertex::{Format, Vertex};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Writes all vertices in the format.
pub fn vertices(
    patches: &Patches,
    tree: &Tree,
    trees: &Trees,
    displacement: &Displacement,
    format: &Format,
    out: &mut [u32],
) {
    let environment = displacement.environment(0);
    let surface = Surface { patches, tree, displacement, environment: &environment, format };
    tasks(trees, BLOCK, format, out).into_par_iter().for_each_init(
        Work::default,
        |work, (nodes, mut out)| {
            surface.block(work, nodes, trees, &mut out);
        },
    );
}

struct Surface<'a> {
    patches: &'a Patches<'a>,
    tree: &'a Tree<'a>,
    displacement: &'a Displacement,
    environment: &'a [u32],
    format: &'a Format,
}

/// What one thread works with.
#[derive(Default)]
struct Work {
    nets: [Control; 2],
    registers: Registers,
    waiting: Vec<Waiting>,
    faces: Vec<Face>,
    probes: Vec<Probe>,
    /// Of each probe, [`RECORD_WORDS`] words.
    records: Vec<u32>,
    /// By what each probe is moved.
    offsets: Vec<Vec3>,
}

/// A vertex whose place is still to be worked out, if it moves at all.
struct Waiting {
    vertex: Vertex,
    point: [u32; 2],
    /// Its own probe.
    probe: Option<usize>,
    /// Its patches, itself first.
    faces: Range<usize>,
}

/// A patch around a vertex.
struct Face {
    root: u32,
    normal: Vec3,
    sample: Sample,
    /// Those of its slopes.
    probes: Range<usize>,
}

/// A place where the expression is asked for.
struct Probe {
    position: Vec3,
    /// Which slope it counts for, and how much.
    direction: usize,
    weight: f32,
}

impl Surface<'_> {
    /// Writes the vertices of some leaves.
    fn block(&self, work: &mut Work, nodes: Range<usize>, trees: &Trees, out: &mut Out) {
        work.waiting.clear();
        work.faces.clear();
        work.probes.clear();
        work.records.clear();
        for node in nodes {
            each(self.tree, node as u32, trees.marks[node], |root, p, symbol| {
                self.gather(work, root, p, symbol);
            });
        }
        self.run(work);
        let Work { nets: [net, _], waiting, faces, probes, offsets, .. } = work;
        for (at, waiting) in waiting.drain(..).enumerate() {
            out.write(at, &self.finish(net, waiting, faces, probes, offsets));
        }
    }

    /// Asks for the places that a vertex needs.
    fn gather(&self, work: &mut Work, root: u32, p: [u32; 2], symbol: u32) {
        let tree = self.tree;
        let tangents = self.format.tangent.is_some();
        let on = &self.displacement.placement.on;
        let vertex = tree.vertex(self.patches, &mut work.nets, root, p, symbol, tangents);
        if !on.is_empty() && !tree.lies_on(root, p, on) {
            work.waiting.push(Waiting { vertex, point: p, probe: None, faces: 0..0 });
            return;
        }
        let key = self.own(work, root, p);
        let (probe, first) = (work.probes.len() - 1, work.faces.len());
        if self.format.normal.is_some() || tangents {
            self.face(work, key, root, p);
            if tree.shared {
                tree.sharing(root, p, |r, q, own| {
                    if !own {
                        self.face(work, key, r, q);
                    }
                });
            }
        }
        let faces = first..work.faces.len();
        work.waiting.push(Waiting { vertex, point: p, probe: Some(probe), faces });
    }

    /// Asks for the vertex itself, as its owner sees it; what names it for random numbers.
    fn own(&self, work: &mut Work, root: u32, p: [u32; 2]) -> [u32; 3] {
        let (mut mean, mut owner) = (Mean::default(), None);
        let [first, others] = &mut work.nets;
        self.tree.sharing(root, p, |r, q, _| {
            let net = if owner.is_none() { &mut *first } else { &mut *others };
            let (normal, sample) = self.normal_at(net, r, q);
            mean.add(normal, normal);
            owner.get_or_insert((r, q, normal, sample));
        });
        // A point is shared by its own patch at least.
        let Some((r, q, normal, sample)) = owner else { return [root, 0, 0] };
        let orientation = self.tree.orientation(r);
        let [x, y] = orientation.to_file(q, [FULL; 2]);
        let position = first.position_of(q, sample.position);
        let normal = if on_side(p) { mean.unit() } else { normal };
        let site = Site::new(first, orientation, parameters(q), &sample, position, normal);
        push(work, [r, x, y], &site, 0, 0.0);
        [r, x, y]
    }

    /// Asks for what the slopes of a patch need.
    fn face(&self, work: &mut Work, key: [u32; 3], root: u32, p: [u32; 2]) {
        let orientation = self.tree.orientation(root);
        let (normal, sample) = self.normal_at(&mut work.nets[0], root, p);
        let (at, first) = (parameters(p), work.probes.len());
        for direction in 0..2 {
            for (off, weight) in stencil(at[direction]) {
                if weight == 0.0 {
                    continue;
                }
                let mut at = at;
                at[direction] += off / STEPS;
                let net = &work.nets[0];
                let (normal, sample) = net.normal_near(at);
                let normal = if orientation.mirrors() { -normal } else { normal };
                let site = Site::new(net, orientation, at, &sample, sample.position, normal);
                push(work, key, &site, direction, weight);
            }
        }
        work.faces.push(Face { root, normal, sample, probes: first..work.probes.len() });
    }

    /// The file's normal of one patch.
    fn normal_at(&self, net: &mut Control, root: u32, p: [u32; 2]) -> (Vec3, Sample) {
        let orientation = self.tree.orientation(root);
        self.patches.load(net, root, orientation);
        let (normal, sample) = net.normal(p);
        (if orientation.mirrors() { -normal } else { normal }, sample)
    }

    /// Runs the expression over all records.
    fn run(&self, work: &mut Work) {
        let placement = &self.displacement.placement;
        let input = Input {
            records: &work.records,
            layout: Layout::of_records(RECORD_WORDS, HEADER_WORDS),
            offsets: &[],
            made: 0,
            window: &[],
            first: 0,
            behind: 0,
            environment: self.environment,
            given: &self.displacement.given.words,
            measured: &[],
            measured_words: 0,
            clock: Clock { step: 0, run_step: 0, seed: 0 },
            linked: None,
            hangs: &[],
        };
        work.offsets.clear();
        for block in 0..input.len().div_ceil(super::super::BLOCK) {
            let block = input.block(block);
            program::run(&placement.graph, &block, &mut work.registers);
            let [x, y, z] = placement.offset.map(|node| work.registers.column(node));
            let at = |i: usize| Vec3::from([x, y, z].map(|column| f32::from_bits(column[i])));
            work.offsets.extend((0..block.len()).map(at));
        }
    }

    /// The vertex where it went, with the normal of the displaced surface.
    fn finish(
        &self,
        net: &mut Control,
        waiting: Waiting,
        faces: &[Face],
        probes: &[Probe],
        offsets: &[Vec3],
    ) -> Vertex {
        let Waiting { mut vertex, point, probe, faces: own } = waiting;
        let Some(probe) = probe else { return vertex };
        // +0 for −0, as everywhere.
        vertex.position = probes[probe].position + offsets[probe] + Vec3::ZERO;
        let (mut mean, mut first) = (Mean::default(), None);
        for face in &faces[own] {
            let orientation = self.tree.orientation(face.root);
            let mut slopes = [Vec3::ZERO; 2];
            for n in face.probes.clone() {
                slopes[probes[n].direction] += offsets[n] * probes[n].weight;
            }
            let [du, dv] = [face.sample.du + slopes[0] * STEPS, face.sample.dv + slopes[1] * STEPS];
            self.patches.load(net, face.root, orientation);
            let normal = match net.placed_normal([du, dv], vertex.position) {
                Some(normal) if orientation.mirrors() => -normal,
                Some(normal) => normal,
                None => face.normal,
            };
            mean.add(face.normal, normal);
            first.get_or_insert((normal, orientation, Sample { position: vertex.position, du, dv }));
        }
        if let Some((normal, orientation, sample)) = first {
            vertex.normal = if self.tree.shared && on_side(point) { mean.unit() } else { normal };
            let tangents = self.format.tangent.is_some();
            vertex.tangent =
                crate::tessellate::vertices::tangent(orientation, &sample, vertex.normal, tangents);
        }
        vertex
    }
}

/// Parameters of a lattice point.
fn parameters(p: [u32; 2]) -> [f32; 2] {
    p.map(|x| x as f32 / FULL as f32)
}

fn push(work: &mut Work, [root, x, y]: [u32; 3], site: &Site, direction: usize, weight: f32) {
    let [p, n, t, b] =
        [site.position, site.normal, site.tangent, site.bitangent].map(|v| v.to_array().map(f32::to_bits));
    let [scale, u, v] = [site.scale, site.uv[0], site.uv[1]].map(f32::to_bits);
    let record: [u32; RECORD_WORDS] = [
        0, root, x, y, p[0], p[1], p[2], scale, n[0], n[1], n[2], u, t[0], t[1], t[2], v, b[0], b[1], b[2], 0,
    ];
    work.records.extend(record);
    work.probes.push(Probe { position: site.position, direction, weight });
}
