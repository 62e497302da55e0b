//! A mesh cut into pieces that fit into buffers.

use super::Error;
use super::camera::Unit;
use crate::tessellate::Mesh;

/// Position in −1..=1, normal, linear colour.
pub(super) type Vertex = [f32; 9];

/// Some of the triangles, with the vertices that they use.
#[derive(Debug, Default)]
pub(super) struct Batch {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
}

/// Stands for "not in this batch yet".
const NOWHERE: u32 = u32::MAX;

/// Cuts the triangles, in order, into batches whose vertices and indices take at most `max_bytes`
/// each (one triangle at the least); `color` gives the linear colour of a vertex.
pub(super) fn batches(
    mesh: &Mesh,
    unit: &Unit,
    color: &dyn Fn(usize) -> [f32; 3],
    max_bytes: u64,
) -> Result<Vec<Batch>, Error> {
    let fits = |count: usize, size: usize| (count * size) as u64 <= max_bytes;
    let mut place = vec![NOWHERE; mesh.positions.len()];
    let mut used = Vec::new();
    let mut batches = Vec::new();
    let mut batch = Batch::default();
    for triangle in mesh.triangles() {
        let one_more_fits = fits(batch.vertices.len() + 3, size_of::<Vertex>())
            && fits(batch.indices.len() + 3, size_of::<u32>());
        if !(batch.indices.is_empty() || one_more_fits) {
            batches.push(std::mem::take(&mut batch));
            used.drain(..).for_each(|vertex: usize| place[vertex] = NOWHERE);
        }
        for index in triangle {
            let vertex = index as usize;
            if *place.get(vertex).ok_or(Error::Index { index, vertices: mesh.positions.len() })? == NOWHERE {
                place[vertex] = batch.vertices.len() as u32;
                used.push(vertex);
                let ([x, y, z], [a, b, c]) =
                    (unit.apply(mesh.positions[vertex]), normal(mesh.normals[vertex]));
                let [red, green, blue] = color(vertex);
                batch.vertices.push([x, y, z, a, b, c, red, green, blue]);
            }
            batch.indices.push(place[vertex]);
        }
    }
    if !batch.indices.is_empty() {
        batches.push(batch);
    }
    Ok(batches)
}

/// The end points of lines along edges, in −1..=1.
pub(super) fn lines(mesh: &Mesh, unit: &Unit, edges: &[[u32; 2]]) -> Result<Vec<[f32; 6]>, Error> {
    let point = |index: u32| match mesh.positions.get(index as usize) {
        Some(&position) => Ok(unit.apply(position)),
        None => Err(Error::Index { index, vertices: mesh.positions.len() }),
    };
    let line = |&[from, to]: &[u32; 2]| {
        let ([a, b, c], [x, y, z]) = (point(from)?, point(to)?);
        Ok([a, b, c, x, y, z])
    };
    edges.iter().map(line).collect()
}

/// The normal, or none: shaders may do anything with what is no number.
fn normal(n: [f32; 3]) -> [f32; 3] {
    if n.iter().all(|x| x.is_finite()) { n } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every batch small enough, and together the same triangles.
    #[test]
    fn batches_are_the_mesh_in_pieces() {
        let positions: Vec<[f32; 3]> = (0..40).map(|i| [i as f32, (i * i % 7) as f32, 1.0]).collect();
        let indices: Vec<u32> = (0..300).map(|i| i * i % 40).collect();
        let mesh = Mesh { normals: positions.clone(), uvs: vec![[0.0; 2]; 40], positions, indices };
        let unit = Unit::of(&mesh.positions);
        for max_bytes in [1, 100, 200, 500, 1_000_000] {
            let batches =
                batches(&mesh, &unit, &|vertex| [vertex as f32; 3], max_bytes).expect("indices are in range");
            assert_eq!(batches.len() == 1, max_bytes == 1_000_000);
            let mut found = Vec::new();
            for batch in &batches {
                let one = batch.indices.len() == 3;
                assert!(one || batch.vertices.len() * 36 <= max_bytes as usize);
                assert!(one || batch.indices.len() * 4 <= max_bytes as usize);
                found.extend(batch.indices.iter().map(|&i| batch.vertices[i as usize][3..].to_vec()));
            }
            let normal_and_color = |&i: &u32| [mesh.normals[i as usize], [i as f32; 3]].concat();
            assert_eq!(found, mesh.indices.iter().map(normal_and_color).collect::<Vec<_>>());
        }
    }

    #[test]
    fn indices_out_of_range_are_refused() {
        let positions = vec![[0.0; 3]; 3];
        let mesh =
            Mesh { normals: positions.clone(), uvs: vec![[0.0; 2]; 3], positions, indices: vec![0, 1, 3] };
        let unit = Unit::of(&mesh.positions);
        assert!(matches!(
            batches(&mesh, &unit, &|_| [0.0; 3], 1000),
            Err(Error::Index { index: 3, vertices: 3 })
        ));
        assert!(matches!(lines(&mesh, &unit, &[[0, 7]]), Err(Error::Index { index: 7, vertices: 3 })));
    }
}
