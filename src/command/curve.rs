//! `burgeon run` of a curve system.

use super::load::{self, Job};
use super::output::{self, Format, Target, file};
use super::progress::Bar;
use super::run::{self, Work};
use super::source::Loaded;
use super::words::{self, Several};
use super::{Failure, counted, flags, kinds, stop};
use burgeon::curve::{Word, Words};
use burgeon::io;
use burgeon::io::curves::{self, Panel, Picture, Style};
use burgeon::language::expr::Type;
use burgeon::language::system::{Step, StepKind, Symbol};
use burgeon::language::{Diagnostic, Span};
use burgeon::plan::derive::{self, Backend, StepStats};
use burgeon::plan::{Options, Plan, Progress};
use std::path::Path;
use std::time::Instant;

/// What shows points; other formats hold any word.
const DRAWINGS: [Format; 3] = [Format::Svg, Format::Png, Format::Obj];

/// Derives and writes.
pub fn run(flags: &flags::Run, loaded: Loaded, start: Instant) -> Result<(), Failure> {
    let plan = loaded.plan(if flags.words.are_several() { Plan::of_words } else { Plan::new })?;
    kinds::check_run(flags, &loaded.system)?;
    let targets = output::targets(&flags.out, flags.format, &output::CURVES)?;
    let job = load::job(loaded, plan, &flags.derive, flags.words.each)?;
    job.say_notes();
    let several = flags.words.are_several().then(|| words::several(flags, &job)).transpose()?;
    let several = several.as_ref();
    stop::watch();
    let bar = Bar::new();
    let progress = |p: Progress| bar.step(p);
    let options = run::options(&flags.derive, &job, &progress);
    let derived = run::derive(flags, &job, &OfCurves { job: &job, several, options: &options }, &bar)?;
    let words = &derived.made;
    if let Some(target) = targets.iter().find(|target| DRAWINGS.contains(&target.format))
        && words.iter().any(has_no_point)
    {
        bar.clear();
        return Err(untraced(&job, &target.path));
    }
    let drawn = Drawn {
        control: if flags.control { control(&job, several)? } else { vec![Vec::new(); words.len()] },
        combinations: several.map_or(1, |several| several.combinations),
        columns: several.and_then(|several| several.columns),
        style: Style { points: flags.points, up: flags.drawing.up.into(), ..Style::default() },
    };
    let write = |target: &Target| write_all(target, several, words, &drawn, &bar);
    let failures = output::each(&targets, write)?;
    bar.clear();
    super::joined(failures)?;
    if targets.iter().any(|target| DRAWINGS.contains(&target.format))
        && words.iter().all(|word| word.modules.is_empty())
        && !may_hold_points(&job)
    {
        super::say("note: the word is empty, and was never traced: nothing is drawn");
    }
    if flags.stats {
        let mut stats = derived.stats(start);
        if several.is_some() {
            stats["words"] = words.len().into();
        }
        return output::report(&targets, &stats.to_string());
    }
    let steps = counted(derived.steps.len() as u64, "step");
    let modules = words.iter().map(|word| word.modules.len() as u64).sum();
    let modules = counted(modules, "module");
    let curves = several.map_or(String::new(), |_| format!("{}, ", counted(words.len() as u64, "curve")));
    output::report(&targets, &format!("{}: {steps}, {curves}{modules}", job.plan.system.name))
}

/// There are modules, and none of them stands anywhere.
fn has_no_point(word: &Word) -> bool {
    !word.modules.is_empty() && word.positions().all(|position| position.is_none())
}

/// Whether the run has a `trace`, or a module that holds a point: then what is drawn was not forgotten.
fn may_hold_points(job: &Job) -> bool {
    let system = &job.plan.system;
    trace(&system.run).is_some() || system.symbols.iter().any(is_point)
}

/// The first `trace` of a run.
fn trace(steps: &[Step]) -> Option<Span> {
    steps.iter().find_map(|step| match &step.kind {
        StepKind::Trace { .. } => Some(step.span),
        StepKind::Repeat { body, .. } | StepKind::If { body, .. } => trace(body),
        _ => None,
    })
}

fn is_point(symbol: &Symbol) -> bool {
    symbol.fields.iter().any(|f| matches!(f.ty, Type::Vec2 | Type::Vec3))
}

/// That a word of symbols alone is to be drawn.
fn untraced(job: &Job, path: &Path) -> Failure {
    let system = &job.plan.system;
    let message =
        format!("the word has no point that {} could show: it was never traced", output::shown(path));
    let last = system.run.last().map_or(system.source.name.span, |step| step.span);
    let error = Diagnostic::error("E0408", last, message);
    if let Some(trace) = trace(&system.run) {
        return job.error(error.label(trace, "the run did not come to this step"));
    }
    let hint = match system.symbols.iter().find(|symbol| is_point(symbol)) {
        Some(point) => format!("write `trace into {}` as the last step of `run:`", point.name),
        None => "write `trace into P` as the last step of `run:`, and declare the point: `module P(v: vec2)`"
            .into(),
    };
    job.error(error.hint(hint))
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
fn write_all(
    target: &Target,
    several: Option<&Several>,
    words: &[Word],
    drawn: &Drawn,
    bar: &Bar,
) -> Result<(), Failure> {
    let name = target.path.to_string_lossy();
    if several.is_none() || !name.contains("{}") {
        return write(target, several.map(|several| &several.words), words, drawn, bar);
    }
    let digits = (words.len() - 1).to_string().len();
    for (n, word) in words.iter().enumerate() {
        let target =
            Target { path: name.replace("{}", &format!("{n:0digits$}")).into(), format: target.format };
        let control = vec![drawn.control[n].clone()];
        let drawn = Drawn { control, combinations: 1, columns: None, style: drawn.style.clone() };
        write(&target, None, std::slice::from_ref(word), &drawn, bar)?;
    }
    Ok(())
}

fn write(
    target: &Target,
    several: Option<&Words>,
    words: &[Word],
    drawn: &Drawn,
    bar: &Bar,
) -> Result<(), Failure> {
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
    let path = &target.path;
    match target.format {
        Format::Svg => file(path, bar, |w| curves::svg::write(w, &picture()?)),
        Format::Png => file(path, bar, |w| io::png::write(w, &curves::raster::draw(&picture()?, pixels))),
        Format::Obj => file(path, bar, |w| io::obj::write_lines(w, &all)),
        Format::Csv => file(path, bar, |w| curves::csv::write(w, &all)),
        Format::Json => file(path, bar, |w| match several {
            Some(starts) => curves::json::write_words(w, starts, words),
            None => words.iter().try_for_each(|word| curves::json::write(w, word)),
        }),
        Format::Bpt | Format::Bv | Format::Ply | Format::Glb | Format::Stl => {
            Err(output::CURVES.refuse(target.format))
        }
    }
}

/// What the words begin with.
fn control(job: &Job, several: Option<&Several>) -> Result<Vec<Vec<curves::Line>>, Failure> {
    let none = Options { steps: Some(0), set: job.set.clone(), ..Options::default() };
    let mut cpu = run::cpu(job, 1)?;
    let work = OfCurves { job, several, options: &none };
    let (words, ..) = work.run(&mut cpu).map_err(|e| job.failure(e))?;
    Ok(words.iter().map(curves::lines).collect())
}

/// All words of a job.
struct OfCurves<'a> {
    job: &'a Job,
    several: Option<&'a Several>,
    options: &'a Options<'a>,
}

impl Work for OfCurves<'_> {
    type Made = Vec<Word>;

    /// The steps of all together, and the most bytes that one run took.
    fn run<B: Backend>(&self, backend: &mut B) -> Result<(Vec<Word>, Vec<StepStats>, u64), B::Error> {
        let Some(several) = self.several else {
            let derivation = derive::derive(self.job.axiom.curve()?, self.options, backend)?;
            let word = derive::collect(backend, &derivation)?;
            return Ok((vec![word], derivation.steps, derivation.peak_bytes));
        };
        let mut words: Vec<Option<Word>> = vec![None; several.words.words.len()];
        let (mut steps, mut peak_bytes) = (Vec::new(), 0);
        for run in &several.runs {
            let starts = Words { words: run.iter().map(|&n| several.words.words[n].clone()).collect() };
            let derivation = derive::derive(&starts, self.options, backend)?;
            let derived = derive::collect(backend, &derivation)?;
            derivation.chunks.into_iter().for_each(|chunk| backend.recycle(chunk));
            for (&n, word) in run.iter().zip(derived) {
                words[n] = Some(word);
            }
            steps.push(derivation.steps);
            peak_bytes = peak_bytes.max(derivation.peak_bytes);
        }
        Ok((words.into_iter().flatten().collect(), together(&steps), peak_bytes))
    }
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
