//! Frames that are read: for programs that want a mesh on the host, and for tests.

use super::buffers::{ALL, SLOT};
use super::slab::Section;
use super::{Capacity, Tessellator};
use crate::gpu::Error;
use crate::gpu::buffers as reading;
use crate::tessellate::lattice::Node;
use crate::tessellate::passes::{DrawArgs, Status};
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

    /// Reads a frame that was submitted, and waits for it: for the command and for tests.
    pub fn read(&self) -> Result<Frame, Error> {
        let e = &self.engine;
        let b = &self.buffers;
        let doing = "reading a tessellation";
        let status: Status = reading::read(e, doing, &b.status, size_of::<Status>() as u64)?[0];
        let ranges: Vec<u32> = reading::read(e, doing, &b.ranges, b.ranges.size())?;
        let of = |part: &Section, bytes: u64| reading::read_from(e, doing, &part.buffer, part.at, bytes);
        let draw: DrawArgs =
            bytemuck::pod_read_unaligned(bytemuck::cast_slice(&of(&b.draw, size_of::<DrawArgs>() as u64)?));
        let nodes = u64::from(ranges[(u64::from(ALL) * SLOT / 4) as usize]).min(b.nodes.size() / 16);
        let indices = u64::from(draw.index_count).min(b.indices.bytes / 4);
        let vertices = match status.skipped {
            0 => u64::from(status.vertices) * self.format().stride(),
            _ => b.vertices.bytes,
        };
        let (section, now) = (b.section_bytes() as usize / 4, 1 - self.turn);
        let offsets: Vec<u32> = reading::read(e, doing, &b.offsets, b.offsets.size())?;
        let vertices = if self.format().separate { b.vertices.bytes } else { vertices };
        Ok(Frame {
            status,
            draw,
            nodes: reading::read(e, doing, &b.nodes, nodes * 16)?,
            children: reading::read(e, doing, &b.children[now], nodes * 4)?,
            marks: reading::read(e, doing, &b.marks, nodes * 4)?,
            offsets: offsets[..=nodes as usize].to_vec(),
            triangle_offsets: offsets[section..=section + nodes as usize].to_vec(),
            vertices: of(&b.vertices, vertices.min(b.vertices.bytes))?,
            indices: of(&b.indices, indices * 4)?,
            cells: reading::read(e, doing, &b.cells, indices / 3 * 4)?,
        })
    }
}

/// A frame, read back.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub status: Status,
    pub draw: DrawArgs,
    pub nodes: Vec<Node>,
    pub children: Vec<u32>,
    pub marks: Vec<u32>,
    pub offsets: Vec<u32>,
    pub triangle_offsets: Vec<u32>,
    pub vertices: Vec<u32>,
    pub indices: Vec<u32>,
    pub cells: Vec<u32>,
}
