//! Rules that are derived with each frame, in front of the trees.

use super::super::run::{self, Run};
use super::super::{Engine, Error};
use super::buffers::Derived;
use super::kernels::DerivedGroups;
use super::{Capacity, Tessellator};
use crate::language::expr::Value;
use crate::language::system::System;
use crate::patch::{Axiom, Net, Values};
use crate::plan::{self, Plan, Stored, View, placement};
use crate::tessellate::lattice::NOWHERE;
use crate::tessellate::word::MOST_SHAPES;
use crate::tessellate::{Level, Options, Topology};

/// A derivation that comes before the trees of a frame, and what its word is bound to.
pub(super) struct Rules {
    pub run: Run,
    pub groups: Option<DerivedGroups>,
}

/// Rules, where they begin, and with what.
#[derive(Clone, Copy)]
pub(super) struct Rewriting<'a> {
    pub plan: &'a Plan,
    pub axiom: &'a Axiom,
    pub options: &'a run::Options,
}

impl<'a> Rewriting<'a> {
    pub fn of(run: &'a Run) -> Rewriting<'a> {
        Rewriting { plan: run.plan(), axiom: run.start(), options: run.options() }
    }

    fn of_a_plan(&self) -> plan::Options<'static> {
        let run::Options { set, bind, view, seed } = self.options.clone();
        plan::Options { set, bind, view, seed, ..plan::Options::default() }
    }

    pub fn derived(&self, modules: u32) -> Derived {
        let layout = &self.plan.tables.layout;
        Derived {
            quads: layout.record_words as u32 / 4,
            // A system that keeps its holes has their symbol.
            hole: self.plan.hole.map_or(NOWHERE, |hole| hole as u32),
            modules: modules.max(self.axiom.roots.len() as u32),
        }
    }
}

impl Tessellator {
    /// For the word that rules derive of an axiom, anew with each frame, displaced by the placement that ends their
    /// run, if one does: params, bound values, the view and the control points may change from frame to frame, and
    /// the cells of the surface with them. [`Capacity::modules`] is the room for the word.
    ///
    /// # Errors
    /// What [`Plan::new`] says of the system, [`Run::new`] of the axiom and the options, and
    /// [`Tessellator::new`] of the patches.
    pub fn of_rules(
        engine: &Engine,
        system: &System,
        axiom: &Axiom,
        run: &run::Options,
        level: &Level,
        options: &Options,
        capacity: &Capacity,
    ) -> Result<Tessellator, Error> {
        let plan = Plan::keeping_holes(system).map_err(crate::plan::Error::from)?;
        let nets: Vec<Net> = axiom.roots.iter().map(|root| root.net.clone()).collect();
        let topology = Topology::new(&nets)?;
        let rewriting = Rewriting { plan: &plan, axiom, options: run };
        let mut tessellator = Tessellator::with_start(
            engine,
            &nets,
            topology,
            vec![],
            Some(rewriting),
            level,
            options,
            capacity,
        )?;
        if plan.placement.is_some() {
            tessellator.displace(&plan, &rewriting.of_a_plan())?;
        }
        Ok(tessellator)
    }

    /// Binds the word to what may have been made anew.
    pub(super) fn bind_rules(&mut self) {
        if let Some(rules) = &mut self.rules {
            rules.groups = self.kernels.derived_groups(&self.engine, &self.buffers, &rules.run);
        }
    }

    /// The derivation that comes with each frame, if there is one.
    pub fn run(&self) -> Option<&Run> {
        self.rules.as_ref().map(|rules| &rules.run)
    }

    /// Other values of params of the rules and of the placement that displaces them: those named are replaced. They are
    /// written through the queue, for the next submission and all after it; nothing is compiled, and buffers are made
    /// only where the schedule of rules becomes longer than it ever was.
    ///
    /// # Errors
    /// [`Error::Plan`] as [`Plan::uniforms`], and for any param where there are neither rules nor a placement; then
    /// nothing has changed.
    pub fn set_params(&mut self, params: &[(String, Value)]) -> Result<(), Error> {
        if self.rules.is_none() && self.displacement.is_none() {
            return match params.first() {
                Some((name, _)) => Err(placement::nothing_to_set(name).into()),
                None => Ok(()),
            };
        }
        if self.rules.is_some() {
            self.change(|run| run.set(params))?;
        }
        // Of the same system, if there are both.
        self.set_placement(params)
    }

    /// Other values of a query without `=`, for the rules; a placement keeps those that it began with.
    ///
    /// # Errors
    /// As for [`Run::bind`], and [`Error::NoRules`]; then nothing has changed.
    pub fn bind(&mut self, query: &str, values: Values) -> Result<(), Error> {
        self.change(|run| run.bind(query, values))
    }

    /// What the rules see the screen's attributes through.
    ///
    /// # Errors
    /// What the device says, and [`Error::NoRules`].
    pub fn set_view(&mut self, view: View) -> Result<(), Error> {
        self.change(|run| run.set_view(view))
    }

    fn change(&mut self, change: impl FnOnce(&mut Run) -> Result<(), Error>) -> Result<(), Error> {
        let rules = self.rules.as_mut().ok_or(Error::NoRules)?;
        let rooms = rules.run.rooms();
        change(&mut rules.run)?;
        if rules.run.rooms() != rooms {
            self.bind_rules();
        }
        Ok(())
    }

    /// Other rules, from the next frame on; or an error, and those that are there go on. Kernels of the rules are
    /// compiled here. Where the axiom has the patches that it had, control points stay where they were moved to,
    /// and all buffers with what is drawn; else all but a [`Slab`](super::Slab) is made anew, and must be bound anew.
    ///
    /// # Errors
    /// As for [`Tessellator::of_rules`], and [`Error::NoRules`]; then nothing has changed.
    pub fn reload(&mut self, system: &System, axiom: &Axiom, run: &run::Options) -> Result<(), Error> {
        let rules = self.rules.as_ref().ok_or(Error::NoRules)?;
        let modules = rules.run.capacity();
        let engine = self.engine.clone();
        let old = &rules.run.start().roots;
        if axiom.roots.len() != old.len() || axiom.roots.iter().zip(old).any(|(a, b)| a.net != b.net) {
            let (level, options) = (self.level.clone(), self.what.options);
            let capacity = self.capacity();
            let mut new = Tessellator::of_rules(&engine, system, axiom, run, &level, &options, &capacity)?;
            if let Some(slab) = &self.buffers.slab {
                new.set_slab(slab, &capacity)?;
            }
            new.frozen = self.frozen;
            *self = new;
            return Ok(());
        }
        let plan = Plan::keeping_holes(system).map_err(crate::plan::Error::from)?;
        let rewriting = Rewriting { plan: &plan, axiom, options: run };
        let there = Some((Stored::Nets, &self.buffers.nets));
        let new = Run::with_column(&engine, &plan, axiom, run, modules, there)?;
        if plan.placement.is_some() || self.displacement.is_some() {
            self.displace(&plan, &rewriting.of_a_plan())?;
        }
        self.buffers.write_source(&engine, &rewriting.derived(modules));
        self.rules = Some(Rules { run: new, groups: None });
        self.bind_rules();
        Ok(())
    }

    /// The word, and its leaves as the nodes of the first level.
    pub(super) fn derive(&self, pass: &mut wgpu::ComputePass) {
        let Some(Rules { run, groups: Some(groups) }) = &self.rules else { return };
        let (Some(kernels), Some(words)) = (&self.kernels.derived, &self.buffers.words) else { return };
        run.record(pass);
        let (_, place) = run.column_places(Stored::Records);
        let (workgroups, at) = run.workgroups();
        pass.set_pipeline(&kernels.recall.pipelines[0]);
        pass.set_bind_group(0, &groups.recall[place], &[]);
        pass.dispatch_workgroups_indirect(workgroups, at);
        pass.set_pipeline(&kernels.adopt.pipelines[0]);
        pass.set_bind_group(0, &groups.adopt, &[]);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_bind_group(0, &groups.enter, &[0]);
        let [forget, enter, arrange] = [0, 1, 2].map(|n| &kernels.enter.pipelines[n]);
        let slots = words.slots.max(MOST_SHAPES as u32);
        let [x, y] = super::super::kernels::groups(u64::from(slots), self.engine.tuning().workgroup);
        pass.set_pipeline(forget);
        pass.dispatch_workgroups(x, y, 1);
        pass.set_pipeline(enter);
        pass.dispatch_workgroups_indirect(&self.buffers.dispatches, 0);
        pass.set_pipeline(arrange);
        pass.dispatch_workgroups(1, 1, 1);
    }
}
