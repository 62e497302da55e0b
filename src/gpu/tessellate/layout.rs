//! Vertices as a render pipeline reads them.

use crate::tessellate::vertex::{Format, Normal, Position, Tangent, Uv};
use wgpu::VertexFormat;

/// The attributes of a vertex, as a render pipeline reads them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VertexLayout {
    attributes: Vec<wgpu::VertexAttribute>,
    strides: Vec<u64>,
    separate: bool,
}

impl VertexLayout {
    /// Of a format. Shader locations are fixed, whichever attributes there are: position 0, normal 1, tangent 2,
    /// uv 3, source 4.
    pub fn new(format: &Format) -> VertexLayout {
        let formats = [
            Some(match format.position {
                Position::Float => VertexFormat::Float32x3,
                Position::Snorm16 { .. } => VertexFormat::Snorm16x4,
            }),
            format.normal.map(|normal| match normal {
                Normal::Float => VertexFormat::Float32x3,
                Normal::Octahedral => VertexFormat::Snorm16x2,
            }),
            format.tangent.map(|tangent| match tangent {
                Tangent::Float => VertexFormat::Float32x4,
                Tangent::Snorm8 => VertexFormat::Snorm8x4,
            }),
            format.uv.map(|uv| match uv {
                Uv::Float => VertexFormat::Float32x2,
                Uv::Unorm16 => VertexFormat::Unorm16x2,
            }),
            format.source.then_some(VertexFormat::Uint32x2),
        ];
        let mut layout =
            VertexLayout { attributes: Vec::new(), strides: Vec::new(), separate: format.separate };
        for (location, (format, place)) in formats.into_iter().zip(format.places(0)).enumerate() {
            if let (Some(format), Some(place)) = (format, place) {
                // A section has a slot of its own, whose slice begins where the section does.
                let offset = if layout.separate { 0 } else { place.offset };
                let shader_location = location as u32;
                layout.attributes.push(wgpu::VertexAttribute { format, offset, shader_location });
                layout.strides.push(place.stride);
            }
        }
        layout
    }

    /// For the pipeline's vertex state: one buffer; or, where attributes are separate, one for each, in the
    /// order of their locations. Where each begins is in [`Format::places`].
    pub fn buffers(&self) -> Vec<Option<wgpu::VertexBufferLayout<'_>>> {
        let buffer = |attributes, &array_stride| {
            Some(wgpu::VertexBufferLayout {
                array_stride,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes,
            })
        };
        match self.separate {
            true => self.attributes.chunks(1).zip(&self.strides).map(|(a, s)| buffer(a, s)).collect(),
            false => self.strides.first().map(|s| buffer(&self.attributes[..], s)).into_iter().collect(),
        }
    }
}
