//! Subdivision of meshes.

mod golden;

use burgeon::cpu::refine::Refiner;
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

/// The positions of a level on the CPU.
fn positions(mesh: &Mesh, topology: &Arc<Topology>, level: u32) -> Vec<[f32; 3]> {
    let mut refiner = Refiner::new(topology.clone(), level).unwrap_or_else(|e| panic!("{e}"));
    let mut out = vec![[0.0; 3]; topology.counts(level).vertices as usize];
    refiner.refine(&mesh.positions, &mut out);
    out
}
