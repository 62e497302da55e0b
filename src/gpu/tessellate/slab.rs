//! Output into buffers of the caller's: a range of vertices, of indices, and the arguments of one draw.

use super::super::kernels::Binding;
use super::super::{Engine, Error};
use crate::tessellate::passes::DrawArgs;
use crate::tessellate::vertex::Format;
use wgpu::BufferUsages;

/// Ranges of a caller's buffers: a renderer that keeps the meshes of many things in one buffer, and draws them
/// all with one call, gives each a slab. How many vertices and indices belong to it, from the first on, is
/// in the [`Capacity`](super::Capacity).
///
/// The buffers are bound as storage, so they want [`BufferUsages::STORAGE`] beside their own usage; what lies outside
/// of the ranges is not written. One buffer may hold both vertices and indices.
#[derive(Clone, Debug)]
pub struct Slab {
    pub vertices: wgpu::Buffer,
    /// In vertices of the format's stride; the draw's base vertex.
    pub first_vertex: u32,
    pub indices: wgpu::Buffer,
    /// In indices of 4 bytes; the draw's first index. The indices themselves count from the first vertex.
    pub first_index: u32,
    /// Of [`DrawArgs`] and, as [`BufferUsages::COPY_DST`], of the zeros that stand there until a frame has run.
    pub draws: wgpu::Buffer,
    /// Bytes, a multiple of 4.
    pub draw_offset: u64,
}

/// The part of a buffer that passes write. Storage is bound from a multiple of the device's alignment on, so the part
/// may begin some words into what is bound.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub buffer: wgpu::Buffer,
    /// Bytes from the beginning of the buffer to the part, and of the part.
    pub at: u64,
    pub bytes: u64,
    /// Bytes from what is bound to the part.
    skipped: u64,
}

impl Section {
    pub fn whole(buffer: wgpu::Buffer) -> Section {
        Section { bytes: buffer.size(), at: 0, skipped: 0, buffer }
    }

    fn of(engine: &Engine, buffer: &wgpu::Buffer, at: u64, bytes: u64) -> Section {
        let alignment = u64::from(engine.device.limits().min_storage_buffer_offset_alignment);
        Section { buffer: buffer.clone(), at, bytes, skipped: at % alignment }
    }

    /// Words from what is bound to the part.
    pub fn skipped_words(&self) -> u32 {
        (self.skipped / 4) as u32
    }

    pub fn binding(&self) -> Binding<'_> {
        let bytes = (self.skipped + self.bytes).max(16).min(self.buffer.size() - (self.at - self.skipped));
        Binding { buffer: &self.buffer, offset: self.at - self.skipped, bytes }
    }
}

/// Where vertices, indices and the draw's arguments go.
pub(super) struct Drawn {
    pub vertices: Section,
    pub indices: Section,
    pub draw: Section,
}

impl Slab {
    /// Its ranges, if the buffers hold them and may be written.
    pub(super) fn drawn(
        &self,
        engine: &Engine,
        format: &Format,
        vertices: u32,
        indices: u32,
    ) -> Result<Drawn, Error> {
        if format.separate {
            return Err(Error::Slab(
                "a slab holds one vertex after the other: attributes cannot be separate".to_string(),
            ));
        }
        let most = engine.device.limits().max_storage_buffer_binding_size;
        let range = |what: &str, buffer: &wgpu::Buffer, first: u64, count: u64, stride: u64| {
            let (at, bytes) = (first * stride, count * stride);
            if !buffer.usage().contains(BufferUsages::STORAGE) {
                let usage = buffer.usage();
                return Err(Error::Slab(format!(
                    "the slab's {what} want the usage STORAGE beside {usage:?}"
                )));
            }
            if at + bytes > buffer.size() {
                let end = first + count;
                let there = buffer.size() / stride;
                return Err(Error::Slab(format!(
                    "the slab's {what} are those from {first} to {end}; its buffer holds {there}"
                )));
            }
            let section = Section::of(engine, buffer, at, bytes);
            match section.skipped + bytes > most {
                true => Err(Error::Binding { buffer: "the slab", needed: section.skipped + bytes, most }),
                false => Ok(section),
            }
        };
        if !self.draw_offset.is_multiple_of(4) {
            return Err(Error::Slab(format!(
                "the slab's draw begins at {}: no multiple of 4",
                self.draw_offset
            )));
        }
        let words = size_of::<DrawArgs>() as u64 / 4;
        Ok(Drawn {
            vertices: range(
                "vertices",
                &self.vertices,
                self.first_vertex.into(),
                vertices.into(),
                format.stride(),
            )?,
            indices: range("indices", &self.indices, self.first_index.into(), indices.into(), 4)?,
            draw: range("words of draws", &self.draws, self.draw_offset / 4, words, 4)?,
        })
    }
}
