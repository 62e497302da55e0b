//! burgeon refines and grows geometry by parallel rewriting: rules, written as text, say what replaces
//! a point of a curve, a control net of a surface or a face of a mesh, and every one of them is
//! rewritten at once, step by step. The rules are compiled to tables and WGSL and run as compute
//! kernels on any [wgpu](https://docs.rs/wgpu) device; a CPU backend runs the same plan.
//! What comes out stays in GPU buffers or is read back as a [`Word`](patch::Word) of control nets, ready
//! to be tessellated, or as a [`Word`](curve::Word) of points.
//!
//! **This version derives patch systems**, Bézier nets of degrees 1 to 8 each way, polynomial and rational, and
//! **curve systems**: rings, open words and trees. Mesh systems are parsed and checked in full, but not derived yet.
//! What is not derived is refused by name ([`plan::Unsupported`]) before anything runs. The [reference](language#what-this-version-derives)
//! has the list.
//!
//! # A patch, on the CPU
//!
//! One net, written out in the rules, is split four times into all quarters but one:
//!
//! ```
//! use burgeon::{cpu, io::bpt, language::System, patch::Axiom, plan::{Options, Plan}, tessellate};
//!
//! let system = System::parse("
//!     system corner : patch bezier 3
//!     module P
//!     axiom: P = [[(0,0,0), (0,0,1), (0,0,2), (0,0,3)], [(1,0,0), (1,2,1), (1,2,2), (1,0,3)],
//!                 [(2,0,0), (2,2,1), (2,2,2), (2,0,3)], [(3,0,0), (3,0,1), (3,0,2), (3,0,3)]]
//!     rules:
//!       P -> [ P P ; P eps ]
//!     run:
//!       derive 4
//! ")?;
//! let plan = Plan::new(&system)?;
//! let axiom = Axiom::load(&system, &mut |file| bpt::read(file, false))?;
//! let (word, _) = cpu::derive(&plan, &axiom, &Options::default(), 0)?;
//! assert_eq!(word.modules.len(), 81);
//!
//! let mesh = tessellate::dice(&word, 8)?; // triangles, 8 × 8 cells a net
//! assert_eq!(mesh.triangles().len(), 81 * 2 * 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`System::parse`](language::System::parse) fails with all errors of the text at once, as lines with
//! carets. The closure reads the files that an axiom names; this axiom names none.
//!
//! A grid a net is quick, and cracks where nets of different levels meet. One watertight mesh, as fine as a
//! tolerance asks, comes of a word that keeps its holes, since these have sides, too:
//!
//! ```
//! use burgeon::{cpu, tessellate::{Level, Options}};
//! # use burgeon::{io::bpt, language::System, patch::Axiom, plan::{self, Plan}};
//! # let system = System::parse("
//! #     system corner : patch bezier 3
//! #     module P
//! #     axiom: P = [[(0,0,0), (0,0,1), (0,0,2), (0,0,3)], [(1,0,0), (1,2,1), (1,2,2), (1,0,3)],
//! #                 [(2,0,0), (2,2,1), (2,2,2), (2,0,3)], [(3,0,0), (3,0,1), (3,0,2), (3,0,3)]]
//! #     rules:
//! #       P -> [ P P ; P eps ]
//! #     run:
//! #       derive 4
//! # ")?;
//! # let axiom = Axiom::load(&system, &mut |file| bpt::read(file, false))?;
//!
//! let plan = Plan::keeping_holes(&system)?;
//! let (word, _) = cpu::derive(&plan, &axiom, &plan::Options::default(), 0)?;
//! let nets: Vec<_> = axiom.roots.iter().map(|root| root.net.clone()).collect();
//! let mut surface = cpu::tessellate::Tessellator::of_word(&nets, &word, plan.hole, &Options::default())?;
//! surface.run(&Level::world(0.01).target()?); // no triangle is farther off the surface
//! assert!(surface.mesh().triangles().len() >= 2 * 81);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A system that ends with `place NAME` says where the vertices of that mesh go, as
//! [displacement](language#displacement): [`surface.displace(&plan, &options)`](cpu::tessellate::Tessellator::displace)
//! before it is run.
//!
//! Nets without rules are tessellated by [`Tessellator::new`](cpu::tessellate::Tessellator::new).
//!
//! # The same, on a GPU
//!
#![cfg_attr(feature = "gpu", doc = "```no_run")]
#![cfg_attr(not(feature = "gpu"), doc = "```ignore")]
//! use burgeon::gpu::{self, Engine, Headless, Requirement};
//! # use burgeon::{io::bpt, language::System, patch::Axiom, plan::{Options, Plan}};
//! # let system = System::parse("system s : patch bezier 3")?;
//! # let plan = Plan::new(&system)?;
//! # let axiom = Axiom::load(&system, &mut |file| bpt::read(file, false))?;
//!
//! let own = Headless::new(Requirement::Any)?; // or the device and queue of your renderer
//! let engine = Engine::new(&own.device, &own.queue);
//! let (word, derivation) = gpu::derive(&engine, &plan, &axiom, &Options::default())?;
//! assert_eq!(word.modules.len(), 81);
//! for chunk in &derivation.chunks {
//!     let (records, nets) = (chunk.records(), chunk.nets()); // buffers, still on the device, if there are any
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A mesh comes of `gpu::tessellate::Tessellator`: its `encode` records a frame whose triangles stay on the
//! device for an indirect draw, its `complete` waits and gives them to the host.
//!
//! The engine needs no feature of the device and only WebGPU's default limits. How records and nets lie
//! in memory is told in [`plan::layout`]; the order of the word is in the records' keys, not in the order of
//! the chunks. CPU and GPU give the same word (nets and integers bit for bit on every device tried so
//! far, float parameters within rounding), and
//! `burgeon compare` checks it for your file on yours; `burgeon selftest` runs the whole conformance suite.
//!
//! # Where to look next
//!
//! - [`language`]: the reference of the rule language, with its [operations](language::operations),
//!   the [names](language::names) that the engine knows, and all [codes](language::codes) of errors.
//! - [`plan::Options`]: params, memory, progress, stopping. Params are set by name, without compiling anew;
//!   [`System::params`](language::System::params) lists them with types, defaults and ranges.
//! - [`patch`]: nets, words, evaluation of points and normals; [`word`]: the parameters of a word's modules, in columns.
//! - [`mesh`]: polygon meshes and their subdivision surfaces, refined by [`cpu::refine`], or on a device, frame by frame, by
//!   `gpu::refine`.
//! - [`tessellate`]: leaves to triangles, as grids or as one watertight mesh within a tolerance; on the CPU by
//!   [`cpu::tessellate`], on a device, frame by frame or once, by `gpu::tessellate`.
//! - `gpu::tessellate` (with the feature `gpu`): patches to watertight triangles, each frame anew, in a
//!   renderer of yours, with a walk through it.
//! - [`affine`]: curve rules as subdivision matrices, matrices as rules, and whole derivations as tables of stencils,
//!   which [`cpu::stencil`] and `gpu::Stencil` apply to control points that move.
//! - [`io`]: `.bpt`, `.bv`, `.json`, `.obj`, `.ply`, `.glb`, `.stl`, `.png`; curves also `.svg` and `.csv`.
//! - `gpu::run` (with the feature `gpu`): a whole derivation recorded into your encoder, of patches, of a curve or of
//!   several words at once, again each frame.
//! - [`plan::columns`], [`plan::layout`], [`plan::step`], [`plan::program`], in this order: what a word is in memory, and
//!   how a step works. Both backends and the recorded derivation walk the same list of passes.
//! - `conformance` (with the feature `gpu`): the suite that holds a device against the CPU, for the
//!   command and for programs that embed the engine.
//! - The folder `examples/` has rule files to begin with; `burgeon run FILE.burgeon --out picture.png`
//!   draws one.
//!
//! # Features
//!
//! | feature | in the default | what it brings |
//! |---|---|---|
//! | `gpu` | yes | `gpu` (the engine), `render` (pictures) and `conformance`. Without it the crate holds no wgpu |
//! | `cli` | yes | the command `burgeon` |
//!
//! A library takes `default-features = false, features = ["gpu"]`. `burgeon::wgpu` is the
//! wgpu it is built with, so that both sides speak of the same device.
//!
//! # Conventions
//!
//! - The row index of a net is u, its column index v. The normal is S_u × S_v.
//! - Axes are right-handed; in pictures y is up (or z, where asked for). Triangles run
//!   counter-clockwise seen from the side that the normals point to.
//! - Points in memory are homogeneous, `[xw, yw, zw, w]`, with w = 1 where a net is not rational.
//!   Files, and nets written out in rules, hold x, y, z and a weight.
//! - uv is the place in the unit square of the root, the net of the axiom that a leaf comes from.
//! - Words are in the order of the derivation tree, whatever the backend and however the work was cut.
//! - Angles of the language are degrees in the turtle and in `rotate`, radians in `sin` and its like.
//!
//! # Limits of single precision
//!
//! Control points are f32. A halving is a sum and a product with ½, so it is exact until a bit falls off
//! the end of the 24 that a float has: after about 23 halvings of a coordinate's extent (fewer where the
//! patch is small beside its distance from the origin) the midpoint of two neighbours is one of them,
//! points stop moving, and nets shrink to segments and points. An address ends soon behind, at 31 halvings
//! each way, and a deeper derivation is an error. For the same reason move a model that stands far from
//! the origin towards it first: at a distance of 10⁶ units coordinates are 1/16 apart. Coordinates below
//! 1.2·10⁻³⁸ are denormal, and GPUs may round them to 0, so that there the backends may differ.
#![forbid(unsafe_code)]
pub mod affine;
pub mod codegen;
#[cfg(feature = "gpu")]
pub mod conformance;
pub mod cpu;
pub mod curve;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod io;
pub mod language;
pub mod mesh;
pub mod patch;
pub mod plan;
#[cfg(feature = "gpu")]
pub mod render;
pub mod tessellate;
pub mod word;

#[cfg(feature = "gpu")]
pub use wgpu;
