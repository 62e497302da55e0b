//! Curve systems: words of symbols and points with neighbours, which may branch.

use super::WordKind;
use crate::curve;
use crate::language::eval;
use crate::language::expr::Value;
use crate::language::system::{self, CurveStart, Hang, Kind, Rule, Successor, System, Topology};
use crate::plan::collect::{Collected, symbols, whole, words_of};
use crate::plan::columns::{Content, Domain};
use crate::plan::derive::Options;
use crate::plan::layout::{self, CurveHeader, LATERAL, Layout, NONE};
use crate::plan::program::{Call, Over, Program, Work};
use crate::plan::start::Start;
use crate::plan::step::{Column, Pass};
use crate::plan::supported::{MOST_CELLS, MOST_STRICT, Unsupported};
use crate::plan::tables::{Becomes, Builder, Resolve, RulesOf, Stage, draws, ends_apart, successor};
use crate::plan::{Error, Plan, Settings};
use crate::word::Params;

/// See [`WordKind`].
#[derive(Debug)]
pub struct Curve;

impl WordKind for Curve {
    fn name(&self) -> &'static str {
        "curve"
    }

    fn supports(&self, rule: &Rule, system: &System) -> Result<(), Unsupported> {
        if let Some(query) = rule.queries.iter().find(|q| system.queries[q.query].value.is_none()) {
            return Err(Unsupported::new("queries that are bound to roots, in curve systems", query.span));
        }
        if rule.strict.len() > MOST_STRICT {
            let what = format!("more than {MOST_STRICT} strict predecessors");
            return Err(Unsupported::new(what, rule.span));
        }
        for alternative in &rule.alternatives {
            if let Successor::Word(word) = &alternative.successor
                && word.modules.len() > MOST_CELLS
            {
                let what = format!("a successor of more than {MOST_CELLS} modules");
                return Err(Unsupported::new(what, alternative.span));
            }
        }
        Ok(())
    }

    fn layout(
        &self,
        system: &System,
        rules: &[RulesOf],
        param_words: usize,
        several: bool,
    ) -> Result<Layout, Unsupported> {
        let tree = system.kind == Kind::Curve(Topology::Tree);
        // A word in which the turtle moves without drawing becomes several curves.
        let moves = system.symbols.iter().any(|s| s.name == "f");
        let traces = rules.iter().any(|of| matches!(of, RulesOf::Trace(_)));
        let links = tree || several || !system.ignored.is_empty() || moves && traces;
        if let (true, Some(span)) = (several, ends_apart(system)) {
            let what = "`until terminal` beside random numbers or `step`, in several words at once";
            return Err(Unsupported::new(what, span));
        }
        let ring = system.kind == Kind::Curve(Topology::Ring);
        let has = CurveHeader { paths: draws(system), links, words: several, ring };
        Ok(Layout::of_curve(param_words, has))
    }

    fn retires(&self) -> bool {
        false
    }

    fn becomes(&self, _: &mut Builder, _: usize, written: &Successor, resolve: Resolve) -> Becomes {
        // What else there is has been refused.
        let Successor::Word(word) = written else { return Becomes::nothing() };
        let modules = word.modules.iter().zip(&word.hangs);
        Becomes::Word {
            modules: modules.map(|(m, &hang)| successor(m, resolve).hanging(hang)).collect(),
            exit: word.exit(),
            relabels: matches!(word.hangs[..], [Hang { lateral: false, .. }]) && word.slots == 1,
        }
    }

    fn program(&self, stage: &Stage, layout: &Layout, ignoring: bool) -> Program {
        let linked = layout.link.is_some();
        let turtle =
            stage.row.turtle.then(|| if linked { turtle_linked() } else { Work::scan(Pass::Turtle) });
        let join = Work::new(Pass::Join, vec![Call::once(Pass::Join.row().entries, Over::Group)]);
        let joining: Vec<Work> = (layout.halo() > 0).then_some(join).into_iter().collect();
        let children = Call::once(Pass::EmitWord.row().entries, Over::Children);
        let emit = reading_links(Work::new(Pass::EmitWord, vec![children]), linked);
        if stage.closed.is_some() {
            let writing = turtle.into_iter().chain([emit]).collect();
            return Program { joining, writing, ..Program::default() };
        }
        let mut counting: Vec<Work> = turtle.into_iter().collect();
        if linked {
            counting.push(link(stage.sees_branches(), ignoring));
        }
        counting.push(reading_links(Work::each(Pass::Match), linked));
        if stage.claims() {
            counting.push(Work::scan(Pass::Claim));
        }
        counting.extend([Work::each(Pass::Count), Work::scan(Pass::Scan)]);
        if linked {
            counting.push(hang(stage.unhangs()));
        }
        Program { joining, counting, writing: vec![emit], retiring: Vec::new() }
    }

    fn first_symbols(&self, axiom: &system::Axiom) -> Vec<usize> {
        let system::Axiom::Curve(starts) = axiom else { return Vec::new() };
        let of_start = |start: &CurveStart| match start {
            CurveStart::Word(word) => word.modules.iter().map(|module| module.symbol).collect(),
            CurveStart::Points { symbol, .. } => vec![*symbol],
            CurveStart::System { .. } => Vec::new(),
        };
        starts.iter().flat_map(of_start).collect()
    }

    fn header(&self, layout: &Layout) -> Vec<&'static str> {
        let paths = layout.paths.then_some(["high word of the path", "low word of the path"]);
        let mut words = vec!["symbol"];
        words.extend(paths.into_iter().flatten());
        words.extend(layout.link.map(|_| "link"));
        words.extend(layout.word.map(|_| "word"));
        words
    }
}

const EACH: Over = Over::Each(Domain::Module);

/// Where the turtle stands: motions are composed along links, from one half of the columns to the other and back.
fn turtle_linked() -> Work {
    let calls = vec![
        Call::once(&["begin"], EACH),
        Call { entries: &["away", "back"], over: EACH, rounds: Some(0) },
        Call::once(&["turtle_linked"], EACH),
    ];
    Work::new(Pass::TurtleLinked, calls)
}

/// The links that contexts follow.
fn link(branches: bool, ignoring: bool) -> Work {
    let mut calls = vec![Call::once(&["start", "link"], EACH)];
    if branches {
        calls.push(Call::once(&["settle"], EACH));
    }
    if branches || ignoring {
        calls.push(Call { entries: &["jump"], over: EACH, rounds: Some(1) });
    }
    Work::new(Pass::Link, calls)
}

/// What children hang on.
fn hang(unhangs: bool) -> Work {
    let mut calls = vec![Call::once(&["unhang"], EACH)];
    if unhangs {
        calls.push(Call { entries: &["rehang"], over: EACH, rounds: Some(1) });
    }
    Work::new(Pass::Hang, calls)
}

/// The same pass, which in linked words reads links after all else.
fn reading_links(mut work: Work, linked: bool) -> Work {
    work.bindings.extend(linked.then_some((Column::Links, false)));
    work
}

impl Start for curve::Words {
    type Word = Vec<curve::Word>;

    fn content(&self, plan: &Plan, _: &Settings, each: &[Settings]) -> Result<Content, Error> {
        let Layout { link: Some(link), word: Some(word), record_words, .. } = plan.tables.layout else {
            return Err(Error::Axiom("several words need a plan of words: Plan::of_words".to_string()));
        };
        let mut records: Vec<u32> = Vec::new();
        for (n, (start, values)) in self.words.iter().zip(each).enumerate() {
            let first = (records.len() / record_words) as u32;
            let at = records.len();
            records.extend(plan.curve_axiom(&start.axiom, &values.uniforms)?);
            for record in records[at..].chunks_exact_mut(record_words) {
                record[word] = n as u32;
                if record[link] & NONE != NONE {
                    record[link] += first;
                }
            }
        }
        Ok(Content::of_records(records))
    }
    fn roots(&self) -> usize {
        self.words.iter().map(|start| start.axiom.len()).sum()
    }
    fn reads_params(&self) -> bool {
        self.words.iter().any(|start| start.axiom.reads_params())
    }
    fn each(&self, plan: &Plan, options: &Options) -> Result<Vec<Settings>, Error> {
        let values = |start: &curve::Start| {
            let seed = start.seed.or(options.seed);
            match options.set.as_slice() {
                [] => plan.settings(&start.set, seed),
                // Of two values of a param the last holds.
                shared => plan.settings(&[shared, &start.set].concat(), seed),
            }
        };
        self.words.iter().map(values).collect()
    }
}

impl Start for curve::Axiom {
    type Word = curve::Word;

    fn content(&self, plan: &Plan, values: &Settings, _: &[Settings]) -> Result<Content, Error> {
        if plan.tables.layout.word.is_some() {
            return Err(Error::Axiom("a plan of words takes several of them: curve::Words".to_string()));
        }
        Ok(Content::of_records(plan.curve_axiom(self, &values.uniforms)?))
    }
    fn roots(&self) -> usize {
        self.len()
    }
    fn reads_params(&self) -> bool {
        self.parts
            .iter()
            .any(|part| part.shift.is_some() || part.modules.iter().any(|module| !module.args.is_empty()))
    }
}

impl Plan {
    /// The word of a curve's axiom as records.
    ///
    /// # Errors
    /// [`Error::Value`] for an argument without a value, or a float that is not finite; [`Error::Axiom`] for a part
    /// without a module.
    pub fn curve_axiom(&self, axiom: &curve::Axiom, uniforms: &[Value]) -> Result<Vec<u32>, Error> {
        let layout = &self.tables.layout;
        if layout.net.is_some() {
            let message = format!("{} is a patch system, and begins with nets, not points", self.system.name);
            return Err(Error::Axiom(message));
        }
        if axiom.is_empty() {
            return Err(Error::Axiom(format!("the axiom of {} has no module", self.system.name)));
        }
        let mut records = Vec::with_capacity(axiom.len() * layout.record_words);
        // What the next part hangs on.
        let mut axis = layout::NONE;
        for part in &axiom.parts {
            let n = part.modules.len();
            let first = (records.len() / layout.record_words) as u32;
            let shift = match &part.shift {
                None => 0,
                Some(e) => match eval::eval(e, uniforms)
                    .map_err(|why| Error::Value(format!("shift: {why}"), Some(e.span)))?
                {
                    Value::Int(by) if n > 0 => (by as i64).rem_euclid(n as i64) as usize,
                    _ => 0,
                },
            };
            for (at, root) in part.modules.iter().cycle().skip(shift).take(n).enumerate() {
                let mut record = vec![0u32; layout.record_words];
                record[0] = root.symbol as u32;
                if layout.paths {
                    record[2] = (records.len() / layout.record_words) as u32;
                }
                if let Some(word) = layout.link {
                    // Only rings are shifted: each of their modules hangs on the one before.
                    let on = if shift > 0 { at.checked_sub(1) } else { root.hang.on };
                    let lateral = if root.hang.lateral { layout::LATERAL } else { 0 };
                    record[word] = on.map_or(axis, |on| first + on as u32) | lateral;
                }
                self.write_root(root.symbol, &root.args, uniforms, &mut record)?;
                records.extend(record);
            }
            axis = part.exit.map_or(axis, |exit| first + exit as u32);
        }
        if let (Some(word), true) = (layout.link, self.is_ring()) {
            records[word] = axis;
        }
        Ok(records)
    }
}

/// In their order; those of which nothing is left are empty.
impl Collected for Vec<curve::Word> {
    fn of(plan: &Plan, steps: u32, words: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        let layout = plan.tables.layout;
        let Some(at) = layout.word else { return Ok(vec![]) };
        let (mut all, mut first) = (vec![Vec::new(); words], vec![0; words]);
        for content in chunks {
            for (n, record) in content.records().chunks_exact(layout.record_words).enumerate() {
                let word = record[at] as usize;
                let Some(own) = all.get_mut(word) else {
                    let what = format!("module {n} is of no word: the device is not right");
                    return Err(Error::Value(what, None));
                };
                if own.is_empty() {
                    first[word] = n;
                }
                own.extend(record);
            }
        }
        all.iter().zip(first).map(|(records, first)| curve_word(plan, steps, records, first)).collect()
    }
}

impl Collected for curve::Word {
    fn of(plan: &Plan, steps: u32, _: usize, chunks: Vec<Content>) -> Result<Self, Error> {
        curve_word(plan, steps, whole(chunks).records(), 0)
    }
}

/// The word of these records, the first of which others hang on by the number `first`.
fn curve_word(plan: &Plan, steps: u32, records: &[u32], first: usize) -> Result<curve::Word, Error> {
    let layout = plan.tables.layout;
    let Kind::Curve(topology) = plan.system.kind else {
        return Err(Error::Axiom(format!("{} is no curve system", plan.system.name)));
    };
    let symbols = symbols(plan);
    let mut params = Params::new(&symbols);
    let module = |(at, record): (usize, &[u32])| {
        let symbol = (record[0] & 0xffff) as usize;
        let words = words_of(plan, symbol, at)?;
        let (parent, lateral) = match layout.link.map(|word| record[word]) {
            None => (at.checked_sub(1), false),
            Some(link) => {
                let parent = ((link & NONE) as usize).checked_sub(first);
                (parent.filter(|&parent| parent < at), link & LATERAL != 0)
            }
        };
        Ok(curve::Module {
            symbol,
            row: params.push_record(symbol, words, record),
            path: if layout.paths { u64::from(record[1]) << 32 | u64::from(record[2]) } else { 0 },
            parent,
            lateral,
        })
    };
    let modules = records.chunks_exact(layout.record_words).enumerate().map(module);
    let modules = modules.collect::<Result<_, Error>>()?;
    Ok(curve::Word { system: plan.system.name.clone(), steps, topology, symbols, modules, params })
}
