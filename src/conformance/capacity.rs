//! Buffers that are too small: what fits is written, nothing behind it, and what was needed is said.

use super::systems::{Job, Nets, TUNINGS};
use super::{Case, Compared, Trouble, check};
use crate::cpu::Cpu;
use crate::gpu::{self, Engine, Gpu};
use crate::plan::columns::{Content, Stored};
use crate::plan::compare::Traced;
use crate::plan::derive::{Backend, Outcome, StageId};
use crate::plan::step::Clock;

/// Splits, a part of a split, ε, modules that stay, and modules that are retired.
pub const UNEVEN: &str = include_str!("systems/uneven.burgeon");
/// Full splits, as a closed form.
pub const CLOSED: &str = include_str!("systems/closed.burgeon");

/// What stands in a chunk before anything is written.
const UNTOUCHED: (u32, f32) = (0xdead_beef, -77.25);

/// More than the exact size, so that something stands behind it.
const BEHIND: usize = 5;

const STAGE: StageId = StageId { rule_set: 0, stage: 0 };

/// A step into buffers of a given capacity, on a chunk whose exact result is known.
struct Filling<'a> {
    job: &'a Job,
    /// What comes when there is room: the new chunk and the finished one.
    exact: [Content; 2],
    /// Where the children of each module begin, and their number.
    offsets: Vec<u32>,
}

impl Filling<'_> {
    fn new(job: &Job) -> Result<Filling<'_>, Trouble> {
        let mut cpu = Cpu::new(&job.plan, 1)?;
        cpu.set_traced();
        let chunk = cpu.upload(job.plan.axiom(&job.axiom, &job.uniforms)?)?;
        let outcome = cpu.step(STAGE, Clock::default(), &chunk, u64::MAX)?;
        let Outcome::Done { next, retired, .. } = outcome else { return Err(Trouble::Stopped) };
        let mut offsets = cpu.trace().offsets.clone();
        if let Some(growth) = STAGE.of(&job.plan).closed {
            offsets = (0..=cpu.len(&chunk) as u32).map(|i| i * growth).collect();
        }
        let mut read = |chunk: Option<_>| chunk.map_or(Ok(Content::default()), |c| cpu.read(&c));
        Ok(Filling { job, exact: [read(next)?, read(retired.map(|r| r.0))?], offsets })
    }

    fn needed(&self) -> [usize; 2] {
        [0, 1].map(|n| self.job.plan.tables.layout.modules(&self.exact[n]))
    }

    /// Steps with these capacities; looks at what was said and what was written.
    fn compare(&self, gpu: &mut Gpu, capacity: [usize; 2]) -> Result<Compared, Trouble> {
        let layout = self.job.plan.tables.layout;
        let chunk = gpu.upload(self.job.plan.axiom(&self.job.axiom, &self.job.uniforms)?)?;
        let needed = self.needed();
        let mut target = |n: usize| {
            let modules = needed[n] + BEHIND;
            let (word, float) = UNTOUCHED;
            let records = vec![word; modules * layout.record_words];
            gpu.upload(Content::of_nets(records, vec![[float; 4]; modules * layout.net_points()]))
        };
        let targets = [target(0)?, target(1)?];
        let [next, finished] = [0, 1].map(|n| (&targets[n], capacity[n]));
        let said = match gpu.step_into(STAGE, Clock::default(), &chunk, next, finished) {
            Ok(()) => None,
            Err(gpu::Error::Capacity { buffer, needed, capacity }) => Some((buffer, needed, capacity)),
            Err(e) => return Err(e.into()),
        };
        let wrong = |what: String| Trouble::Differs(format!("{needed:?} modules into {capacity:?}: {what}"));
        let short = (0..2).find(|&n| capacity[n] < needed[n]);
        let buffers = ["the new chunk", "the finished chunk"];
        let right = short.map(|n| (buffers[n], needed[n] as u64, capacity[n] as u64));
        if said != right {
            return Err(wrong(format!("{said:?} was said to be too small, and {right:?} is")));
        }
        // All children of a module or none: emit writes up to the last module that fits whole.
        let fit = |room: usize| *self.offsets.iter().rfind(|&&o| o as usize <= room).unwrap_or(&0) as usize;
        let written = [fit(capacity[0]), capacity[1].min(needed[1])];
        let mut values = 0;
        for (n, pass) in ["emit", "retire"].into_iter().enumerate() {
            let got = gpu.read(&targets[n])?;
            values += Stored::ALL.iter().map(|&column| got[column].len() as u64).sum::<u64>();
            self.written(&got, n, written[n]).map_err(|what| wrong(format!("{pass}, {what}")))?;
        }
        gpu.recycle(chunk);
        targets.into_iter().for_each(|t| gpu.recycle(t));
        Ok(Compared { runs: 1, passes: 2, values, rounding: 0.0 })
    }

    /// So many modules must stand there, and behind them what stood there before.
    fn written(&self, got: &Content, n: usize, modules: usize) -> Result<(), String> {
        let layout = self.job.plan.tables.layout;
        let exact = &self.exact[n];
        let untouched = |column| match column {
            Stored::Records => UNTOUCHED.0,
            Stored::Nets => UNTOUCHED.1.to_bits(),
        };
        for column in layout.columns() {
            let (words, name) = (layout.shape(column).words, column.name());
            let (got, end) = (&got[column], modules * words);
            if let Some(at) = (0..end).find(|&i| got[i] != exact[column][i]) {
                return Err(format!("the {name} of module {}", at / words));
            }
            if let Some(at) = (end..got.len()).find(|&i| got[i] != untouched(column)) {
                return Err(format!("after the end: the {name} of module {}", at / words));
            }
        }
        Ok(())
    }
}

/// A step of this system into buffers with just enough room, with more, and with less.
pub fn compare(engine: &Engine, job: &Job) -> Result<Compared, Trouble> {
    let filling = Filling::new(job)?;
    let [new, finished] = filling.needed();
    let mut gpu = Gpu::new(engine, &job.plan)?;
    let mut all = Compared::default();
    let mut step = |capacity| filling.compare(&mut gpu, capacity).map(|c| all.add(c));
    step([new, finished])?;
    step([new + BEHIND, finished + BEHIND])?;
    for short in [1, 2, 3, 4, 5, new / 2, new] {
        step([new - short, finished])?;
    }
    if finished > 0 {
        for short in [1, finished] {
            step([new, finished - short])?;
            step([new - 1, finished - short])?;
        }
    }
    Ok(all)
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name: &str, text: &'static str, roots: usize| {
        Case::new(name, move |engine, stop| {
            let job = match Job::new(text, Nets::Lattice(roots)) {
                Ok(job) => job,
                Err(e) => panic!("{e}"),
            };
            let mut all = Compared::default();
            for tuning in &TUNINGS[..2] {
                check(stop)?;
                all.add(compare(&engine.retuned(*tuning), &job).map_err(|e| e.with(tuning))?);
            }
            Ok(all)
        })
    };
    vec![case("buffers too small, closed form", CLOSED, 9), case("buffers too small, uneven", UNEVEN, 3)]
}
