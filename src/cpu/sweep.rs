//! One sweep on the CPU: the passes of a stage's [program](crate::plan::program) over a chunk.

use super::motion::Motion;
use super::program::Input;
use super::{Chunk, claim, compact, count, emit, emit_word, link, match_modules, measure, retire, scan};
use super::{turtle, turtle_linked};
use crate::plan::Plan;
use crate::plan::columns::Stored;
use crate::plan::compare::Trace;
use crate::plan::derive::StageId;
use crate::plan::given::Given;
use crate::plan::layout::Layout;
use crate::plan::links::Links;
use crate::plan::step::{Clock, Pass, Status};
use crate::plan::tables::{Stage, Tables};
use std::mem::take;

/// What goes from a chunk of a word to the next.
#[derive(Clone, Copy, Default)]
pub(super) struct Carried {
    /// Modules that a rule has claimed.
    pub claimed: u32,
    /// Modules of the new word so far.
    pub made: u32,
    /// Where the turtle stands.
    pub turtle: Motion,
}

/// Columns that live for one sweep, kept for the next.
#[derive(Default)]
pub(super) struct Columns {
    pub attributes: Vec<u32>,
    pub rules: Vec<u32>,
    pub counts: Vec<u32>,
    pub offsets: Vec<u32>,
    pub retired: Vec<u32>,
    /// What contexts see in a linked word.
    pub links: Links,
    /// What its children hang on.
    pub hangs: Vec<u32>,
}

impl Columns {
    fn clear(&mut self) {
        let Columns { attributes, rules, counts, offsets, retired, links: _, hangs } = self;
        [attributes, rules, counts, offsets, retired, hangs].into_iter().for_each(Vec::clear);
    }

    /// What the passes wrote, for comparison.
    pub fn trace(&self) -> Trace {
        Trace {
            attributes: self.attributes.clone(),
            rules: self.rules.clone(),
            counts: self.counts.clone(),
            offsets: self.offsets.clone(),
            retired: self.retired.clone(),
        }
    }
}

/// A sweep over a chunk: what its passes read, and what they write.
pub(super) struct Sweep<'c> {
    pub plan: &'c Plan,
    pub id: StageId,
    pub clock: Clock,
    pub chunk: &'c Chunk,
    pub environment: &'c [u32],
    pub given: &'c Given,
    pub threads: &'c rayon::ThreadPool,
    /// What another backend measured and matched, to be done again with it.
    pub replayed: Option<&'c Trace>,
    pub columns: &'c mut Columns,
    /// What the chunk before left for this one, and what this one leaves.
    pub entered: Carried,
    pub left: Carried,
    /// What the chunk says.
    pub status: Status,
    /// Where new and retired modules go.
    pub next: Option<Chunk>,
    pub finished: Option<Chunk>,
}

impl<'c> Sweep<'c> {
    fn stage(&self) -> &'c Stage {
        self.id.of(self.plan)
    }

    fn tables(&self) -> &'c Tables {
        &self.plan.tables
    }

    fn layout(&self) -> &'c Layout {
        &self.plan.tables.layout
    }

    fn nets(&self) -> &'c [[f32; 4]] {
        bytemuck::cast_slice(self.chunk.own(self.layout(), Stored::Nets))
    }

    fn input(&self) -> Input<'_> {
        let (layout, stage) = (self.layout(), self.stage());
        let records = self.chunk.own(layout, Stored::Records);
        Input {
            records,
            window: &self.chunk.columns[Stored::Records as usize],
            first: layout.halo(),
            behind: self.chunk.behind,
            layout: *layout,
            environment: self.environment,
            given: &self.given.words,
            measured: &self.columns.attributes,
            measured_words: stage.row.words,
            offsets: &self.columns.offsets,
            made: self.entered.made,
            clock: self.clock,
            linked: self.tables().linked(records, &self.columns.links),
            hangs: &self.columns.hangs,
        }
    }

    /// The passes that say what comes; returned are the modules that do, and those that are retired.
    pub fn count(&mut self) -> (usize, usize) {
        self.columns.clear();
        let stage = self.stage();
        stage.program.counting.iter().for_each(|work| self.run(work.pass));
        let n = self.chunk.len;
        let total = match stage.closed {
            Some(growth) => {
                self.status.fired = 1;
                n * growth as usize
            }
            None => self.columns.offsets[n] as usize,
        };
        self.left.made = self.entered.made.wrapping_add(total as u32);
        (total, self.columns.retired.len())
    }

    /// The passes that write it, where there is room for it now.
    pub fn write(&mut self) {
        let program = &self.stage().program;
        if self.next.is_some() {
            program.writing.iter().for_each(|work| self.run(work.pass));
        }
        if self.finished.is_some() {
            program.retiring.iter().for_each(|work| self.run(work.pass));
        }
    }

    /// One pass. It takes out the column that it fills, and puts it back.
    fn run(&mut self, pass: Pass) {
        let (stage, layout, tables, n) = (self.stage(), self.layout(), self.tables(), self.chunk.len);
        match pass {
            // Chunks are joined before any is rewritten: [`super::join`].
            Pass::Join => {}
            Pass::Measure | Pass::Turtle | Pass::TurtleLinked => {
                let mut attributes = take(&mut self.columns.attributes);
                match self.replayed {
                    Some(trace) => attributes.extend(&trace.attributes),
                    None => {
                        attributes.resize(n * stage.row.words, 0);
                        self.attributes(pass, &mut attributes);
                    }
                }
                self.columns.attributes = attributes;
            }
            Pass::Link => {
                let (records, branches) = (self.chunk.own(layout, Stored::Records), stage.sees_branches());
                link::link(layout, records, &tables.ignored, branches, &mut self.columns.links);
            }
            Pass::Match => {
                let mut rules = take(&mut self.columns.rules);
                rules.resize(n, 0);
                let (words, input) = (stage.rule_words(), self.input());
                let status = match self.replayed {
                    None => {
                        let matching = || match_modules::match_modules(stage, &words, &input, &mut rules);
                        self.threads.install(matching)
                    }
                    Some(trace) => {
                        rules.copy_from_slice(&trace.rules);
                        match_modules::status(stage, &words, &input, &rules)
                    }
                };
                (self.status, self.columns.rules) = (status, rules);
            }
            Pass::Claim => {
                let (words, claimed) = (stage.rule_words(), self.entered.claimed);
                self.left.claimed = claim::claim(&words, stage.retired(), claimed, &mut self.columns.rules);
            }
            Pass::Count => {
                let Columns { rules, counts, .. } = &mut *self.columns;
                counts.resize(n, 0);
                let words = stage.rule_words();
                self.threads.install(|| count::count(&words, rules, counts));
            }
            Pass::Scan => {
                let Columns { counts, offsets, .. } = &mut *self.columns;
                offsets.resize(n + 1, 0);
                self.threads.install(|| scan::scan(counts, offsets));
            }
            Pass::Hang => {
                let mut hangs = take(&mut self.columns.hangs);
                if let Some(word) = &self.input().linked {
                    let Columns { rules, offsets, .. } = &*self.columns;
                    link::rehang(word, &stage.rule_words(), rules, offsets, stage.roots, &mut hangs);
                }
                self.columns.hangs = hangs;
            }
            Pass::Compact => {
                let Columns { rules, retired, .. } = &mut *self.columns;
                self.threads.install(|| compact::compact(rules, stage.retired(), retired));
            }
            Pass::Emit | Pass::EmitWord => {
                let Some(mut next) = self.next.take() else { return };
                let (input, Columns { rules, offsets, .. }) = (self.input(), &*self.columns);
                if pass == Pass::EmitWord {
                    let out = next.own_mut(layout, Stored::Records);
                    emit_word::emit_word(self.threads, stage, &input, rules, offsets, out);
                } else {
                    let (len, [records, nets]) = (next.len, &mut next.columns);
                    let out = emit::Output {
                        records: &mut records[..len * layout.record_words],
                        nets: &mut bytemuck::cast_slice_mut(nets)[..len * layout.net_points()],
                    };
                    let fits = emit::emit(self.threads, stage, &input, self.nets(), rules, offsets, out);
                    self.status.too_deep |= u32::from(!fits);
                }
                self.next = Some(next);
            }
            Pass::Retire => {
                let Some(mut finished) = self.finished.take() else { return };
                let [records, nets] = &mut finished.columns;
                let (input, out) = (self.input(), bytemuck::cast_slice_mut(nets));
                let retired = &self.columns.retired;
                self.threads.install(|| retire::retire(&input, self.nets(), retired, records, out));
                self.finished = Some(finished);
            }
        }
    }

    /// The attributes that rules read of modules, a row each.
    fn attributes(&mut self, pass: Pass, out: &mut [u32]) {
        let (stage, layout, turtle) = (self.stage(), self.layout(), &self.tables().turtle);
        let records = self.chunk.own(layout, Stored::Records);
        match pass {
            Pass::TurtleLinked => turtle_linked::turtle_linked(turtle, layout, records, out),
            Pass::Turtle => {
                let entered = self.entered.turtle;
                let trace = || turtle::turtle(turtle, layout, records, entered, out);
                self.left.turtle = self.threads.install(trace);
            }
            _ => {
                let (input, nets, rational) = (self.input(), self.nets(), self.plan.rational());
                let view = self.tables().given.view();
                let measure = || measure::measure(&stage.row, &input, nets, rational, view, out);
                self.threads.install(measure);
            }
        }
    }
}
