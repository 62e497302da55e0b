//! The flags of every subcommand.

use super::words::Sweep;
use burgeon::language::Value;
use burgeon::tessellate::lattice::MAX_DEPTH;
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

#[derive(Args)]
pub struct Run {
    #[command(flatten)]
    pub derive: Derive,
    /// Write the result, by extension: .bpt and .bv the nets, .json the exact word, .obj, .ply, .glb and
    /// .stl triangles, .png a picture; curves as .svg, .png, .obj, .csv and .json; may be given several times. Of several
    /// curves (--sweep, --seeds, --each) all go into one file, or where its name holds {} each into its own
    #[arg(long, value_name = "FILE")]
    pub out: Vec<PathBuf>,
    /// Where it runs: auto takes a hardware adapter, else a software one, else the CPU backend
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Backend::Auto)]
    pub backend: Backend,
    /// Cells along each side of a patch in .obj, .ply, .glb, .stl and .png, two triangles each; halved until the model
    /// has at most 2 million; not with --tolerance
    #[arg(long, value_name = "N", default_value_t = 8, conflicts_with = "tolerance", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub grid: u32,
    #[command(flatten)]
    pub fineness: Fineness,
    #[command(flatten)]
    pub words: Words,
    #[command(flatten)]
    pub drawing: Drawing,
    /// Colour the picture by the symbols of the modules
    #[arg(long)]
    pub by_symbol: bool,
    /// Mark the points of a curve in its .svg and .png
    #[arg(long)]
    pub points: bool,
    /// Draw the polygon that a curve begins with into its .svg and .png
    #[arg(long)]
    pub control: bool,
    /// Print one line of JSON: backend, adapter, compile_ms, steps (modules, ms), total_ms, peak_bytes;
    /// with --tolerance modules count erased ones, too, and there are vertices, triangles, tessellate_ms
    #[arg(long)]
    pub stats: bool,
}

/// Several curves in one run.
#[derive(Args)]
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
    /// The first flag that asks for several.
    pub fn flag(&self) -> Option<&'static str> {
        match self {
            Words { sweep, .. } if !sweep.is_empty() => Some("--sweep"),
            Words { seeds: Some(_), .. } => Some("--seeds"),
            Words { each: true, .. } => Some("--each"),
            _ => None,
        }
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
    /// Write the triangles, by extension: .obj, .ply, .glb, .stl, or .png a picture; may be given several times
    #[arg(long, value_name = "FILE")]
    pub out: Vec<PathBuf>,
    /// Where it runs: auto takes a hardware adapter, else a software one, else the CPU backend
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Backend::Auto)]
    pub backend: Backend,
    #[command(flatten)]
    pub machine: Machine,
    #[command(flatten)]
    pub drawing: Drawing,
    /// Print one line of JSON: backend, adapter, patches, vertices, triangles, tolerance, pixels (whether
    /// it is in these), tessellate_ms, total_ms
    #[arg(long)]
    pub stats: bool,
}

/// How fine a watertight mesh is.
#[derive(Args)]
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
    /// [default: 12]
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
    #[command(flatten)]
    pub view: View,
    /// What random numbers begin with; the param `seed` if left out, else 0
    #[arg(long, value_name = "N")]
    pub seed: Option<u32>,
    #[command(flatten)]
    pub machine: Machine,
}

/// What pixels are seen through: `bbox_px` and `area_px`, and tolerances.
#[derive(Args)]
pub struct View {
    /// Where the viewer stands, for what is measured in pixels: bbox_px and area_px in rules, and
    /// tolerances in px
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    pub eye: Option<[f32; 3]>,
    /// What the viewer looks at; the middle of the patches if left out
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "eye", value_parser = point)]
    pub look_at: Option<[f32; 3]>,
    /// The viewer's vertical angle of view, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 40.0, requires = "eye", value_parser = angle)]
    pub angle: f32,
    /// Width and height of the viewer's screen
    #[arg(long, value_name = "WxH", default_value = "1280x720", requires = "eye", value_parser = pixels)]
    pub pixels: [f32; 2],
}

/// A rule file, and which of its systems.
#[derive(Args)]
pub struct System {
    /// The rule file
    #[arg(value_name = "FILE.burgeon")]
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
    /// The rules, as behind `with`; several by priority, with commas between [default: the unnamed ones, else those
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
    /// word/context, scan, compact, tessellate, language; patch and curve for all of theirs; all of these if left out; and tessellate/crowd:
    /// ten thousand copies of the patches before a moving camera
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

fn tolerance(text: &str) -> Result<Tolerance, String> {
    let (number, unit): (&str, fn(f32) -> Tolerance) = match text.trim().strip_suffix("px") {
        Some(number) => (number.trim_end(), Tolerance::Pixels),
        None => (text.trim(), Tolerance::World),
    };
    match number.parse::<f32>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(unit(x)),
        _ => Err("write a number above 0, as in 0.01 (units of the model) or 0.5px (pixels)".to_string()),
    }
}

fn depth() -> clap::builder::RangedI64ValueParser<u32> {
    clap::value_parser!(u32).range(0..=i64::from(MAX_DEPTH))
}

/// `NAME=VALUE`: an int, a float, true or false, or a vector `x,y[,z[,w]]`.
fn assignment(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as in depth=4")?;
    let name = name.trim();
    if name.is_empty() {
        return Err("the name before = is missing".to_string());
    }
    Ok((name.to_string(), number(value.trim())?))
}

pub fn number(text: &str) -> Result<Value, String> {
    let float = |t: &str| match t.trim().parse::<f32>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is no number, true or false, or vector such as 0,0,4")),
    };
    if let Ok(i) = text.parse::<i32>() {
        return Ok(Value::Int(i));
    }
    let digits = text.strip_prefix('-').unwrap_or(text);
    if !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()) {
        let (low, high) = (i32::MIN, i32::MAX);
        return Err(format!("`{text}` lies outside int, {low} to {high}; as a float, write {text}.0"));
    }
    if let Ok(b) = text.parse::<bool>() {
        return Ok(Value::Bool(b));
    }
    let parts = text.trim_start_matches('(').trim_end_matches(')').split(',');
    let parts = parts.map(float).collect::<Result<Vec<f32>, String>>()?;
    match parts[..] {
        [x] => Ok(Value::Float(x)),
        [x, y] => Ok(Value::Vec2([x, y])),
        [x, y, z] => Ok(Value::Vec3([x, y, z])),
        [x, y, z, w] => Ok(Value::Vec4([x, y, z, w])),
        _ => Err(format!("`{text}` has {} components; a vector has 2 to 4", parts.len())),
    }
}

/// `QUERY=FILE`.
fn binding(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, file)) if !name.trim().is_empty() && !file.is_empty() => {
            Ok((name.trim().to_string(), PathBuf::from(file)))
        }
        _ => Err("write QUERY=FILE, as in heat=heat.csv".to_string()),
    }
}

fn point(text: &str) -> Result<[f32; 3], String> {
    match number(text)? {
        Value::Vec3(point) => Ok(point),
        _ => Err(format!("`{text}` is no point; write three numbers, as in 0,1.5,4")),
    }
}

fn angle(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(x) if x > 0.0 && x < 180.0 => Ok(x),
        _ => Err("the angle lies between 0 and 180 degrees".to_string()),
    }
}

fn pixels(text: &str) -> Result<[f32; 2], String> {
    let side = |t: &str| t.parse::<u32>().ok().filter(|n| (1..=1 << 16).contains(n));
    match text.split_once('x').map(|(w, h)| (side(w), side(h))) {
        Some((Some(w), Some(h))) => Ok([w as f32, h as f32]),
        _ => Err(format!("`{text}` is no size of a screen; write 1280x720")),
    }
}

const SIZES: &str = "write a whole number of bytes, as in 4G or 500M";

fn bytes(text: &str) -> Result<u64, String> {
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[number.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => 1u64,
        "k" | "kb" | "kib" => 1 << 10,
        "m" | "mb" | "mib" => 1 << 20,
        "g" | "gb" | "gib" => 1 << 30,
        "t" | "tb" | "tib" => 1 << 40,
        _ => return Err(SIZES.to_string()),
    };
    let number: u64 = number.parse().map_err(|_| SIZES.to_string())?;
    number.checked_mul(unit).ok_or_else(|| "more bytes than 64 bits can count".to_string())
}
