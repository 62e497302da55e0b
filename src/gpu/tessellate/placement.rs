//! A tessellation displaced by the placement of a plan.

use super::super::buffers as making;
use super::super::{Engine, Error};
use super::Tessellator;
use super::kernels::Kernels;
use crate::codegen;
use crate::language::Value;
use crate::plan::{self, Displacement, Plan};

impl Tessellator {
    /// Displaces the vertices of the frames to come by the placement that ends the plan's run, with the params,
    /// queries, view and seed of the options; not at all where it has none. What is split is still decided on the
    /// smooth surface. The kernel of the vertices is made anew, so this is for the beginning: params change by
    /// [`Tessellator::set_params`].
    ///
    /// # Errors
    /// [`Error::Plan`] for options that do not fit the plan, as [`Plan::uniforms`] and
    /// [`Given::new`](plan::Given::new) say; [`Error::Binding`] for values of queries, and [`Error::Uniforms`]
    /// for consts, that the device cannot bind;
    /// what the device says. Then all is as before.
    pub fn displace(&mut self, plan: &Plan, options: &plan::Options) -> Result<(), Error> {
        let displacement = Displacement::new(plan, self.topology.roots(), options)?;
        let engine = self.engine.clone();
        engine.checked("preparing a placement", || {
            // First, since some drivers refuse a kernel of more than they bind.
            let [topology, environment] = buffers(&engine, self.topology.words(), displacement.as_ref())?;
            let placement = displacement.as_ref().map(|d| &d.placement);
            let shader = codegen::vertices(&self.what, placement, engine.tuning(), engine.edit.as_ref())?;
            let kernel = Kernels::vertices(&engine, &shader);
            (self.buffers.topology, self.buffers.environment) = (topology, environment);
            self.kernels.vertices = kernel;
            self.groups = [0, 1].map(|now| self.kernels.groups(&engine, &self.buffers, now));
            self.displacement = displacement;
            self.bind_rules();
            Ok(())
        })
    }

    /// Other values of some params of the placement; the others stay.
    pub(super) fn set_placement(&mut self, set: &[(String, Value)]) -> Result<(), Error> {
        let Some(displacement) = &mut self.displacement else { return Ok(()) };
        displacement.set_params(set)?;
        let environment = displacement.environment(self.topology.words().len() as u32);
        let (queue, buffer) = (&self.engine.queue, &self.buffers.environment);
        queue.write_buffer(buffer, 0, bytemuck::cast_slice(&environment));
        Ok(())
    }
}

/// The topology with the values of queries behind it, and the environment.
fn buffers(
    engine: &Engine,
    topology: &[u32],
    displacement: Option<&Displacement>,
) -> Result<[wgpu::Buffer; 2], Error> {
    let environment = displacement.map_or(vec![0; 4], |d| d.environment(topology.len() as u32));
    let given = displacement.map_or(&[][..], |d| &d.given.words);
    let environment = making::uniform(engine, "burgeon environment of the placement", &environment)?;
    let words = [topology, given].concat();
    let both = making::storage(engine, "burgeon topology", 4 * words.len() as u64)?;
    engine.queue.write_buffer(&both, 0, bytemuck::cast_slice(&words));
    Ok([both, environment])
}
