//! Subdivision of meshes.

mod bad;
#[cfg(feature = "gpu")]
mod device;
mod golden;
mod laws;
#[cfg(feature = "gpu")]
mod mutants;
mod random;
mod smooth;
mod surface;

use crate::oracle::{MESH_FEATURES, MeshCase, mesh_case};
use crate::tier;
use burgeon::cpu::refine::{Limits, Refiner};
use burgeon::io::obj;
use burgeon::mesh::{Mesh, Options, Topology};
use std::sync::Arc;

/// A mesh of `tests/golden/mesh`.
fn cage(name: &str) -> Mesh {
    let path = format!("tests/golden/mesh/{name}.obj");
    obj::read_mesh(&path).unwrap_or_else(|e| panic!("{e}")).value
}

fn topology(mesh: &Mesh, options: &Options) -> Arc<Topology> {
    Arc::new(Topology::new(mesh, options).unwrap_or_else(|e| panic!("{e}")))
}

/// Random meshes that have all features between them.
fn cases() -> Vec<MeshCase> {
    tier::covering((0..400).map(mesh_case), &MESH_FEATURES, |case| case.features.clone())
}

/// Positions and normals of a level's vertices in the limit, on the CPU.
fn limits(mesh: &Mesh, topology: &Arc<Topology>, level: u32) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let mut refiner = Refiner::new(topology.clone(), level).unwrap_or_else(|e| panic!("{e}"));
    let count = topology.counts(level).vertices as usize;
    let (mut positions, mut normals) = (vec![[0.0; 3]; count], vec![[0.0; 3]; count]);
    let mut out = Limits { positions: &mut positions, normals: &mut normals, tangents: None };
    refiner.refine_limit(&mesh.positions, &mut out);
    (positions, normals)
}

/// The positions of a level on the CPU.
fn positions(mesh: &Mesh, topology: &Arc<Topology>, level: u32) -> Vec<[f32; 3]> {
    let mut refiner = Refiner::new(topology.clone(), level).unwrap_or_else(|e| panic!("{e}"));
    let mut out = vec![[0.0; 3]; topology.counts(level).vertices as usize];
    refiner.refine(&mesh.positions, &mut out);
    out
}
