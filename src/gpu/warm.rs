//! Kernels that the driver has compiled before they are wanted.
//!
//! A pipeline may be a promise: some drivers, Mesa's software drivers among them, compile its kernel when it is first
//! dispatched, and the frame that dispatches it waits for that. So a frame is run and thrown away, with the uniforms that
//! the next ones have, since such a driver may compile for their values; and what it does not dispatch is dispatched
//! over no workgroups.

use super::kernels::Kernel;
use super::{Engine, Error};

/// Submits what `record` records, and waits for it.
pub(super) fn warm(engine: &Engine, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<(), Error> {
    let doing = "having the driver compile kernels";
    engine.checked(doing, || {
        let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon warm-up") };
        let mut encoder = engine.device.create_command_encoder(&label);
        record(&mut encoder);
        engine.queue.submit([encoder.finish()]);
        match engine.device.poll(wgpu::PollType::wait_indefinitely()) {
            // What is submitted to a lost device is done at once.
            Ok(_) if !engine.is_lost() => Ok(()),
            _ => Err(Error::Lost { doing }),
        }
    })
}

/// Dispatches all of a kernel's pipelines over no workgroups.
pub(super) fn idle(pass: &mut wgpu::ComputePass, kernel: &Kernel, group: &wgpu::BindGroup) {
    let offsets: &[u32] = if kernel.slotted { &[0] } else { &[] };
    pass.set_bind_group(0, group, offsets);
    for pipeline in &kernel.pipelines {
        pass.set_pipeline(pipeline);
        pass.dispatch_workgroups(0, 0, 0);
    }
}
