//! A tessellation made once and read: for programs that want a mesh on the host, not a frame.

use super::{Capacity, Frame, Tessellator};
use crate::gpu::Error;
use crate::gpu::buffers as reading;
use crate::tessellate::passes::Status;
use crate::tessellate::vertex::Format;
use crate::tessellate::word;
use crate::tessellate::{Complete, mesh_of};

impl Tessellator {
    /// Submits frames until one fits, making room for what the one before wanted, and reads it. What room there
    /// is at first is a guess that costs a frame each time it is too small. A frozen tessellation is thawed.
    ///
    /// # Errors
    /// [`Error::Format`] for vertices in another format than [`Format::default`]; [`Error::Binding`] when the
    /// triangles take more room than the device binds; what the device says.
    pub fn complete(&mut self) -> Result<Complete, Error> {
        if *self.format() != Format::default() {
            return Err(Error::Format);
        }
        self.freeze(false);
        // A frame that does not fit wants more of something than there is, so the room grows each time and
        // the device's limits end this.
        loop {
            self.submit()?;
            let status = self.read_status()?;
            if status.complete() {
                break;
            }
            if status.too_deep != 0 {
                return Err(word::Error::Halvings.into());
            }
            self.set_capacity(&Capacity::grown(&status))?;
        }
        let frame = self.read()?;
        let mesh = mesh_of(&frame.vertices, frame.indices);
        Ok(Complete::new(mesh, &frame.nodes, &frame.cells, frame.status))
    }

    /// Submits a frame, waits for it and reads it, whether or not it fitted.
    ///
    /// # Errors
    /// What the device says.
    pub fn frame(&mut self) -> Result<Frame, Error> {
        self.submit()?;
        self.read()
    }

    fn submit(&mut self) -> Result<(), Error> {
        let engine = self.engine.clone();
        engine.checked("tessellating", || {
            let label = wgpu::CommandEncoderDescriptor { label: Some("burgeon tessellation") };
            let mut encoder = engine.device.create_command_encoder(&label);
            self.encode(&mut encoder);
            engine.queue.submit([encoder.finish()]);
            Ok(())
        })
    }

    /// Waits for what was submitted.
    fn read_status(&self) -> Result<Status, Error> {
        let bytes = size_of::<Status>() as u64;
        let read = reading::read(&self.engine, "reading a tessellation", &self.buffers.status, bytes)?;
        Ok(read.first().copied().unwrap_or_default())
    }
}
