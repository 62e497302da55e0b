//! Meshes that cannot be subdivided, and levels that are too fine, each with its message; and poles, which can.

use super::surface::Surface;
use super::{positions, topology};
use crate::oracle::mesh::Level;
use burgeon::cpu::refine::{Refiner, quads};
use burgeon::mesh::{
    Corner, Crease, FaceParent, Faces, Mesh, MeshError, Options, Topology, TopologyError, VertexParent,
};

/// So many vertices, and faces of them.
fn mesh(vertices: usize, faces: &[&[u32]]) -> Mesh {
    let position = |v: usize| [v as f32, (v * v % 7) as f32, (v * v * v % 5) as f32];
    let faces = faces.iter().map(|face| face.iter().copied());
    Mesh::new((0..vertices).map(position).collect(), faces.collect::<Faces>())
}

/// Two quads side by side.
fn pair() -> Mesh {
    mesh(6, &[&[0, 1, 4, 3], &[1, 2, 5, 4]])
}

#[track_caller]
fn assert_refused(mesh: &Mesh, error: MeshError, message: &str) {
    let found = Topology::new(mesh, &Options::default()).expect_err("an error");
    // NaN is not itself.
    assert_eq!(format!("{found:?}"), format!("{:?}", TopologyError::Mesh(error)));
    assert_eq!(found.to_string(), message);
    covered(&found);
}

/// Fails to compile where an error is new, and needs a test.
fn covered(error: &TopologyError) {
    match error {
        TopologyError::Mesh(error) => match error {
            MeshError::Index { .. } | MeshError::Corners { .. } | MeshError::Repeated { .. } => {}
            MeshError::SameWay { .. } | MeshError::ManyFaces { .. } | MeshError::Fans { .. } => {}
            MeshError::TooLarge { .. } | MeshError::Sharpness(..) | MeshError::NoEdge(_) => {}
            MeshError::NoVertex(..) | MeshError::NoFace(..) | MeshError::NotFinite { .. } => {}
        },
        TopologyError::TooFine { .. } => {}
    }
}

#[test]
fn faces_of_vertices_that_are_not_there() {
    let error = MeshError::Index { face: 1, vertex: 6, vertices: 6 };
    let message = "face 1 names vertex 6, and there are 6, counted from 0";
    assert_refused(&mesh(6, &[&[0, 1, 4, 3], &[1, 2, 6, 4]]), error, message);

    let error = MeshError::Index { face: 0, vertex: u32::MAX, vertices: 3 };
    let message = "face 0 names vertex 4294967295, and there are 3, counted from 0";
    assert_refused(&mesh(3, &[&[0, 1, u32::MAX]]), error, message);
}

#[test]
fn faces_of_two_corners() {
    for corners in 0..3 {
        let face: Vec<u32> = (0..corners).collect();
        let error = MeshError::Corners { face: 1, corners: corners as usize };
        let message = format!("face 1 has {corners} corners; a face has 3 or more");
        assert_refused(&mesh(4, &[&[0, 1, 2, 3], &face]), error, &message);
    }
}

#[test]
fn faces_with_a_vertex_twice() {
    let message = "face 0 has vertex 1 at two of its corners";
    assert_refused(&mesh(3, &[&[0, 1, 1, 2]]), MeshError::Repeated { face: 0, vertex: 1 }, message);
    assert_refused(&mesh(4, &[&[1, 0, 2, 1, 3]]), MeshError::Repeated { face: 0, vertex: 1 }, message);
}

#[test]
fn faces_wound_against_each_other() {
    let error = MeshError::SameWay { faces: [0, 1], from: 1, to: 4 };
    let message = "faces 0 and 1 both run from vertex 1 to vertex 4: an edge has one face on either side, wound the \
                   same way";
    assert_refused(&mesh(6, &[&[0, 1, 4, 3], &[4, 5, 2, 1]]), error, message);
}

#[test]
fn edges_of_three_faces() {
    let error = MeshError::ManyFaces { vertices: [1, 4], faces: 3 };
    let message = "the edge between vertices 1 and 4 has 3 faces; in a manifold it has 1 or 2";
    assert_refused(&mesh(8, &[&[0, 1, 4, 3], &[1, 2, 5, 4], &[1, 4, 6, 7]]), error, message);
}

#[test]
fn faces_that_meet_in_a_point() {
    let message = "the faces around vertex 2 meet in that point alone; in a manifold they are one fan";
    assert_refused(&mesh(5, &[&[0, 1, 2], &[2, 3, 4]]), MeshError::Fans { vertex: 2 }, message);
    // Two closed fans: tetrahedra that share a vertex.
    let of = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d], [a, d, b], [b, d, c]];
    let faces: Vec<[u32; 3]> = [of([0, 1, 2, 3]), of([4, 5, 2, 6])].concat();
    let faces: Vec<&[u32]> = faces.iter().map(|face| &face[..]).collect();
    assert_refused(&mesh(7, &faces), MeshError::Fans { vertex: 2 }, message);
}

/// A mesh of so many corners does not fit in the memory of most machines.
#[test]
fn too_many_corners_are_told() {
    let error = TopologyError::from(MeshError::TooLarge { corners: 5_000_000_000 });
    assert_eq!(error.to_string(), "5000000000 corners of faces are more than 32-bit indices can name");
}

#[test]
fn sharpness_below_zero_and_of_no_number() {
    for (sharpness, shown) in [(-0.5, "-0.5"), (f32::NAN, "NaN"), (f32::NEG_INFINITY, "-inf")] {
        let mut creased = pair();
        creased.creases = vec![Crease { vertices: [4, 1], sharpness }];
        let what = "the sharpness of the crease between vertices 4 and 1";
        let error = MeshError::Sharpness(what.to_string(), sharpness);
        let rest = "a sharpness is a number from 0, and infinite from 10 on";
        assert_refused(&creased, error, &format!("{what} is {shown}; {rest}"));

        let mut cornered = pair();
        cornered.corners = vec![Corner { vertex: 3, sharpness }];
        let error = MeshError::Sharpness("the sharpness of vertex 3".to_string(), sharpness);
        assert_refused(&cornered, error, &format!("the sharpness of vertex 3 is {shown}; {rest}"));
    }
    // Without end is as good as 10.
    let surface = |sharpness: f32| {
        let mut mesh = pair();
        mesh.creases = vec![Crease { vertices: [4, 1], sharpness }];
        mesh.corners = vec![Corner { vertex: 0, sharpness }];
        positions(&mesh, &topology(&mesh, &Options::default()), 3)
    };
    assert_eq!(surface(f32::INFINITY), surface(10.0));
    assert_eq!(surface(1e30), surface(10.0));
}

#[test]
fn tags_of_what_is_not_there() {
    let mut tagged = pair();
    tagged.creases =
        vec![Crease { vertices: [1, 4], sharpness: 1.0 }, Crease { vertices: [4, 0], sharpness: 1.0 }];
    let message = "a crease is given for vertices 4 and 0, and no face has that edge";
    assert_refused(&tagged, MeshError::NoEdge([4, 0]), message);
    tagged.creases = vec![Crease { vertices: [9, 0], sharpness: 1.0 }];
    let message = "a crease is given for vertices 9 and 0, and no face has that edge";
    assert_refused(&tagged, MeshError::NoEdge([9, 0]), message);

    let mut tagged = pair();
    tagged.corners = vec![Corner { vertex: 6, sharpness: 1.0 }];
    let message = "a corner is given for vertex 6, and there are 6, counted from 0";
    assert_refused(&tagged, MeshError::NoVertex(6, 6), message);

    let mut tagged = pair();
    tagged.holes = vec![0, 2];
    let message = "face 2 is said to be a hole, and there are 2, counted from 0";
    assert_refused(&tagged, MeshError::NoFace(2, 2), message);
}

#[test]
fn coordinates_that_are_not_finite() {
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        for (value, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
            let mut mesh = pair();
            mesh.positions[5][axis] = value;
            let error = MeshError::NotFinite { vertex: 5, axis: name, value };
            let message = format!("{name} of vertex 5 is {shown}; coordinates must be finite");
            assert_refused(&mesh, error, &message);
        }
    }
}

/// All that 32 bits cannot name is refused, by the refiner and by who asks for creases.
#[test]
fn levels_that_are_too_fine() {
    let quad = mesh(4, &[&[0, 1, 2, 3]]);
    let topology = topology(&quad, &Options::default());
    let error = Refiner::new(topology.clone(), 16).err().expect("an error");
    assert_eq!(topology.creases(16).err().as_ref(), Some(&error));
    let TopologyError::TooFine { level, vertices, faces, most } = error else { panic!("{error}") };
    assert_eq!((level, vertices, faces, most), (16, 32_769 * 32_769, 1 << 30, 14));
    let message = "level 16 is too fine: level 15 would have 1073807361 vertices and 1073741824 faces, more than 32-bit \
                   indices can name; level 14 is the last that has fewer";
    assert_eq!(error.to_string(), message);
    covered(&error);
    // And that one is not refused.
    assert!(topology.creases(most).is_ok());
    assert!(topology.creases(most + 1).is_err());
    for level in [40, 64, 100, u32::MAX] {
        assert_eq!(topology.counts(level).vertices, u64::MAX);
        let error = topology.creases(level).expect_err("an error");
        assert!(matches!(error, TopologyError::TooFine { most: m, .. } if m == most), "{error}");
    }
}

/// A fan of a thousand triangles, closed by another: imported and refined.
#[test]
fn a_pole_of_a_thousand_faces() {
    let n = 1000u32;
    let angle = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(n);
    let mut points = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    points.extend((0..n).map(|k| [angle(k).cos() as f32, angle(k).sin() as f32, 0.0]));
    let fan = |k: u32| [[0, 2 + k, 2 + (k + 1) % n], [1, 2 + (k + 1) % n, 2 + k]];
    let mesh = Mesh::new(points, (0..n).flat_map(fan).collect());
    let topology = topology(&mesh, &Options::default());
    assert_eq!(topology.counts(2).faces, 24_000);
    let points = positions(&mesh, &topology, 2);
    let expected = Surface::naive(&Level::refined(&mesh, &Options::default(), 2));
    let found = Surface::refined(&topology, 2, &points);
    expected.compare(&found, 1e-6 * f64::from(mesh.size())).unwrap_or_else(|e| panic!("{e}"));
}

/// Nothing is no mesh that is wrong.
#[test]
fn a_mesh_of_nothing_has_nothing_at_all_levels() {
    let mesh = Mesh::default();
    let topology = topology(&mesh, &Options::default());
    for level in 0..4 {
        let counts = topology.counts(level);
        assert_eq!([counts.vertices, counts.edges, counts.faces], [0; 3]);
        assert!(positions(&mesh, &topology, level).is_empty());
        assert!(quads(&topology, level).is_empty());
    }
}

/// Level 0 of faces that are no quads is the mesh, with vertices that no face has.
#[test]
fn the_level_of_a_mesh_is_the_mesh() {
    let mesh = mesh(5, &[&[3, 4, 2], &[0, 3, 2]]);
    let topology = topology(&mesh, &Options::default());
    assert_eq!(positions(&mesh, &topology, 0), mesh.positions);
    for vertex in 0..5 {
        assert_eq!(topology.vertex_parent(0, vertex), VertexParent::Vertex(vertex));
    }
    let whole = FaceParent { face: 1, corner: None, uv: [[0.0; 2], [1.0; 2]] };
    assert_eq!(topology.face_parent(0, 1), whole);
}

/// Vertices that no face has are in no level that is refined.
#[test]
fn vertices_that_no_face_has_are_left_out() {
    for faces in [&[&[5u32, 1, 4, 3][..], &[1, 2, 6, 4]][..], &[&[5, 1, 4], &[5, 4, 3]]] {
        let (with, options) = (mesh(9, faces), Options::default());
        let topology = topology(&with, &options);
        for level in 1..=2 {
            let expected = Surface::naive(&Level::refined(&with, &options, level));
            let found = Surface::refined(&topology, level, &positions(&with, &topology, level));
            expected.compare(&found, 1e-6).unwrap_or_else(|e| panic!("{e}"));
        }
    }
}
