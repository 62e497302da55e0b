//! Every leaf diced into the same n × n grid.
//!
//! Vertices are not shared between leaves. Where two leaves of one level share a side their vertices
//! there are bit-equal all the same, for every n and whatever their orientation, since a point on a
//! side is computed from the control points of that side alone (see [`crate::patch::evaluate`]).
//! Leaves of different levels meet without that: their grids differ.

use super::Mesh;
use crate::patch::{Module, NetRef, Parameter, Word};
use rayon::prelude::*;
use thiserror::Error;

/// The most triangles that [`grid_for`] lets a model have.
pub const MAX_TRIANGLES: usize = 2_000_000;

/// Why a word could not be diced.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Error {
    #[error("a grid of 0 cells a side has no triangles; take 1 or more")]
    NoCells,
    #[error(
        "{leaves} leaves with a grid of {n} × {n} have more vertices than 32-bit indices can name \
         ({} at most); take a smaller grid",
        u32::MAX
    )]
    TooManyVertices { leaves: usize, n: usize },
}

/// The grid to take for so many leaves: `n` halved (rounding down, to 1 at the least) until the
/// model has at most [`MAX_TRIANGLES`].
pub fn grid_for(leaves: usize, n: usize) -> usize {
    let triangles = |n: usize| leaves.saturating_mul(2).saturating_mul(n).saturating_mul(n);
    let mut n = n.max(1);
    while n > 1 && triangles(n) > MAX_TRIANGLES {
        n /= 2;
    }
    n
}

/// Dices every module of the word into n × n cells of two triangles.
///
/// A leaf has (n + 1)² vertices, row by row (u), one leaf after the other. uvs lie in the unit square
/// of its root. A cell with the corners a = (i, j), b = (i + 1, j), c = (i + 1, j + 1), d = (i, j + 1)
/// becomes a b c and a c d. Triangles with an edge on a side that is collapsed to a point are left
/// out; the vertices of such a side stay, each with the limit normal of its own direction.
///
/// # Errors
/// When n is 0, or the vertices are more than 32-bit indices can name.
pub fn dice(word: &Word, n: usize) -> Result<Mesh, Error> {
    let leaves = word.modules.len();
    let vertices_a_leaf = vertices_a_leaf(leaves, n)?;
    let total = leaves * vertices_a_leaf;
    let mut mesh = Mesh {
        positions: vec![[0.0; 3]; total],
        normals: vec![[0.0; 3]; total],
        uvs: vec![[0.0; 2]; total],
        indices: indices(word, n, vertices_a_leaf),
    };
    let parameters: Vec<Parameter> = (0..=n).map(|i| Parameter::fraction(i, n)).collect();
    let positions = mesh.positions.par_chunks_mut(vertices_a_leaf);
    let normals = mesh.normals.par_chunks_mut(vertices_a_leaf);
    let uvs = mesh.uvs.par_chunks_mut(vertices_a_leaf);
    (positions, normals, uvs).into_par_iter().enumerate().for_each(|(leaf, (positions, normals, uvs))| {
        fill_surface(word.view(leaf), &parameters, positions, normals);
        fill_uvs(word.modules[leaf].cell.uv(), &parameters, uvs);
    });
    Ok(mesh)
}

fn vertices_a_leaf(leaves: usize, n: usize) -> Result<usize, Error> {
    if n == 0 {
        return Err(Error::NoCells);
    }
    let side = n.checked_add(1);
    let a_leaf = side.and_then(|side| side.checked_mul(side));
    let total = a_leaf.and_then(|a_leaf| a_leaf.checked_mul(leaves.max(1)));
    match (a_leaf, total) {
        (Some(a_leaf), Some(total)) if u32::try_from(total).is_ok() => Ok(a_leaf),
        _ => Err(Error::TooManyVertices { leaves, n }),
    }
}

fn fill_surface(net: NetRef, parameters: &[Parameter], positions: &mut [[f32; 3]], normals: &mut [[f32; 3]]) {
    let noise = net.noise();
    let mut out = positions.iter_mut().zip(normals);
    for &u in parameters {
        let strip = net.strip(u);
        for (&v, (position, normal)) in parameters.iter().zip(&mut out) {
            let here = strip.at(v).euclidean();
            *position = here.position();
            *normal = here.normal(&net, noise, u, v);
        }
    }
}

fn fill_uvs([[u0, v0], [u1, v1]]: [[f64; 2]; 2], parameters: &[Parameter], uvs: &mut [[f32; 2]]) {
    let rows = parameters.iter().map(|u| u.between(u0, u1) as f32);
    let out = rows.flat_map(|u| parameters.iter().map(move |v| [u, v.between(v0, v1) as f32]));
    for (uv, value) in uvs.iter_mut().zip(out) {
        *uv = value;
    }
}

/// Which sides of a net are one point: u = 0, u = 1, v = 0, v = 1.
type Collapsed = [bool; 4];

/// The triangles of all leaves.
fn indices(word: &Word, n: usize, vertices_a_leaf: usize) -> Vec<u32> {
    let collapsed: Vec<Collapsed> =
        (0..word.modules.len()).into_par_iter().map(|leaf| collapsed_sides(&word.view(leaf))).collect();
    let lengths: Vec<usize> = collapsed.iter().map(|&sides| 3 * triangle_count(n, sides)).collect();
    let mut indices = vec![0; lengths.iter().sum()];
    let mut rest = indices.as_mut_slice();
    let mut slices = Vec::with_capacity(lengths.len());
    for length in lengths {
        let (slice, after) = rest.split_at_mut(length);
        slices.push(slice);
        rest = after;
    }
    slices.into_par_iter().zip(collapsed).enumerate().for_each(|(leaf, (slice, sides))| {
        let first = (leaf * vertices_a_leaf) as u32;
        for (out, triangle) in slice.chunks_exact_mut(3).zip(triangles(n, sides)) {
            out.copy_from_slice(&triangle.map(|vertex| first + vertex));
        }
    });
    indices
}

/// The edges along the sides of the leaves in the mesh that [`dice`] makes with the same `n`, as pairs
/// of its vertices; collapsed sides left out. A side that two leaves share comes once from each.
pub fn borders(word: &Word, n: usize) -> Result<Vec<[u32; 2]>, Error> {
    let vertices_a_leaf = vertices_a_leaf(word.modules.len(), n)?;
    let vertex = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let mut edges = Vec::new();
    for leaf in 0..word.modules.len() {
        let first = (leaf * vertices_a_leaf) as u32;
        let [u0, u1, v0, v1] = collapsed_sides(&word.view(leaf));
        for k in 0..n {
            let sides = [
                (u0, [vertex(0, k), vertex(0, k + 1)]),
                (u1, [vertex(n, k), vertex(n, k + 1)]),
                (v0, [vertex(k, 0), vertex(k + 1, 0)]),
                (v1, [vertex(k, n), vertex(k + 1, n)]),
            ];
            let kept = sides.into_iter().filter(|(collapsed, _)| !collapsed);
            edges.extend(kept.map(|(_, edge)| edge.map(|vertex| first + vertex)));
        }
    }
    Ok(edges)
}

/// A value for every vertex of the mesh that [`dice`] makes with the same `n`: that of its leaf.
pub fn per_vertex<T: Copy>(word: &Word, n: usize, of: impl Fn(&Module) -> T) -> Vec<T> {
    let vertices_a_leaf = (n + 1) * (n + 1);
    word.modules.iter().flat_map(|leaf| std::iter::repeat_n(of(leaf), vertices_a_leaf)).collect()
}

/// A closed form for the usual leaf, since there are many of them.
fn triangle_count(n: usize, sides: Collapsed) -> usize {
    if sides == [false; 4] { 2 * n * n } else { triangles(n, sides).count() }
}

/// The triangles of one leaf, as vertices of its grid.
fn triangles(n: usize, [u0, u1, v0, v1]: Collapsed) -> impl Iterator<Item = [u32; 3]> {
    let vertex = move |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let cells = (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
    cells.flat_map(move |(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        let last = n - 1;
        // Edge a b runs along the side v = 0, b c along u = 1, c d along v = 1, d a along u = 0.
        let first_is_flat = v0 && j == 0 || u1 && i == last;
        let second_is_flat = v1 && j == last || u0 && i == 0;
        [(!first_is_flat).then_some([a, b, c]), (!second_is_flat).then_some([a, c, d])].into_iter().flatten()
    })
}

fn collapsed_sides(net: &NetRef) -> Collapsed {
    let [m, n] = net.degree().map(usize::from);
    let point = |i: usize, j: usize| net.points()[i * (n + 1) + j];
    let along_v = |i: usize| (1..=n).all(|j| same_point(point(i, j), point(i, 0)));
    let along_u = |j: usize| (1..=m).all(|i| same_point(point(i, j), point(0, j)));
    [along_v(0), along_v(m), along_u(0), along_u(n)]
}

/// Are these the same place? Weights may differ along a collapsed side: then quotients are compared.
fn same_point(a: [f32; 4], b: [f32; 4]) -> bool {
    a == b || (a[3] != b[3] && (0..3).all(|k| a[k] / a[3] == b[k] / b[3]))
}
