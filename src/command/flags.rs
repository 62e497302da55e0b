//! The flags of every subcommand.

use burgeon::language::Value;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub struct Run {
    #[command(flatten)]
    pub derive: Derive,
    /// Write the result; by extension: .bpt and .json the exact word, .obj triangles, .png a picture
    #[arg(long, value_name = "FILE")]
    pub out: Vec<PathBuf>,
    /// Where it runs: auto takes a hardware adapter, else a software one, else the CPU
    #[arg(long, value_enum, default_value_t = Backend::Auto)]
    pub backend: Backend,
    /// Cells along each side of a leaf's grid of triangles; halved until they are at most 2 million
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub grid: u32,
    /// The axis that points up in the picture
    #[arg(long, value_enum, default_value_t = Up::Y)]
    pub up: Up,
    /// Print one line of JSON: backend, adapter, compile_ms, steps, total_ms, peak_bytes
    #[arg(long)]
    pub stats: bool,
}

/// What is derived, and how far.
#[derive(Args)]
pub struct Derive {
    #[command(flatten)]
    pub system: System,
    /// A file in place of the axiom's (of every source that names the same file as the first)
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    /// Stop after N steps in all
    #[arg(long, value_name = "N")]
    pub steps: Option<u32>,
    /// Set a param of the system
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, Value)>,
    /// Threads of the CPU backend; 0 = one for each core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub threads: u32,
    /// The adapter whose name or backend holds this text
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Bytes the word and what a step writes may take, with K, M or G; default: half of the machine's
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub max_memory: Option<u64>,
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
pub struct Compare {
    #[command(flatten)]
    pub derive: Derive,
}

#[derive(Args)]
pub struct Devices {}

#[derive(Args)]
pub struct Bench {
    /// Which: copy, expand, patch/step, patch/derive, scan, compact, language; all if left out
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Patches to derive from, in place of 32 made ones
    #[arg(long = "in", value_name = "FILE")]
    pub input: Option<PathBuf>,
    /// Levels of patch/derive
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(1..=10))]
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

/// `NAME=VALUE`: an int, a float, true or false, or a vector `x,y[,z[,w]]`.
fn assignment(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as in depth=4")?;
    let name = name.trim();
    if name.is_empty() {
        return Err("the name before = is missing".to_string());
    }
    Ok((name.to_string(), number(value.trim())?))
}

fn number(text: &str) -> Result<Value, String> {
    let float = |t: &str| match t.trim().parse::<f32>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is no number, true or false, or vector such as 0,0,4")),
    };
    if let Ok(i) = text.parse::<i32>() {
        return Ok(Value::Int(i));
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

fn bytes(text: &str) -> Result<u64, String> {
    let (digits, unit) = match text.char_indices().last() {
        Some((i, 'k' | 'K')) => (&text[..i], 1u64 << 10),
        Some((i, 'm' | 'M')) => (&text[..i], 1 << 20),
        Some((i, 'g' | 'G')) => (&text[..i], 1 << 30),
        _ => (text, 1),
    };
    let number: u64 = digits.parse().map_err(|_| "write a number of bytes, as in 4G or 500M".to_string())?;
    number.checked_mul(unit).ok_or_else(|| "more bytes than there are".to_string())
}
