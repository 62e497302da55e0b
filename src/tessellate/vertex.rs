//! What a vertex is in memory.
//!
//! A caller chooses the attributes and their formats; each is whole 4-byte words. They stand one after the
//! other in a vertex (interleaved), or each in a section of its own of the same buffer (separate), to be
//! bound as a slice.
//!
//! | attribute | format | bytes | WebGPU's vertex format |
//! |---|---|---|---|
//! | position | [`Position::Float`] | 12 | `float32x3` |
//! | | [`Position::Snorm16`] | 8 | `snorm16x4`: `middle + extent * xyz`, and w = 1 |
//! | normal, unit | [`Normal::Float`] | 12 | `float32x3` |
//! | | [`Normal::Octahedral`] | 4 | `snorm16x2`: see [`octahedral`] |
//! | tangent, unit along u, and the sense of v | [`Tangent::Float`] | 16 | `float32x4` |
//! | | [`Tangent::Snorm8`] | 4 | `snorm8x4` |
//! | uv in the root's square, as the file gave it | [`Uv::Float`] | 8 | `float32x2` |
//! | | [`Uv::Unorm16`] | 4 | `unorm16x2` |
//! | source: root, symbol | | 8 | `uint32x2` |

use super::lattice::NOWHERE;
use glam::Vec3;

/// How positions are written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Position {
    #[default]
    Float,
    /// As shares of a box, which must hold the surface: what lies outside is drawn to its faces.
    Snorm16 { middle: [f32; 3], extent: [f32; 3] },
}

/// How normals are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Normal {
    #[default]
    Float,
    Octahedral,
}

/// How tangents are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangent {
    #[default]
    Float,
    Snorm8,
}

/// How texture coordinates are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Uv {
    #[default]
    Float,
    Unorm16,
}

/// Which attributes a vertex has, and how they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    pub position: Position,
    pub normal: Option<Normal>,
    pub tangent: Option<Tangent>,
    pub uv: Option<Uv>,
    /// Root and symbol of the leaf that owns the vertex.
    pub source: bool,
    /// A section of the buffer for each attribute, in place of one vertex after the other.
    pub separate: bool,
}

impl Default for Format {
    /// Position, normal and uv in floats, interleaved: 32 bytes.
    fn default() -> Format {
        Format {
            position: Position::Float,
            normal: Some(Normal::Float),
            tangent: None,
            uv: Some(Uv::Float),
            source: false,
            separate: false,
        }
    }
}

/// Attributes in the order in which they stand.
pub const ATTRIBUTES: [&str; 5] = ["position", "normal", "tangent", "uv", "source"];

/// Where an attribute lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Bytes from the start of the buffer to that of the first vertex.
    pub offset: u64,
    /// Bytes from one vertex to the next.
    pub stride: u64,
    /// Bytes of the attribute.
    pub bytes: u64,
}

impl Format {
    /// Bytes of each attribute, in the order of [`ATTRIBUTES`]; 0 for one that is not there.
    pub fn bytes(&self) -> [u64; 5] {
        [
            match self.position {
                Position::Float => 12,
                Position::Snorm16 { .. } => 8,
            },
            match self.normal {
                None => 0,
                Some(Normal::Float) => 12,
                Some(Normal::Octahedral) => 4,
            },
            match self.tangent {
                None => 0,
                Some(Tangent::Float) => 16,
                Some(Tangent::Snorm8) => 4,
            },
            match self.uv {
                None => 0,
                Some(Uv::Float) => 8,
                Some(Uv::Unorm16) => 4,
            },
            if self.source { 8 } else { 0 },
        ]
    }

    /// Bytes of a vertex, all attributes together.
    pub fn stride(&self) -> u64 {
        self.bytes().iter().sum()
    }

    /// Where each attribute lies in a buffer with room for `capacity` vertices.
    pub fn places(&self, capacity: u32) -> [Option<Place>; 5] {
        let mut at = 0;
        self.bytes().map(|bytes| {
            let place = match self.separate {
                true => Place { offset: at * u64::from(capacity), stride: bytes, bytes },
                false => Place { offset: at, stride: self.stride(), bytes },
            };
            at += bytes;
            (bytes > 0).then_some(place)
        })
    }

    /// As the pass `vertices` reads it.
    pub fn outputs(&self, capacity: u32) -> Outputs {
        let (middle, extent) = match self.position {
            Position::Float => ([0.0; 3], [1.0; 3]),
            Position::Snorm16 { middle, extent } => (middle, extent),
        };
        let mut places = [0; 10];
        for (pair, place) in places.chunks_exact_mut(2).zip(self.places(capacity)) {
            pair[0] = place.map_or(NOWHERE, |p| (p.offset / 4) as u32);
            pair[1] = place.map_or(0, |p| (p.stride / 4) as u32);
        }
        let wide = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        Outputs { middle: wide(middle), extent: wide(extent), places, padding: [0; 2] }
    }
}

/// A [`Format`] as the pass `vertices` reads it: a uniform of 80 bytes.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Outputs {
    pub middle: [f32; 4],
    pub extent: [f32; 4],
    /// For each attribute the word where it begins, or [`NOWHERE`], and the words from vertex to vertex.
    pub places: [u32; 10],
    pub padding: [u32; 2],
}

impl Outputs {
    /// Puts the first vertex so many words into what is bound.
    pub fn begin_at(&mut self, words: u32) {
        for place in self.places.chunks_exact_mut(2).filter(|place| place[0] != NOWHERE) {
            place[0] += words;
        }
    }
}

/// A vertex before it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    pub position: Vec3,
    pub normal: Vec3,
    /// Along u, at right angles to the normal; w = ±1: the bitangent along v is `w * cross(normal, tangent)`.
    pub tangent: [f32; 4],
    pub uv: [f32; 2],
    pub source: [u32; 2],
}

impl Vertex {
    /// The words of all attributes, one after the other, and how many there are of each.
    pub fn words(&self, format: &Format) -> ([u32; 14], [usize; 5]) {
        let mut words = [0; 14];
        let counts = format.bytes().map(|bytes| bytes as usize / 4);
        let mut at = 0;
        let mut put = |values: &[u32]| {
            words[at..at + values.len()].copy_from_slice(values);
            at += values.len();
        };
        let p = self.position;
        match format.position {
            Position::Float => put(&p.to_array().map(f32::to_bits)),
            Position::Snorm16 { middle, extent } => {
                let share = (p - Vec3::from(middle)) / Vec3::from(extent);
                put(&[snorm16([share.x, share.y]), snorm16([share.z, 1.0])]);
            }
        }
        match format.normal {
            None => {}
            Some(Normal::Float) => put(&self.normal.to_array().map(f32::to_bits)),
            Some(Normal::Octahedral) => put(&[snorm16(octahedral(self.normal))]),
        }
        match format.tangent {
            None => {}
            Some(Tangent::Float) => put(&self.tangent.map(f32::to_bits)),
            Some(Tangent::Snorm8) => {
                let byte = |x: f32| (x.clamp(-1.0, 1.0) * 127.0 + 0.5).floor() as i32 as u32 & 0xff;
                let [x, y, z, w] = self.tangent.map(byte);
                put(&[x | y << 8 | z << 16 | w << 24]);
            }
        }
        match format.uv {
            None => {}
            Some(Uv::Float) => put(&self.uv.map(f32::to_bits)),
            Some(Uv::Unorm16) => {
                let [u, v] = self.uv.map(|x| (x.clamp(0.0, 1.0) * 65535.0 + 0.5).floor() as u32);
                put(&[u | v << 16]);
            }
        }
        if format.source {
            put(&self.source);
        }
        (words, counts)
    }
}

fn snorm16([x, y]: [f32; 2]) -> u32 {
    let [x, y] = [x, y].map(|x| (x.clamp(-1.0, 1.0) * 32767.0 + 0.5).floor() as i32 as u32 & 0xffff);
    x | y << 16
}

/// A unit vector on the octahedron, unfolded to [−1, 1]². Back: `n = (x, y, 1 − |x| − |y|)`, and where its z is
/// negative `n.xy = (1 − |n.yx|) * sign(n.xy)`; then make it unit.
pub fn octahedral(n: Vec3) -> [f32; 2] {
    let length = n.x.abs() + n.y.abs() + n.z.abs();
    let [x, y] = [n.x / length, n.y / length];
    let sign = |x: f32| if x >= 0.0 { 1.0 } else { -1.0 };
    if n.z >= 0.0 { [x, y] } else { [(1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)] }
}
