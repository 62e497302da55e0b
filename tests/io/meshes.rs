//! `.ply`, `.stl` and `.glb`, read back by readers of others.

use super::{SQUARE, TEAPOT};
use burgeon::io::{bpt, glb, ply, stl};
use burgeon::patch::{Net, Word};
use burgeon::tessellate::{Mesh, Up, dice};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

fn teapot() -> Mesh {
    let nets = bpt::read(TEAPOT, false).expect("the teapot");
    dice(&Word::from_nets("teapot", "P", &nets).expect("a word"), 3).expect("a mesh")
}

fn mesh(nets: &[Net]) -> Mesh {
    dice(&Word::from_nets("s", "P", nets).expect("a word"), 2).expect("a mesh")
}

/// One patch; nothing; a patch shrunk to a point, whose normals are made up; the teapot, with collapsed
/// sides.
fn meshes() -> Vec<Mesh> {
    let point = Net { degree: [1, 1], points: vec![[1.0, 2.0, 3.0, 1.0]; 4] };
    let square = bpt::parse(SQUARE.as_bytes(), false).expect("the square");
    vec![mesh(&square), mesh(&[]), mesh(&[point]), teapot()]
}

const ODD: [&str; 6] = ["", " ", "a b", "two\nlines\r\u{7}", "\u{1F33F} \"quoted\\\"", "end_header"];

mod ply_meshes {
    use super::*;

    fn written(mesh: &Mesh, name: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        ply::write(&mut bytes, mesh, name).expect("finite");
        bytes
    }

    fn float(element: &DefaultElement, name: &str) -> f32 {
        match element.get(name) {
            Some(Property::Float(x)) => *x,
            other => panic!("{name}: {other:?}"),
        }
    }

    fn read(bytes: &[u8]) -> Mesh {
        let ply = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).expect("a ply");
        let vertices = ply.payload.get("vertex").map_or(&[][..], Vec::as_slice);
        let faces = ply.payload.get("face").map_or(&[][..], Vec::as_slice);
        let indices = |face: &DefaultElement| match face.get("vertex_indices") {
            Some(Property::ListUInt(list)) => list.clone(),
            other => panic!("{other:?}"),
        };
        Mesh {
            positions: vertices.iter().map(|v| ["x", "y", "z"].map(|k| float(v, k))).collect(),
            normals: vertices.iter().map(|v| ["nx", "ny", "nz"].map(|k| float(v, k))).collect(),
            uvs: vertices.iter().map(|v| ["s", "t"].map(|k| float(v, k))).collect(),
            indices: faces.iter().flat_map(indices).collect(),
        }
    }

    #[test]
    fn read_back() {
        for mesh in meshes() {
            let bytes = written(&mesh, "a mesh");
            let header = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
            assert_eq!(bytes.len(), header + 32 * mesh.positions.len() + 13 * mesh.indices.len() / 3);
            assert_eq!(read(&bytes), mesh);
        }
    }

    #[test]
    fn names() {
        let mesh = meshes().remove(0);
        for name in ODD {
            let bytes = written(&mesh, name);
            assert_eq!(read(&bytes), mesh, "{name}");
            let header = String::from_utf8_lossy(&bytes[..200]).into_owned();
            assert!(header.lines().take(4).all(|line| line.is_ascii()), "{header}");
        }
        let header = written(&mesh, ODD[3]);
        assert!(String::from_utf8_lossy(&header).contains("\ncomment two_lines__\nelement vertex"));
    }

    #[test]
    fn numbers_that_are_not_finite() {
        let mut mesh = meshes().remove(0);
        mesh.normals[3][1] = f32::NAN;
        let error = ply::write(&mut Vec::new(), &mesh, "").expect_err("NaN").to_string();
        assert_eq!(error, "the normal of vertex 3 holds NaN, which is not a finite number");
    }
}

mod stl_meshes {
    use super::*;
    use std::io::Cursor;

    fn written(mesh: &Mesh, name: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        stl::write(&mut bytes, mesh, name).expect("finite");
        bytes
    }

    #[test]
    fn read_back() {
        for mesh in meshes() {
            let bytes = written(&mesh, "a mesh");
            assert_eq!(bytes.len(), 84 + 50 * mesh.indices.len() / 3);
            let read: Vec<stl_io::Triangle> = stl_io::create_stl_reader(&mut Cursor::new(&bytes))
                .expect("an stl")
                .collect::<Result<_, _>>()
                .expect("triangles");
            assert_eq!(read.len(), mesh.indices.len() / 3);
            for (triangle, corners) in read.iter().zip(mesh.indices.as_chunks::<3>().0) {
                let expected = corners.map(|corner| mesh.positions[corner as usize]);
                assert_eq!(triangle.vertices.map(|v| v.0), expected);
                // A unit, from where the corners run counter-clockwise; none where there is no area.
                let normal = triangle.normal.0;
                let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
                let [a, b, c] = expected.map(|p| p.map(f64::from));
                let side = |k: usize, l: usize| (b[k] - a[k]) * (c[l] - a[l]) - (b[l] - a[l]) * (c[k] - a[k]);
                let facing: f64 = (0..3).map(|k| side((k + 1) % 3, (k + 2) % 3) * f64::from(normal[k])).sum();
                assert!(length == 0.0 || ((length - 1.0).abs() < 1e-6 && facing > 0.0), "{triangle:?}");
            }
        }
        let square = meshes().remove(0);
        let first = stl_io::read_stl(&mut Cursor::new(&written(&square, ""))).expect("an stl");
        assert!(first.faces.iter().all(|face| face.normal.0 == [0.0, 0.0, 1.0]));
    }

    #[test]
    fn names() {
        let mesh = meshes().remove(0);
        for name in ODD.into_iter().chain([&"long ".repeat(40)[..]]) {
            let bytes = written(&mesh, name);
            assert!(bytes[..80].starts_with(b"burgeon ") && bytes[..80].is_ascii(), "{name}");
            assert_eq!(bytes[80..84], (mesh.indices.len() as u32 / 3).to_le_bytes());
        }
    }

    #[test]
    fn numbers_that_are_not_finite() {
        let mut mesh = meshes().remove(0);
        mesh.positions[1][0] = f32::INFINITY;
        let error = stl::write(&mut Vec::new(), &mesh, "").expect_err("infinity").to_string();
        assert_eq!(error, "the position of vertex 1 holds inf, which is not a finite number");
    }
}

mod glb_meshes {
    use super::*;

    fn written(mesh: &Mesh, name: &str, up: Up) -> Vec<u8> {
        let mut bytes = Vec::new();
        glb::write(&mut bytes, mesh, name, up).expect("finite");
        bytes
    }

    #[test]
    fn read_back() {
        for (index, mesh) in meshes().into_iter().enumerate() {
            let bytes = written(&mesh, "a mesh", Up::Y);
            assert_eq!(bytes.len() % 4, 0);
            assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
            let gltf = gltf::Gltf::from_slice(&bytes).expect("a valid glTF");
            let node = gltf.default_scene().expect("a scene").nodes().next().expect("a node");
            assert_eq!(node.name(), Some("a mesh"));
            let Some(read) = node.mesh() else {
                assert!(mesh.indices.is_empty() && gltf.blob.is_none() && gltf.buffers().len() == 0);
                continue;
            };
            assert_ne!(index, 1, "an empty mesh");
            let primitive = read.primitives().next().expect("a primitive");
            let reader = primitive.reader(|_| gltf.blob.as_deref());
            let positions: Vec<_> = reader.read_positions().expect("positions").collect();
            assert_eq!(positions, mesh.positions);
            assert_eq!(reader.read_normals().expect("normals").collect::<Vec<_>>(), mesh.normals);
            let uvs: Vec<_> = reader.read_tex_coords(0).expect("uvs").into_f32().collect();
            assert_eq!(uvs, mesh.uvs.iter().map(|[u, v]| [*u, 1.0 - v]).collect::<Vec<_>>());
            assert_eq!(reader.read_indices().expect("indices").into_u32().collect::<Vec<_>>(), mesh.indices);
            let bounds = primitive.bounding_box();
            for k in 0..3 {
                let axis = mesh.positions.iter().map(|p| p[k]);
                assert_eq!(bounds.min[k], axis.clone().fold(f32::INFINITY, f32::min));
                assert_eq!(bounds.max[k], axis.fold(f32::NEG_INFINITY, f32::max));
            }
            assert!(primitive.material().double_sided());
            let generator = &gltf.document.as_json().asset.generator;
            assert!(generator.as_deref().is_some_and(|g| g.starts_with("burgeon ")), "{generator:?}");
        }
    }

    /// Chunks and arrays begin at multiples of 4 bytes.
    #[test]
    fn alignment() {
        for name in ["", "a", "ab", "abc", "abcd"] {
            let bytes = written(&teapot(), name, Up::Y);
            let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four")) as usize;
            let json = word(12);
            assert_eq!((json % 4, word(20 + json) % 4), (0, 0));
            assert_eq!(bytes.len(), 12 + 8 + json + 8 + word(20 + json));
            assert_eq!((&bytes[16..20], &bytes[24 + json..28 + json]), (&b"JSON"[..], &b"BIN\0"[..]));
            let gltf = gltf::Gltf::from_slice(&bytes).expect("a valid glTF");
            assert!(gltf.views().all(|view| view.offset() % 4 == 0));
        }
    }

    #[test]
    fn names() {
        let mesh = meshes().remove(0);
        for name in ODD {
            let gltf = gltf::Gltf::from_slice(&written(&mesh, name, Up::Y)).expect("a valid glTF");
            assert_eq!(gltf.nodes().next().and_then(|node| node.name()), Some(name));
        }
    }

    /// glTF has y up; what is up in the mesh must point there, and stay right-handed.
    #[test]
    fn z_is_turned_to_y() {
        let mesh = meshes().remove(0);
        let matrix = |up| {
            let gltf = gltf::Gltf::from_slice(&written(&mesh, "", up)).expect("a valid glTF");
            gltf.nodes().next().expect("a node").transform().matrix()
        };
        let identity: [[f32; 4]; 4] =
            std::array::from_fn(|i| std::array::from_fn(|j| f32::from(u8::from(i == j))));
        assert_eq!(matrix(Up::Y), identity);
        let turned = matrix(Up::Z);
        assert_eq!(turned[2][..3], [0.0, 1.0, 0.0], "z is up");
        assert_eq!(turned[1][..3], [0.0, 0.0, -1.0], "the front, −y, faces +z");
        assert_eq!(turned[0][..3], [1.0, 0.0, 0.0]);
    }

    #[test]
    fn numbers_that_are_not_finite() {
        let mut mesh = meshes().remove(0);
        mesh.positions[1][0] = f32::INFINITY;
        let error = glb::write(&mut Vec::new(), &mesh, "", Up::Y).expect_err("infinity").to_string();
        assert_eq!(error, "the position of vertex 1 holds inf, which is not a finite number");
    }
}
