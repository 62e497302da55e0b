//! The flags of every subcommand.

use super::output::Format;
use super::values::{angle, assignment, binding, bytes, depth, pixels, point, seed, tolerance};
use super::words::Sweep;
use burgeon::language::Value;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Below the flags of `run`.
pub const RUN_EXAMPLES: &str = "\
Examples:
  burgeon run teapot.burgeon --out teapot.png
  burgeon run teapot.burgeon --set levels=5 --grid 4 --out teapot.obj --stats
  burgeon run teapot_lace.burgeon --tolerance 0.01 --out lace.glb
  burgeon run teapot.burgeon --in my_patches.bv --backend cpu --out word.json
  burgeon run teapot.burgeon --in control_points.obj --bspline --out smooth.glb
  burgeon run chaikin.burgeon --points --control --out curve.svg
  burgeon run chaikin.burgeon --out - --format svg | display
  burgeon run dlg.burgeon --sweep w=0..0.125/6 --out tension.svg
  burgeon run plant.burgeon --seeds 12 --out plants.png --out plant_{}.obj";

/// Below the flags of `tessellate`.
pub const TESSELLATE_EXAMPLES: &str = "\
Examples:
  burgeon tessellate teapot.bpt --tolerance 0.01 --out teapot.glb
  burgeon tessellate teapot.bpt --tolerance 0.1 --wireframe --out teapot.png
  burgeon tessellate teapot.bpt --tolerance 0.5px --eye 0,4,12 --out seen.ply
  burgeon tessellate control_points.obj --bspline --out smooth.obj";

/// Below the flags of `matrix`.
pub const MATRIX_EXAMPLES: &str = "\
Examples:
  burgeon matrix chaikin.burgeon
  burgeon matrix chaikin.burgeon --with left --n 8
  burgeon matrix dlg.burgeon --set w=0.125 --json";

/// Below the flags of `infer`.
pub const INFER_EXAMPLES: &str = "\
The file holds a row a line, its entries with commas between: numbers, or fractions as 3/4. Rows wrap
around, as those of a closed curve do; each block of them is the one before, moved on.

Examples:
  burgeon infer chaikin.csv > chaikin.burgeon
  burgeon infer chaikin.csv --shift -1 --name left";

/// Headings of the help.
const DERIVATION: &str = "Derivation";
const OUTPUT: &str = "Output";
const TRIANGLES: &str = "Triangles of patches";
const CURVES: &str = "Curves";
const PICTURES: &str = "Pictures";
const VIEWER: &str = "Viewer";
const MACHINE: &str = "Machine";

const WHERE: &str = "Where it runs: auto takes a hardware adapter, else the CPU backend; gpu takes any adapter, hardware \
                     first; cpu is the CPU backend, which is faster than software adapters";

const TO_STDOUT: &str = "What --out - writes, as .FORMAT does";

#[derive(Args)]
pub struct Run {
    #[command(flatten)]
    pub derive: Derive,
    /// Write the result, by extension: .bpt and .bv the nets, .json the exact word, .obj, .ply, .glb and
    /// .stl triangles, .png a picture; curves as .svg, .png, .obj, .csv and .json; may be given several times. Of several
    /// curves (--sweep, --seeds, --each) all go into one file, or where its name holds {} each into its own.
    /// `-` is the standard output, in the format that --format names; what is said then goes to stderr
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub out: Vec<PathBuf>,
    #[arg(long, value_name = "FORMAT", value_enum, help = TO_STDOUT, help_heading = OUTPUT)]
    pub format: Option<Format>,
    /// Print one line of JSON: backend, adapter, compile_ms, steps (modules, ms), total_ms, peak_bytes;
    /// with --tolerance modules count erased ones, too, and there are vertices, triangles, tessellate_ms
    #[arg(long, help_heading = OUTPUT)]
    pub stats: bool,
    /// Cells along each side of a patch in .obj, .ply, .glb, .stl and .png, two triangles each; not with --tolerance
    /// [default: 8, halved until the model has at most 2 million triangles]
    #[arg(long, value_name = "N", help_heading = TRIANGLES, conflicts_with = "tolerance", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub grid: Option<u32>,
    #[command(flatten)]
    pub fineness: Fineness,
    #[command(flatten)]
    pub words: Words,
    /// Mark the points of a curve in its .svg and .png
    #[arg(long, help_heading = CURVES)]
    pub points: bool,
    /// Draw the polygon that a curve begins with into its .svg and .png
    #[arg(long, help_heading = CURVES)]
    pub control: bool,
    #[command(flatten)]
    pub drawing: Drawing,
    /// Colour the picture by the symbols of the modules
    #[arg(long, help_heading = PICTURES)]
    pub by_symbol: bool,
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Backend::Auto, help = WHERE, help_heading = MACHINE)]
    pub backend: Backend,
}

/// Several curves in one run.
#[derive(Args)]
#[command(next_help_heading = CURVES)]
pub struct Words {
    /// Derive a curve for each of N values of a param, both ends among them, as in w=0..0.125/6; all ints, as in
    /// levels=1..6; given several times, for each combination
    #[arg(long, value_name = "NAME=FROM..TO/N", value_parser = Sweep::parse)]
    pub sweep: Vec<Sweep>,
    /// Derive N curves, with the seeds that follow --seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub seeds: Option<u32>,
    /// Derive each curve of the axiom's file by itself, in place of all its points as one
    #[arg(long)]
    pub each: bool,
}

impl Words {
    /// Whether several are asked for.
    pub fn are_several(&self) -> bool {
        !self.sweep.is_empty() || self.seeds.is_some() || self.each
    }
}

#[derive(Args)]
pub struct Tessellate {
    /// The patches: .bpt, .bv or .json; with --bspline .obj
    #[arg(value_name = "PATCHES")]
    pub file: PathBuf,
    /// Read an .obj: a grid of quads, as the control points of a uniform bicubic B-spline
    #[arg(long)]
    pub bspline: bool,
    #[command(flatten)]
    pub fineness: Fineness,
    #[command(flatten)]
    pub view: View,
    /// Write the triangles, by extension: .obj, .ply, .glb, .stl, or .png a picture; may be given several times.
    /// `-` is the standard output, in the format that --format names; what is said then goes to stderr
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub out: Vec<PathBuf>,
    #[arg(long, value_name = "FORMAT", value_enum, help = TO_STDOUT, help_heading = OUTPUT)]
    pub format: Option<Format>,
    /// Print one line of JSON: backend, adapter, patches, vertices, triangles, tolerance, pixels (whether
    /// it is in these), tessellate_ms, total_ms
    #[arg(long, help_heading = OUTPUT)]
    pub stats: bool,
    #[command(flatten)]
    pub drawing: Drawing,
    #[command(flatten)]
    pub machine: Machine,
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Backend::Auto, help = WHERE, help_heading = MACHINE)]
    pub backend: Backend,
}

/// How fine a watertight mesh is.
#[derive(Args)]
#[command(next_help_heading = TRIANGLES)]
pub struct Fineness {
    /// Make one watertight mesh, adaptively, whose triangles are off the surface by T at most: in units of
    /// the model, as in 0.01, or in pixels of the viewer's screen (--eye), as in 0.5px [tessellate's
    /// default: a thousandth of the model's diagonal]
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = tolerance)]
    pub tolerance: Option<Tolerance>,
    /// Halve each patch of that mesh, each way, so many times at least [default: 0]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = depth())]
    pub min_depth: Option<u32>,
    /// Halve each patch of that mesh, each way, no more often than this, whatever the tolerance
    /// [default: 12, or --min-depth where that is more]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = depth())]
    pub max_depth: Option<u32>,
}

/// A tolerance and its unit. They are one flag, so that nobody can give two tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// Units of the model.
    World(f32),
    Pixels(f32),
}

/// What a picture looks like.
#[derive(Args)]
#[command(next_help_heading = PICTURES)]
pub struct Drawing {
    /// The axis that points up in the picture, of curves without the other one; in .glb, which has y up, a z is
    /// turned there
    #[arg(long, value_name = "AXIS", value_enum, default_value_t = Up::Y)]
    pub up: Up,
    /// Draw the edges of all triangles in the picture
    #[arg(long)]
    pub wireframe: bool,
}

/// What of the machine is used.
#[derive(Args)]
#[command(next_help_heading = MACHINE)]
pub struct Machine {
    /// Threads of the CPU backend; 0: one a core
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub threads: u32,
    /// The first adapter whose name or backend holds this text; `burgeon devices` lists them
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// The most that the result, with what a step writes, may take, as in 500M or 4G [default: half of
    /// the machine's memory]
    #[arg(long, value_name = "BYTES", allow_negative_numbers = true, value_parser = bytes)]
    pub max_memory: Option<u64>,
}

/// What is derived, and how far.
#[derive(Args)]
#[command(next_help_heading = DERIVATION)]
pub struct Derive {
    #[command(flatten)]
    pub system: System,
    /// Read the patches from here, in place of the first file that the axiom names: .bpt, .bv, .json; points of
    /// curves: .csv, .svg, .obj
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    /// Read an .obj, too: a grid of quads, as the control points of a uniform bicubic B-spline
    #[arg(long)]
    pub bspline: bool,
    /// Stop after N steps in all
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub steps: Option<u32>,
    /// Set a param of the system, as in levels=4; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, Value)>,
    /// Bind values to a query without `=`, from a .csv (one for each patch) or a .json grid, as in
    /// heat=heat.csv; may be given several times
    #[arg(long, value_name = "QUERY=FILE", value_parser = binding)]
    pub bind: Vec<(String, PathBuf)>,
    /// What random numbers begin with: 32 bits, as 7, as 0xc0ffee, or below 0 as two's complement, so that -1 is
    /// 4294967295; the param `seed` if left out, else 0
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = seed)]
    pub seed: Option<u32>,
    #[command(flatten)]
    pub view: View,
    #[command(flatten)]
    pub machine: Machine,
}

/// What pixels are seen through: `bbox_px` and `area_px`, and tolerances.
#[derive(Args)]
#[command(next_help_heading = VIEWER)]
pub struct View {
    /// Where the viewer stands, for what is measured in pixels: bbox_px and area_px in rules, and
    /// tolerances in px
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    pub eye: Option<[f32; 3]>,
    /// What the viewer looks at; the middle of the patches if left out
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "eye", value_parser = point)]
    pub look_at: Option<[f32; 3]>,
    /// The viewer's vertical angle of view, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0, requires = "eye", allow_negative_numbers = true, value_parser = angle)]
    pub angle: f32,
    /// Width and height of the viewer's screen
    #[arg(long, value_name = "WxH", default_value = "1280x720", requires = "eye", value_parser = pixels)]
    pub pixels: [f32; 2],
}

/// A rule file, and which of its systems.
#[derive(Args)]
pub struct System {
    /// The rule file
    #[arg(value_name = "FILE.burgeon", help_heading = None::<&str>)]
    pub file: PathBuf,
    /// The system; the last of the file if left out
    #[arg(long, value_name = "NAME")]
    pub system: Option<String>,
}

#[derive(Args)]
pub struct Check {
    /// The rule file
    #[arg(value_name = "FILE.burgeon")]
    pub file: PathBuf,
}

#[derive(Args)]
pub struct Wgsl {
    #[command(flatten)]
    pub system: System,
}

#[derive(Args)]
pub struct Matrix {
    #[command(flatten)]
    pub system: System,
    /// The rules, as after `with`; several by priority, with commas between [default: the unnamed ones, else those
    /// of the first derive]
    #[arg(long, value_name = "GROUP", value_delimiter = ',')]
    pub with: Vec<String>,
    /// Set a param of the system, as in w=0.0625; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, Value)>,
    /// Points of the curve that the printed matrix is applied to
    #[arg(long, value_name = "N", default_value_t = 6, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub n: u32,
    /// The step of its derive, from 0, where the rules read `step`
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub step: u32,
    /// Print one JSON object: matrix and fractions by rows, mask, affine, generates, reproduces, shift, eigenvalues
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct Infer {
    /// The matrix
    #[arg(value_name = "FILE.csv")]
    pub file: PathBuf,
    /// The children of point i are the new points c·i + D to c·i + D + c - 1, counted from 0, with c new points
    /// an old one
    #[arg(long, value_name = "D", default_value_t = 0, allow_negative_numbers = true)]
    pub shift: i64,
    /// The name of the system [default: the file's]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
}

#[derive(Args)]
pub struct Compare {
    #[command(flatten)]
    pub derive: Derive,
}

#[derive(Args)]
pub struct Selftest {
    /// The first adapter whose name or backend holds this text; `burgeon devices` lists them
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Print one JSON object in place of the table
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct Devices {}

#[derive(Args)]
pub struct Bench {
    /// Which: copy, expand, flops, patch/step, patch/derive, curve/derive, curve/step, curve/words, curve/stencil,
    /// word/context, mesh/first, mesh/frame, mesh/levels, mesh/limit, scan, compact, tessellate, language; patch, curve
    /// and mesh for all of theirs; all of these if left out; and tessellate/crowd: ten thousand copies of the patches
    /// before a moving camera
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Patches to derive from, in place of 32 made ones
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    /// Levels of patch/derive
    #[arg(long, value_name = "N", default_value_t = 7, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=10))]
    pub levels: u32,
    /// Print one JSON object in place of the table
    #[arg(long)]
    pub json: bool,
    /// The adapter whose name or backend holds this text
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Up {
    Y,
    Z,
}
