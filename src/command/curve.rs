//! `burgeon run` of a curve system.

use super::load::{self, Job};
use super::output::file;
use super::progress::Bar;
use super::run::{self, milliseconds};
use super::{Failure, counted, flags, print, stop};
use burgeon::curve::Word;
use burgeon::io;
use burgeon::io::curves::{self, Picture, Style};
use burgeon::plan::derive::{self, StepStats};
use burgeon::plan::{Options, Progress};
use std::path::Path;
use std::time::Instant;

/// What curves are written as.
const FORMATS: [&str; 5] = ["svg", "png", "obj", "csv", "json"];

/// Derives and writes.
pub fn run(flags: &flags::Run) -> Result<(), Failure> {
    let start = Instant::now();
    if let Some(path) = flags.out.iter().find(|path| !FORMATS.iter().any(|e| load::has_extension(path, e))) {
        let what = "curves are written as .svg, .png, .obj, .csv or .json";
        return Err(Failure::Usage(format!("error: --out {}: {what}", path.display())));
    }
    if flags.fineness.tolerance.is_some() {
        let what = "--tolerance is for patches; a curve is as fine as its rules make it";
        return Err(Failure::Usage(format!("error: {what}")));
    }
    if flags.drawing.wireframe || flags.by_symbol {
        let what = "--wireframe and --by-symbol are for patches";
        return Err(Failure::Usage(format!("error: {what}")));
    }
    let job = load::job(&flags.derive, false)?;
    stop::watch();
    let bar = Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = run::options(&flags.derive, &job, &progress);
    let derived = derive(flags, &job, &options);
    if derived.is_err() {
        bar.clear();
    }
    let derived = derived?;
    let style = Style {
        control: if flags.control { control(&job)? } else { Vec::new() },
        points: flags.points,
        up: flags.drawing.up.into(),
        ..Style::default()
    };
    let mut failures = Vec::new();
    for path in &flags.out {
        bar.writing(path);
        failures.extend(write(path, &derived.word, &style).err());
    }
    bar.clear();
    super::joined(failures)?;
    if flags.stats {
        return print(&format!("{}\n", derived.stats(start)));
    }
    let Word { system, steps, modules, .. } = &derived.word;
    let (steps, modules) = (counted(u64::from(*steps), "step"), counted(modules.len() as u64, "module"));
    print(&format!("{system}: {steps}, {modules}\n"))
}

/// The larger side of a .png.
const PIXELS: u32 = 960;

fn write(path: &Path, word: &Word, style: &Style) -> Result<(), Failure> {
    let is = |extension| load::has_extension(path, extension);
    let picture = || Picture::of(&[word], style);
    match () {
        () if is("svg") => file(path, |w| curves::svg::write(w, &picture()?)),
        () if is("png") => file(path, |w| io::png::write(w, &curves::raster::draw(&picture()?, PIXELS))),
        () if is("obj") => file(path, |w| io::obj::write_lines(w, word)),
        () if is("csv") => file(path, |w| curves::csv::write(w, word)),
        () => file(path, |w| curves::json::write(w, word)),
    }
}

/// What the word begins with.
fn control(job: &Job) -> Result<Vec<curves::Line>, Failure> {
    let mut none = Options { steps: Some(0), ..Options::default() };
    none.set = job.set.clone();
    let mut cpu = run::cpu(job, 1)?;
    let failure = |e| job.failure(e);
    let derivation =
        derive::derive(&job.plan, &job.axiom, &job.uniforms, &none, &mut cpu).map_err(failure)?;
    let word = derive::collect_curve(&job.plan, &mut cpu, &derivation).map_err(failure)?;
    Ok(curves::lines(&word))
}

struct Derived {
    word: Word,
    backend: &'static str,
    adapter: String,
    compile_ms: f64,
    steps: Vec<StepStats>,
    peak_bytes: u64,
}

impl Derived {
    fn stats(&self, start: Instant) -> serde_json::Value {
        let step =
            |s: &StepStats| serde_json::json!({ "modules": s.modules, "ms": s.time.as_secs_f64() * 1e3 });
        serde_json::json!({
            "backend": self.backend,
            "adapter": self.adapter,
            "compile_ms": self.compile_ms,
            "steps": self.steps.iter().map(step).collect::<Vec<_>>(),
            "total_ms": milliseconds(start),
            "peak_bytes": self.peak_bytes,
        })
    }
}

fn derive(flags: &flags::Run, job: &Job, options: &Options) -> Result<Derived, Failure> {
    match run::device(flags.backend, &flags.derive.machine)? {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(job, options, &device),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match device {},
        None => on_cpu(job, options, flags.derive.machine.threads as usize),
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(job: &Job, options: &Options, device: &run::Device) -> Result<Derived, Failure> {
    use burgeon::gpu::{Engine, Gpu};
    let engine = Engine::new(&device.device, &device.queue);
    let failure = |e| match e {
        burgeon::gpu::Error::Plan(e) => job.failure(e),
        e => run::of_gpu(e),
    };
    let start = Instant::now();
    let mut gpu = Gpu::new(&engine, &job.plan, &job.uniforms).map_err(failure)?;
    gpu.compile().map_err(failure)?;
    let compile_ms = milliseconds(start);
    let derivation =
        derive::derive(&job.plan, &job.axiom, &job.uniforms, options, &mut gpu).map_err(failure)?;
    let word = derive::collect_curve(&job.plan, &mut gpu, &derivation).map_err(failure)?;
    let (steps, peak_bytes) = (derivation.steps, derivation.peak_bytes);
    Ok(Derived { word, backend: "gpu", adapter: device.info.name.clone(), compile_ms, steps, peak_bytes })
}

fn on_cpu(job: &Job, options: &Options, threads: usize) -> Result<Derived, Failure> {
    let mut cpu = run::cpu(job, threads)?;
    let failure = |e| job.failure(e);
    let derivation =
        derive::derive(&job.plan, &job.axiom, &job.uniforms, options, &mut cpu).map_err(failure)?;
    let word = derive::collect_curve(&job.plan, &mut cpu, &derivation).map_err(failure)?;
    let (steps, peak_bytes) = (derivation.steps, derivation.peak_bytes);
    Ok(Derived { word, backend: "cpu", adapter: "CPU".to_string(), compile_ms: 0.0, steps, peak_bytes })
}
