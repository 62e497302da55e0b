//! Triangle meshes as `.glb`, the binary form of
//! [glTF 2.0](https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html).
//!
//! One scene with one node, named like the mesh; positions, normals, uvs and 32-bit indices, and a
//! plain material that shows both sides. glTF has y up, as burgeon has; where z is up in the mesh the
//! node turns it. glTF counts the v of textures from the top, so v is written as 1 − v: an image lies
//! on the model as it does by `.obj` and `.ply`.

use super::write::{WriteError, check_vertex, write_in_blocks};
use crate::patch::Bounds;
use crate::tessellate::{Mesh, Up};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Accessor, Asset, Index, Material, Node, Root, Scene};
use std::io::{self, Write};

/// Bytes in front of the JSON: magic, version, length, and the length and type of the chunk.
const HEAD: usize = 20;

/// Turns (x, y, z) to (x, z, −y); column by column.
const Z_UP: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// Writes a mesh. Numbers read back to the same f32, but for v, which is rounded with 1 − v. A mesh
/// without triangles is a node alone, since glTF has no empty meshes.
///
/// # Errors
/// What the writer reports; a number that is not finite, naming the vertex; a file of 4 GiB and more,
/// whose length the format cannot say.
pub fn write(writer: &mut dyn Write, mesh: &Mesh, name: &str, up: Up) -> Result<(), WriteError> {
    let empty = mesh.indices.is_empty();
    let sections = Sections::of(mesh);
    let mut json = root(mesh, &sections, name, up).to_vec().map_err(io::Error::from)?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary = if empty { 0 } else { 8 + sections.end };
    let length = |bytes: usize| {
        let too_long =
            || WriteError::Unsupported(format!("{bytes} bytes are more than a .glb can hold (4 GiB)"));
        u32::try_from(bytes).map(u32::to_le_bytes).map_err(|_| too_long())
    };
    writer.write_all(b"glTF")?;
    writer.write_all(&2u32.to_le_bytes())?;
    writer.write_all(&length(HEAD + json.len() + binary)?)?;
    writer.write_all(&length(json.len())?)?;
    writer.write_all(b"JSON")?;
    writer.write_all(&json)?;
    if empty {
        return Ok(());
    }
    writer.write_all(&length(sections.end)?)?;
    writer.write_all(b"BIN\0")?;
    write_in_blocks(writer, mesh.positions.len(), |vertex, bytes| {
        check_vertex(mesh, vertex)?;
        bytes.extend(mesh.positions[vertex].iter().flat_map(|x| x.to_le_bytes()));
        Ok(())
    })?;
    write_in_blocks(writer, mesh.normals.len(), |vertex, bytes| {
        bytes.extend(mesh.normals[vertex].iter().flat_map(|x| x.to_le_bytes()));
        Ok(())
    })?;
    write_in_blocks(writer, mesh.uvs.len(), |vertex, bytes| {
        let [u, v] = mesh.uvs[vertex];
        bytes.extend([u, 1.0 - v].iter().flat_map(|x| x.to_le_bytes()));
        Ok(())
    })?;
    write_in_blocks(writer, mesh.indices.len(), |index, bytes| {
        bytes.extend(mesh.indices[index].to_le_bytes());
        Ok(())
    })
}

/// Where the arrays begin in the binary chunk: one after the other, each a multiple of 4 bytes long.
struct Sections {
    normals: usize,
    uvs: usize,
    indices: usize,
    end: usize,
}

impl Sections {
    fn of(mesh: &Mesh) -> Sections {
        let normals = 12 * mesh.positions.len();
        let uvs = normals + 12 * mesh.normals.len();
        let indices = uvs + 8 * mesh.uvs.len();
        Sections { normals, uvs, indices, end: indices + 4 * mesh.indices.len() }
    }
}

fn root(mesh: &Mesh, sections: &Sections, name: &str, up: Up) -> Root {
    let generator = Some(format!("burgeon {}", env!("CARGO_PKG_VERSION")));
    let mut root = Root { asset: Asset { generator, ..Asset::default() }, ..Root::default() };
    let mesh = (!mesh.indices.is_empty()).then(|| push_mesh(&mut root, mesh, sections, name));
    let matrix = (up == Up::Z).then_some(Z_UP);
    let node = root.push(Node { mesh, matrix, name: Some(name.into()), ..Node::default() });
    let scene = Scene { nodes: vec![node], name: None, extensions: None, extras: Default::default() };
    root.scene = Some(root.push(scene));
    root
}

fn push_mesh(root: &mut Root, mesh: &Mesh, sections: &Sections, name: &str) -> Index<gltf_json::Mesh> {
    root.push(Buffer {
        byte_length: USize64::from(sections.end),
        name: None,
        uri: None,
        extensions: None,
        extras: Default::default(),
    });
    let bounds = Bounds::around(mesh.positions.iter().copied());
    let mut array = |range: std::ops::Range<usize>, count, kind, component, target| {
        let view = root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(range.len()),
            byte_offset: Some(USize64::from(range.start)),
            byte_stride: None,
            name: None,
            target: Some(Checked::Valid(target)),
            extensions: None,
            extras: Default::default(),
        });
        // Only positions must have a box.
        let bounds = bounds.filter(|_| range.start == 0);
        root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: Some(USize64(0)),
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component)),
            type_: Checked::Valid(kind),
            min: bounds.map(|b| b.min.to_vec().into()),
            max: bounds.map(|b| b.max.to_vec().into()),
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        })
    };
    let Sections { normals, uvs, indices, end } = *sections;
    let (f32, vertices) = (ComponentType::F32, Target::ArrayBuffer);
    let attributes = [
        (Semantic::Positions, array(0..normals, mesh.positions.len(), Type::Vec3, f32, vertices)),
        (Semantic::Normals, array(normals..uvs, mesh.normals.len(), Type::Vec3, f32, vertices)),
        (Semantic::TexCoords(0), array(uvs..indices, mesh.uvs.len(), Type::Vec2, f32, vertices)),
    ];
    let faces = Target::ElementArrayBuffer;
    let indices = array(indices..end, mesh.indices.len(), Type::Scalar, ComponentType::U32, faces);
    let mut material = Material { double_sided: true, ..Material::default() };
    // Plain, neither a metal nor a mirror.
    material.pbr_metallic_roughness.metallic_factor.0 = 0.0;
    material.pbr_metallic_roughness.roughness_factor.0 = 0.6;
    let material = root.push(material);
    let primitive = Primitive {
        attributes: attributes.into_iter().map(|(name, array)| (Checked::Valid(name), array)).collect(),
        indices: Some(indices),
        material: Some(material),
        mode: Checked::Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    };
    root.push(gltf_json::Mesh {
        name: Some(name.into()),
        primitives: vec![primitive],
        weights: None,
        extensions: None,
        extras: Default::default(),
    })
}
