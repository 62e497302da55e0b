//! `burgeon run` of a curve system.

use super::load::{self, Job};
use super::output::file;
use super::progress::Bar;
use super::run::{self, milliseconds};
use super::words::{self, Several};
use super::{Failure, counted, flags, print, stop};
use burgeon::curve::{Word, Words};
use burgeon::io;
use burgeon::io::curves::{self, Panel, Picture, Style};
use burgeon::plan::derive::{self, Backend, StepStats};
use burgeon::plan::{Options, Plan, Progress};
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
    let job =
        load::job(&flags.derive, if flags.words.flag().is_some() { Plan::of_words } else { Plan::new })?;
    if !flags.words.each {
        job.say_notes();
    }
    let several = flags.words.flag().map(|_| words::several(flags, &job)).transpose()?;
    let several = several.as_ref();
    stop::watch();
    let bar = Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = run::options(&flags.derive, &job, &progress);
    let derived = derive(flags, &job, several, &options);
    if derived.is_err() {
        bar.clear();
    }
    let derived = derived?;
    let drawn = Drawn {
        control: if flags.control { control(&job, several)? } else { vec![Vec::new(); derived.words.len()] },
        combinations: several.map_or(1, |several| several.combinations),
        columns: several.and_then(|several| several.columns),
        style: Style { points: flags.points, up: flags.drawing.up.into(), ..Style::default() },
    };
    let mut failures = Vec::new();
    for path in &flags.out {
        if stop::requested() {
            break;
        }
        bar.writing(path);
        failures.extend(write_all(path, several, &derived.words, &drawn).err());
    }
    bar.clear();
    stop::check("before all files were written; those written are whole")?;
    super::joined(failures)?;
    if flags.stats {
        return print(&format!("{}\n", derived.stats(several.is_some(), start)));
    }
    let steps = counted(derived.steps.len() as u64, "step");
    let modules = derived.words.iter().map(|word| word.modules.len() as u64).sum();
    let modules = counted(modules, "module");
    let words =
        several.map_or(String::new(), |_| format!("{}, ", counted(derived.words.len() as u64, "curve")));
    print(&format!("{}: {steps}, {words}{modules}\n", job.plan.system.name))
}

/// What pictures show beside the words.
struct Drawn {
    /// For each word.
    control: Vec<Vec<curves::Line>>,
    /// Panels, and how many stand in a row. The curves of one file stay where they are to each other: one panel.
    combinations: usize,
    columns: Option<usize>,
    style: Style,
}

/// The larger side of a .png, of a panel, and the most.
const PIXELS: u32 = 960;
const PANEL_PIXELS: u32 = 360;
const MOST_PIXELS: u32 = 4096;

/// One file, or where its name says so one for each of several words.
fn write_all(path: &Path, several: Option<&Several>, words: &[Word], drawn: &Drawn) -> Result<(), Failure> {
    let name = path.to_string_lossy();
    if several.is_none() || !name.contains("{}") {
        return write(path, several.map(|several| &several.words), words, drawn);
    }
    let digits = (words.len() - 1).to_string().len();
    for (n, word) in words.iter().enumerate() {
        let path = name.replace("{}", &format!("{n:0digits$}"));
        let control = vec![drawn.control[n].clone()];
        let drawn = Drawn { control, combinations: 1, columns: None, style: drawn.style.clone() };
        write(Path::new(&path), None, std::slice::from_ref(word), &drawn)?;
    }
    Ok(())
}

fn write(path: &Path, several: Option<&Words>, words: &[Word], drawn: &Drawn) -> Result<(), Failure> {
    let is = |extension| load::has_extension(path, extension);
    let all: Vec<&Word> = words.iter().collect();
    let picture = || {
        let panel = |n: usize| {
            let control = drawn.control.iter().skip(n).step_by(drawn.combinations);
            let words = words.iter().skip(n).step_by(drawn.combinations).collect();
            Panel { words, control: control.flatten().cloned().collect() }
        };
        let panels: Vec<Panel> = (0..drawn.combinations).map(panel).collect();
        Picture::sheet(&panels, drawn.columns, &drawn.style)
    };
    let pixels = match drawn.combinations {
        0 | 1 => PIXELS,
        n => {
            let columns = drawn.columns.unwrap_or(n.isqrt() + 1);
            let panels = columns.max(n.div_ceil(columns)) as u32;
            panels.saturating_mul(PANEL_PIXELS).clamp(PIXELS, MOST_PIXELS)
        }
    };
    match () {
        () if is("svg") => file(path, |w| curves::svg::write(w, &picture()?)),
        () if is("png") => file(path, |w| io::png::write(w, &curves::raster::draw(&picture()?, pixels))),
        () if is("obj") => file(path, |w| io::obj::write_lines(w, &all)),
        () if is("csv") => file(path, |w| curves::csv::write(w, &all)),
        () => file(path, |w| match several {
            Some(starts) => curves::json::write_words(w, starts, words),
            None => words.iter().try_for_each(|word| curves::json::write(w, word)),
        }),
    }
}

/// What the words begin with.
fn control(job: &Job, several: Option<&Several>) -> Result<Vec<Vec<curves::Line>>, Failure> {
    let none = Options { steps: Some(0), set: job.set.clone(), ..Options::default() };
    let mut cpu = run::cpu(job, 1)?;
    let (words, ..) = all(job, several, &none, &mut cpu).map_err(|e| job.failure(e))?;
    Ok(words.iter().map(curves::lines).collect())
}

/// All words of a job, the steps of all together, and the most bytes that one run took.
fn all<B: Backend>(
    job: &Job,
    several: Option<&Several>,
    options: &Options,
    backend: &mut B,
) -> Result<(Vec<Word>, Vec<StepStats>, u64), B::Error> {
    let Some(several) = several else {
        let derivation = derive::derive(&job.plan, &job.axiom, &job.uniforms, options, backend)?;
        let word = derive::collect_curve(&job.plan, backend, &derivation)?;
        return Ok((vec![word], derivation.steps, derivation.peak_bytes));
    };
    let mut words: Vec<Option<Word>> = vec![None; several.words.words.len()];
    let (mut steps, mut peak_bytes) = (Vec::new(), 0);
    for run in &several.runs {
        let starts = Words { words: run.iter().map(|&n| several.words.words[n].clone()).collect() };
        let derivation = derive::derive(&job.plan, &starts, &[], options, backend)?;
        let derived = derive::collect_words(&job.plan, backend, &derivation, run.len())?;
        derivation.chunks.into_iter().for_each(|chunk| backend.recycle(chunk));
        for (&n, word) in run.iter().zip(derived) {
            words[n] = Some(word);
        }
        steps.push(derivation.steps);
        peak_bytes = peak_bytes.max(derivation.peak_bytes);
    }
    Ok((words.into_iter().flatten().collect(), together(&steps), peak_bytes))
}

/// Runs after each other as one: what has ended earlier keeps its modules.
fn together(runs: &[Vec<StepStats>]) -> Vec<StepStats> {
    let most = runs.iter().map(Vec::len).max().unwrap_or(0);
    let step = |n: usize| StepStats {
        modules: runs.iter().filter_map(|run| run.get(n).or(run.last())).map(|step| step.modules).sum(),
        time: runs.iter().filter_map(|run| run.get(n)).map(|step| step.time).sum(),
    };
    (0..most).map(step).collect()
}

struct Derived {
    words: Vec<Word>,
    backend: &'static str,
    adapter: String,
    compile_ms: f64,
    steps: Vec<StepStats>,
    peak_bytes: u64,
}

impl Derived {
    fn stats(&self, several: bool, start: Instant) -> serde_json::Value {
        let step =
            |s: &StepStats| serde_json::json!({ "modules": s.modules, "ms": s.time.as_secs_f64() * 1e3 });
        let mut stats = serde_json::json!({
            "backend": self.backend,
            "adapter": self.adapter,
            "compile_ms": self.compile_ms,
            "steps": self.steps.iter().map(step).collect::<Vec<_>>(),
            "total_ms": milliseconds(start),
            "peak_bytes": self.peak_bytes,
        });
        if several {
            stats["words"] = self.words.len().into();
        }
        stats
    }
}

fn derive(
    flags: &flags::Run,
    job: &Job,
    several: Option<&Several>,
    options: &Options,
) -> Result<Derived, Failure> {
    match run::device(flags.backend, &flags.derive.machine)? {
        #[cfg(feature = "gpu")]
        Some(device) => on_gpu(job, several, options, &device),
        #[cfg(not(feature = "gpu"))]
        Some(device) => match device {},
        None => on_cpu(job, several, options, flags.derive.machine.threads as usize),
    }
}

#[cfg(feature = "gpu")]
fn on_gpu(
    job: &Job,
    several: Option<&Several>,
    options: &Options,
    device: &run::Device,
) -> Result<Derived, Failure> {
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
    let (words, steps, peak_bytes) = all(job, several, options, &mut gpu).map_err(failure)?;
    Ok(Derived { words, backend: "gpu", adapter: device.info.name.clone(), compile_ms, steps, peak_bytes })
}

fn on_cpu(
    job: &Job,
    several: Option<&Several>,
    options: &Options,
    threads: usize,
) -> Result<Derived, Failure> {
    let mut cpu = run::cpu(job, threads)?;
    let (words, steps, peak_bytes) = all(job, several, options, &mut cpu).map_err(|e| job.failure(e))?;
    Ok(Derived { words, backend: "cpu", adapter: "CPU".to_string(), compile_ms: 0.0, steps, peak_bytes })
}
