//! The CPU backend of tessellations: the passes of [`crate::tessellate::passes`] over vectors, in
//! parallel, with the same result whatever the number of threads.

pub mod advance;
pub mod afford;
pub mod begin;
pub mod decide;
pub mod enter;
pub mod finish;
pub mod mark;
pub mod placed;
pub mod recall;
pub mod split;
pub mod tally;
pub mod triangles;
pub mod vertices;

use super::scan::scan;
use crate::language::Value;
use crate::patch::Net;
use crate::plan::{self, Displacement, Plan};
use crate::tessellate::budget::{Budget, ROUNDS};
use crate::tessellate::lattice::Node;
use crate::tessellate::level::Target;
use crate::tessellate::passes::{DrawArgs, Status};
use crate::tessellate::surface::{self, Patches};
use crate::tessellate::topology;
use crate::tessellate::tree::Tree;
use crate::tessellate::vertex::Format;
use crate::tessellate::word::{self, Table};
use crate::tessellate::{Complete, Mesh, Options, Topology, mesh_of};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Nodes that one task of a pass works on.
pub const BLOCK: usize = 256;

/// The most cells that [`Tessellator::run_within`] makes: so many have triangles that 32 bits still count.
pub const MOST_NODES: u64 = 1 << 28;

/// About what a cell takes, with its share of vertices and triangles, which a [`Mesh`] has once more.
pub const BYTES_A_NODE: u64 = 160;

/// Why a tessellation was given up, or its points were not taken.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum Error {
    #[error(
        "{nodes} cells take about {} bytes; the memory budget is {budget} bytes: take a larger tolerance, \
         fewer halvings, or raise it",
        nodes * BYTES_A_NODE
    )]
    Memory { nodes: u64, budget: u64 },
    #[error("{nodes} cells are more than {MOST_NODES}; take a larger tolerance or fewer halvings")]
    Nodes { nodes: u64 },
    #[error("the tessellation was stopped")]
    Stopped,
    #[error("{found} control points where the patches have {expected}")]
    Points { found: usize, expected: usize },
}

/// Trees, vertices and triangles of a set of patches. Vectors are kept from frame to frame.
pub struct Tessellator {
    topology: Topology,
    degree: [u8; 2],
    rational: bool,
    nets: Vec<[f32; 4]>,
    orders: [Vec<usize>; 8],
    /// The nodes that each frame begins with.
    start: Vec<Node>,
    /// The node of the frame before with the same cell.
    start_before: Vec<u32>,
    /// Whether a frame has run since there was another word; and the word that it ran with.
    ran: bool,
    last: (Option<Table>, Vec<Node>),
    table: Option<Table>,
    format: Format,
    shared: bool,
    trees: Trees,
    /// The children of the frame before.
    children_before: Vec<u32>,
    budget: Budget,
    status: Status,
    draw: DrawArgs,
    out: Out,
    displacement: Option<Displacement>,
}

/// The columns of nodes: see [`crate::tessellate::passes`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trees {
    pub nodes: Vec<Node>,
    pub children: Vec<u32>,
    /// The node of the frame before with the same cell.
    pub before: Vec<u32>,
    pub marks: Vec<u32>,
    /// Counts of the pass that ran last: 1 for a split cell, or vertices.
    pub counts: Vec<u32>,
    pub triangle_counts: Vec<u32>,
    /// Prefix sums of the same, and the total.
    pub offsets: Vec<u32>,
    pub triangle_offsets: Vec<u32>,
    /// Nodes from here on are the level that is being split.
    pub level: usize,
}

/// What is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Out {
    pub vertices: Vec<u32>,
    /// Three a triangle, counter-clockwise from where the normals of the file's patches point.
    pub indices: Vec<u32>,
    /// For each triangle the node whose surface it is.
    pub cells: Vec<u32>,
}

impl Tessellator {
    /// For these nets; each begins as one cell.
    ///
    /// # Errors
    /// Where they are no set: see [`Topology::new`].
    pub fn new(nets: &[Net], options: &Options) -> Result<Tessellator, topology::Error> {
        let topology = Topology::new(nets)?;
        let start = topology.start();
        Ok(Tessellator::with_start(nets, topology, start, options))
    }

    /// For the leaves of a word, whose roots are these nets. `hole` is the symbol of erased cells.
    ///
    /// # Errors
    /// Where the word's leaves are no partition of the roots: see [`word::nodes`].
    pub fn of_word(
        nets: &[Net],
        word: &crate::patch::Word,
        hole: Option<usize>,
        options: &Options,
    ) -> Result<Tessellator, word::Error> {
        let topology = Topology::new(nets)?;
        let start = word::nodes(word, &topology, hole)?;
        Ok(Tessellator::with_start(nets, topology, start, options))
    }

    fn with_start(nets: &[Net], topology: Topology, start: Vec<Node>, options: &Options) -> Tessellator {
        let degree = nets.first().map_or([3, 3], |net| net.degree);
        let points: Vec<[f32; 4]> = nets.iter().flat_map(|net| net.points.iter().copied()).collect();
        Tessellator {
            topology,
            degree,
            rational: points.iter().any(|p| p[3] != 1.0),
            nets: points,
            orders: surface::orders(degree),
            table: (!word::are_roots(&start)).then(|| Table::new(&start)),
            start_before: (0..start.len() as u32).collect(),
            ran: false,
            last: (None, Vec::new()),
            start,
            format: options.format,
            shared: !options.seams,
            trees: Trees::default(),
            children_before: Vec::new(),
            budget: Budget::default(),
            status: Status::default(),
            draw: DrawArgs::default(),
            out: Out::default(),
            displacement: None,
        }
    }

    /// Displaces the vertices of the frames to come by the placement that ends the plan's run, with the params,
    /// queries, view and seed of the options; not at all where it has none. What is split is still decided on the
    /// smooth surface.
    ///
    /// # Errors
    /// For options that do not fit the plan, as [`Plan::uniforms`] and
    /// [`Given::new`](crate::plan::Given::new) say.
    pub fn displace(&mut self, plan: &Plan, options: &plan::Options) -> Result<(), plan::Error> {
        self.displacement = Displacement::new(plan, self.topology.roots(), options)?;
        Ok(())
    }

    /// Other values of some params of the placement, for the frames to come; the others stay.
    ///
    /// # Errors
    /// As [`Plan::uniforms`]; [`plan::Error::Set`] for any where nothing is displaced. Then all stay.
    pub fn set_params(&mut self, set: &[(String, Value)]) -> Result<(), plan::Error> {
        match (&mut self.displacement, set.first()) {
            (Some(displacement), _) => displacement.set_params(set),
            (None, Some((name, _))) => Err(plan::placement::nothing_to_set(name)),
            (None, None) => Ok(()),
        }
    }

    /// Other control points, of patches that meet as before.
    ///
    /// # Errors
    /// [`Error::Points`] when they are not as many as before.
    pub fn set_points(&mut self, points: &[[f32; 4]]) -> Result<(), Error> {
        if points.len() != self.nets.len() {
            return Err(Error::Points { found: points.len(), expected: self.nets.len() });
        }
        self.nets.copy_from_slice(points);
        Ok(())
    }

    /// Another word over the same roots, from the next frame on. Cells that the word before had, too, are remembered.
    ///
    /// # Errors
    /// Where the word's leaves are no partition of the roots: see [`word::nodes`]; then the word before still stands.
    pub fn set_word(&mut self, word: &crate::patch::Word, hole: Option<usize>) -> Result<(), word::Error> {
        let leaves = word::nodes(word, &self.topology, hole)?;
        if std::mem::take(&mut self.ran) {
            self.last = (self.table.take(), std::mem::take(&mut self.start));
        }
        self.start_before = recall::recall(self.last.0.as_ref(), &self.last.1, &leaves);
        self.table = Some(enter::enter(&leaves));
        self.start = leaves;
        Ok(())
    }

    pub fn topology(&self) -> &Topology {
        &self.topology
    }
    pub fn trees(&self) -> &Trees {
        &self.trees
    }
    pub fn out(&self) -> &Out {
        &self.out
    }
    pub fn status(&self) -> &Status {
        &self.status
    }
    pub fn draw_args(&self) -> &DrawArgs {
        &self.draw
    }
    pub fn is_displaced(&self) -> bool {
        self.displacement.is_some()
    }
    pub fn format(&self) -> &Format {
        &self.format
    }

    fn patches(&self) -> Patches<'_> {
        Patches { degree: self.degree, rational: self.rational, nets: &self.nets, orders: &self.orders }
    }

    /// The trees, to ask who is whose neighbour.
    pub fn tree(&self) -> Tree<'_> {
        Tree {
            topology: self.topology.words(),
            nodes: &self.trees.nodes,
            children: &self.trees.children,
            word: self.table.as_ref(),
            shared: self.shared,
        }
    }

    /// Makes the trees, then vertices and triangles.
    pub fn run(&mut self, target: &Target) {
        let Ok(()) = self.frame::<std::convert::Infallible>(target, |_| Ok(()));
    }

    /// The same while cells, vertices and triangles take no more than about `max_bytes`, and `stop` is not
    /// set: both are looked at from level to level of the trees.
    ///
    /// # Errors
    /// When it was given up; then there is nothing, as before the first run.
    pub fn run_within(&mut self, target: &Target, max_bytes: u64, stop: &AtomicBool) -> Result<(), Error> {
        let room = |nodes: u64| match nodes {
            _ if stop.load(Ordering::Relaxed) => Err(Error::Stopped),
            _ if nodes > MOST_NODES => Err(Error::Nodes { nodes }),
            _ if nodes > max_bytes / BYTES_A_NODE => Err(Error::Memory { nodes, budget: max_bytes }),
            _ => Ok(()),
        };
        let made = self.frame(target, room);
        if made.is_err() {
            (self.trees, self.out) = (Trees::default(), Out::default());
            self.children_before.clear();
            (self.status, self.draw) = (Status::default(), DrawArgs::default());
        }
        made
    }

    /// A frame, asking before each level whether there may be so many nodes.
    fn frame<E>(&mut self, target: &Target, may_be: impl Fn(u64) -> Result<(), E>) -> Result<(), E> {
        begin::begin(target.budget, &mut self.budget);
        self.remember();
        for _ in 0..ROUNDS {
            self.grow(target, &may_be)?;
            self.stitch();
            if target.budget == 0 {
                break;
            }
            let triangles = *self.trees.triangle_offsets.last().unwrap_or(&0);
            afford::afford(target.budget, triangles, &mut self.budget);
            if self.budget.fits != 0 {
                break;
            }
        }
        // Unless there is another word, the next frame begins with the same nodes.
        self.start_before = (0..self.start.len() as u32).collect();
        self.ran = true;
        finish::finish(&self.trees, self.budget.coarser, &mut self.status, &mut self.draw);
        self.dice();
        self.connect();
        Ok(())
    }

    /// The trees.
    pub fn refine(&mut self, target: &Target) {
        self.remember();
        let Ok(()) = self.grow::<std::convert::Infallible>(target, &|_| Ok(()));
    }

    /// The children that stand are those of the frame before.
    fn remember(&mut self) {
        std::mem::swap(&mut self.trees.children, &mut self.children_before);
    }

    fn grow<E>(&mut self, target: &Target, may_be: &impl Fn(u64) -> Result<(), E>) -> Result<(), E> {
        let mut t = std::mem::take(&mut self.trees);
        let before = &self.children_before;
        t.begin(&self.start, &self.start_before, !before.is_empty());
        while t.level < t.nodes.len() {
            let words = self.topology.words();
            decide::decide(&self.patches(), words, target, self.budget.coarser, before, &mut t);
            let split: u64 = t.counts.par_iter().map(|&count| u64::from(count)).sum();
            may_be(t.nodes.len() as u64 + 4 * split)?;
            t.offsets.resize(t.counts.len() + 1, 0);
            scan(&t.counts, &mut t.offsets);
            split::split(before, &mut t);
            advance::advance(&mut t);
        }
        self.trees = t;
        Ok(())
    }

    /// Who owns which vertex and makes which triangle.
    pub fn stitch(&mut self) {
        let mut t = std::mem::take(&mut self.trees);
        let (table, shared) = (self.table.as_ref(), self.shared);
        let marks = {
            let tree = Tree {
                topology: self.topology.words(),
                nodes: &t.nodes,
                children: &t.children,
                word: table,
                shared,
            };
            let marks = mark::mark(&tree, std::mem::take(&mut t.marks));
            tally::tally(&tree, marks, &mut t.counts, &mut t.triangle_counts)
        };
        t.marks = marks;
        t.offsets.resize(t.counts.len() + 1, 0);
        t.triangle_offsets.resize(t.triangle_counts.len() + 1, 0);
        scan(&t.counts, &mut t.offsets);
        scan(&t.triangle_counts, &mut t.triangle_offsets);
        self.trees = t;
    }

    /// Vertices, of trees that stand: after other control points, too.
    pub fn dice(&mut self) {
        let mut out = std::mem::take(&mut self.out.vertices);
        out.resize(self.status.vertices as usize * self.format.stride() as usize / 4, 0);
        let (patches, tree, trees, format) = (&self.patches(), &self.tree(), &self.trees, &self.format);
        match &self.displacement {
            None => vertices::vertices(patches, tree, trees, format, &mut out),
            Some(displacement) => placed::vertices(patches, tree, trees, displacement, format, &mut out),
        }
        self.out.vertices = out;
    }

    /// Triangles, of trees that stand.
    pub fn connect(&mut self) {
        let mut out = std::mem::take(&mut self.out);
        out.indices.resize(self.status.indices as usize, 0);
        out.cells.resize(self.status.indices as usize / 3, 0);
        triangles::triangles(&self.tree(), &self.trees, &mut out.indices, &mut out.cells);
        self.out = out;
    }

    /// Position, normal and uv of all vertices, and the triangles.
    ///
    /// # Panics
    /// When the format is not [`Format::default`].
    pub fn mesh(&self) -> Mesh {
        assert_eq!(self.format, Format::default(), "the format of a mesh");
        mesh_of(&self.out.vertices, self.out.indices.clone())
    }

    /// The mesh, and which leaf each triangle comes from.
    ///
    /// # Panics
    /// When the format is not [`Format::default`].
    pub fn complete(&self) -> Complete {
        Complete::new(self.mesh(), &self.trees.nodes, &self.out.cells, self.status)
    }
}

impl Trees {
    fn begin(&mut self, start: &[Node], start_before: &[u32], remembers: bool) {
        self.nodes.clear();
        self.nodes.extend(start);
        self.children.clear();
        self.marks.clear();
        self.before.clear();
        let nowhere = crate::tessellate::lattice::NOWHERE;
        self.before.extend(start_before.iter().map(|&n| if remembers { n } else { nowhere }));
        self.level = 0;
    }
}
