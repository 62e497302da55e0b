//! Where a turtle starts, for words of which nothing is left when they are traced.

use super::super::kernels::{Binding, Bound, Kernel};
use super::super::{Engine, Error, buffers, warm};
use super::buffers::{Buffers, PLACES};
use crate::codegen;
use crate::language::Span;
use crate::plan::columns::Stored;
use crate::plan::tables::RulesOf;
use crate::plan::{Plan, Unsupported, turtle};

/// The points at which turtles start, one for each rule set that traces, and the kernel that writes one.
pub(super) struct Starts {
    kernel: Option<Kernel>,
    /// With their rule sets.
    records: Vec<(usize, wgpu::Buffer)>,
}

/// For each of [`Starts`] what its kernel is bound to, into each place.
pub(super) type StartGroups = Vec<[wgpu::BindGroup; PLACES]>;

impl Starts {
    pub fn new(engine: &Engine, plan: &Plan) -> Result<Starts, Error> {
        let tables = &plan.tables;
        let mut records = Vec::new();
        for (rule_set, set) in tables.rule_sets.iter().enumerate() {
            let RulesOf::Trace(into) = set.of else { continue };
            if tables.layout.word.is_some() && turtle::may_be_empty(plan) {
                let span = trace_of(plan);
                let what = "a recorded trace of several words at once, where rules may leave nothing of one";
                return Err(Error::Plan(Unsupported::new(what, span).into()));
            }
            let start = turtle::start(plan, into);
            records.push((rule_set, buffers::uniform(engine, "burgeon start", &start)?));
        }
        let kernel = match records.is_empty() {
            true => None,
            false => {
                let shader = codegen::start_word_edited(&tables.layout, engine.edit.as_ref())?;
                let bound = [Bound::Uniform, Bound::Written];
                Some(Kernel::with_bindings(engine, &shader, &bound, &["start_word"]))
            }
        };
        Ok(Starts { kernel, records })
    }

    pub fn groups(&self, engine: &Engine, b: &Buffers) -> StartGroups {
        let Some(kernel) = &self.kernel else { return Vec::new() };
        let into = |record: &wgpu::Buffer, place: usize| {
            let next = b.places[place][Stored::Records as usize].as_ref().unwrap_or(&b.progress);
            kernel.bind(engine, &[Binding::whole(record), Binding::whole(next)])
        };
        self.records.iter().map(|(_, record)| [0, 1, 2].map(|place| into(record, place))).collect()
    }

    /// Before a sweep into this place.
    pub fn record(&self, pass: &mut wgpu::ComputePass, groups: &StartGroups, rule_set: usize, place: usize) {
        let at = self.records.iter().position(|(of, _)| *of == rule_set);
        if let (Some(kernel), Some(at)) = (&self.kernel, at) {
            pass.set_bind_group(0, &groups[at][place], &[]);
            pass.set_pipeline(&kernel.pipelines[0]);
            pass.dispatch_workgroups(1, 1, 1);
        }
    }

    pub fn idle(&self, pass: &mut wgpu::ComputePass, groups: &StartGroups) {
        if let (Some(kernel), Some([group, ..])) = (&self.kernel, groups.first()) {
            warm::idle(pass, kernel, group);
        }
    }
}

/// The place of the first trace of the schedule.
fn trace_of(plan: &Plan) -> Span {
    use crate::language::system::{Step, StepKind};
    fn first(steps: &[Step]) -> Option<Span> {
        steps.iter().find_map(|step| match &step.kind {
            StepKind::Trace { .. } => Some(step.span),
            StepKind::Repeat { body, .. } | StepKind::If { body, .. } => first(body),
            _ => None,
        })
    }
    first(&plan.system.run).unwrap_or(plan.system.source.kind_span)
}
