//! Random meshes: the CPU refines them as the oracle does.

use super::surface::Surface;
use super::{cases, positions, topology};
use crate::oracle::mesh::Level;
use crate::oracle::{MeshCase, mesh_case};
use crate::tier;
use burgeon::mesh::{Boundary, Creasing, Mesh, Options, Scheme};

/// Faces of the last level that is compared.
const FACES: usize = 6000;

pub fn all_options() -> Vec<Options> {
    let schemes = Scheme::ALL.iter().map(|&(_, scheme)| scheme);
    let boundaries = [Boundary::Edge, Boundary::Corner];
    let creasings = [Creasing::Uniform, Creasing::Chaikin];
    let with = |scheme, boundary| creasings.map(|creasing| Options { scheme, boundary, creasing });
    schemes
        .flat_map(|scheme| boundaries.into_iter().flat_map(move |boundary| with(scheme, boundary)))
        .collect()
}

/// What is wrong with the levels up to the third, as long as they are not too large.
pub fn differs(mesh: &Mesh, options: &Options, most: usize) -> Result<(), String> {
    let topology = topology(mesh, options);
    let within = 1e-6 * f64::from(mesh.size());
    let mut naive = Level::new(mesh, options);
    let euler = naive.euler();
    let vertices = |naive: &Level| naive.points.len() as u64;
    let mut counts = Vec::new();
    for level in 0..=3 {
        if level > 0 {
            naive = naive.refine(options);
        }
        let found = topology.counts(level);
        let expected = [vertices(&naive), naive.edges.len() as u64, naive.drawn().count() as u64];
        counts.push(expected);
        if [found.vertices, found.edges, found.faces] != expected {
            return Err(format!("level {level}: {found:?}, not {expected:?}"));
        }
        let holes = naive.faces.len() as i64 - expected[2] as i64;
        let [v, e, f] = [found.vertices, found.edges, found.faces].map(|n| n as i64);
        if v - e + f + holes != euler || naive.euler() != euler {
            return Err(format!("level {level}: V − E + F is {}, not {euler}", v - e + f + holes));
        }
        if level > 0 {
            let points = positions(mesh, &topology, level);
            let found = Surface::refined(&topology, level, &points);
            let expected = Surface::naive(&naive);
            expected.compare(&found, within).map_err(|e| format!("level {level}: {e}"))?;
        }
        if 4 * naive.faces.len() > most {
            break;
        }
    }
    Ok(())
}

fn assert_refined(case: &MeshCase) {
    for options in all_options() {
        if let Err(e) = differs(&case.mesh, &options, tier::cases(FACES, usize::MAX)) {
            panic!("{options:?}: {e}\n{case}");
        }
    }
}

#[test]
fn random_meshes_are_refined_as_by_the_oracle() {
    let more = (1000..tier::cases(1030, 1300)).map(mesh_case);
    cases().into_iter().chain(more).for_each(|case| assert_refined(&case));
}
