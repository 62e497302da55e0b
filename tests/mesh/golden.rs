//! Positions and limits against those of an independent engine in double precision.
//!
//! `NAME-SCHEME-OPTIONS.L<n>.xyz.gz` holds the positions of all vertices of level n, `.limit.xyz.gz` limit position and unit
//! normal: OpenSubdiv 3.5. Orders differ, so the points are compared as sets.

use super::{cage, limits, positions, topology};
use crate::oracle::mesh::Level;
use burgeon::mesh::{Boundary, Creasing, NONE, Options, Rule, Scheme, Topology};
use flate2::read::GzDecoder;
use std::fs;
use std::io::Read;

const FOLDER: &str = "tests/golden/mesh";

/// What the name of a golden file says.
struct Case {
    file: String,
    cage: String,
    options: Options,
    level: u32,
    limit: bool,
}

fn cases() -> Vec<Case> {
    let mut names: Vec<String> = fs::read_dir(FOLDER)
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".xyz.gz"))
        .collect();
    names.sort();
    names.into_iter().map(case).collect()
}

fn case(file: String) -> Case {
    let stem = file.strip_suffix(".xyz.gz").expect("the ending");
    let (stem, limit) = stem.strip_suffix(".limit").map_or((stem, false), |stem| (stem, true));
    let (stem, level) = stem.rsplit_once(".L").expect("a level");
    let mut parts = stem.split('-');
    let cage = parts.next().expect("a cage").to_string();
    let mut options = Options::default();
    for part in parts {
        match part {
            "catmark" => options.scheme = Scheme::CatmullClark,
            "boundary_edge" => options.boundary = Boundary::Edge,
            "boundary_corner" => options.boundary = Boundary::Corner,
            "creasing_chaikin" => options.creasing = Creasing::Chaikin,
            other => panic!("{file}: {other}"),
        }
    }
    Case { cage, options, level: level.parse().expect("a level"), limit, file }
}

/// The numbers of a file, so many a line.
fn rows<const N: usize>(file: &str) -> Vec<[f64; N]> {
    let mut text = String::new();
    let bytes = fs::File::open(format!("{FOLDER}/{file}")).expect("the file");
    GzDecoder::new(bytes).read_to_string(&mut text).expect("numbers");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split_ascii_whitespace().map(|x| x.parse().expect("a number")).collect();
        numbers.try_into().expect("as many numbers")
    };
    text.lines().map(row).collect()
}

/// For each point of `a` the nearest of `b` that no other has, if it is near enough.
fn matched(a: &[[f64; 3]], b: &[[f64; 3]], within: f64) -> Vec<Option<usize>> {
    let mut order: Vec<usize> = (0..b.len()).collect();
    order.sort_by(|&i, &j| b[i][0].total_cmp(&b[j][0]));
    let mut taken = vec![false; b.len()];
    let nearest = |p: &[f64; 3]| {
        let from = order.partition_point(|&i| b[i][0] < p[0] - within);
        let near = order[from..].iter().take_while(|&&i| b[i][0] <= p[0] + within);
        let distance = |i: usize| (0..3).map(|k| (b[i][k] - p[k]).powi(2)).sum::<f64>().sqrt();
        let best = near.filter(|&&i| !taken[i]).map(|&i| (distance(i), i)).min_by(|x, y| x.0.total_cmp(&y.0));
        let found = best.filter(|(distance, _)| *distance <= within).map(|(_, i)| i);
        found.inspect(|&i| taken[i] = true)
    };
    a.iter().map(nearest).collect()
}

#[test]
fn positions_are_those_of_the_golden_files() {
    let all = cases();
    assert_eq!(all.iter().filter(|case| !case.limit).count(), 23);
    for case in all.iter().filter(|case| !case.limit) {
        let mesh = cage(&case.cage);
        let expected = rows::<3>(&case.file);
        let found = positions(&mesh, &topology(&mesh, &case.options), case.level);
        assert_eq!(found.len(), expected.len(), "{}", case.file);
        let found: Vec<[f64; 3]> = found.iter().map(|p| p.map(f64::from)).collect();
        let within = 1e-6 * f64::from(mesh.size());
        let missing = matched(&expected, &found, within).iter().filter(|found| found.is_none()).count();
        assert_eq!(missing, 0, "{} of {} in {}", missing, expected.len(), case.file);
    }
}

/// So the oracle, which random meshes are compared with, is right where these are.
#[test]
fn the_oracle_is_at_the_golden_positions() {
    for case in cases().iter().filter(|case| !case.limit) {
        let mesh = cage(&case.cage);
        let expected = rows::<3>(&case.file);
        let found = Level::refined(&mesh, &case.options, case.level).points;
        assert_eq!(found.len(), expected.len(), "{}", case.file);
        // As exact as the numbers of the mesh are, which are rounded to f32.
        let within = 1e-7 * f64::from(mesh.size());
        let missing = matched(&expected, &found, within).iter().filter(|found| found.is_none()).count();
        assert_eq!(missing, 0, "{} of {} in {}", missing, expected.len(), case.file);
    }
}

/// At a crease or a corner a vertex has a normal for each sector of faces between sharp edges, and the files hold one of
/// them: so a normal must be theirs wherever that of the file is the only one.
#[test]
fn limits_are_those_of_the_golden_files() {
    let all = cases();
    assert_eq!(all.iter().filter(|case| case.limit).count(), 23);
    for case in all.iter().filter(|case| case.limit) {
        let mesh = cage(&case.cage);
        let expected = rows::<6>(&case.file);
        let topology = topology(&mesh, &case.options);
        let (points, normals) = limits(&mesh, &topology, case.level);
        let found: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        let within = 1e-6 * f64::from(mesh.size());
        let positions: Vec<[f64; 3]> = expected.iter().map(|row| [row[0], row[1], row[2]]).collect();
        let partners = matched(&positions, &found, within);
        let missing = partners.iter().filter(|found| found.is_none()).count();
        assert_eq!(missing, 0, "{} of {} in {}", missing, expected.len(), case.file);
        let smooth = smooth_vertices(&topology, case.level);
        let mut compared = 0;
        for (row, partner) in expected.iter().zip(partners) {
            let found = partner.expect("a partner");
            let cosine: f64 = (0..3).map(|k| row[3 + k] * f64::from(normals[found][k])).sum();
            if smooth[found] {
                assert!(
                    cosine > 1.0 - 1e-6,
                    "{}: the normal of vertex {found} is off by {cosine}",
                    case.file
                );
                compared += 1;
            }
        }
        assert!(compared > 0 || case.cage == "creases_cube", "{}", case.file);
    }
}

/// Whether all faces around a vertex of a level lie in one sector.
fn smooth_vertices(topology: &Topology, level: u32) -> Vec<bool> {
    let (roots, creases) = (&topology.roots, topology.creases(level).expect("creases"));
    let s = 1usize << (level - topology.first_level());
    let mut smooth = vec![true; topology.counts(level).vertices as usize];
    // At a corner each face has a normal of its own.
    for ring in topology.rings.rings.iter().filter(|ring| ring.sharp != NONE) {
        if creases.last(ring).0 == Rule::Corner {
            smooth[roots.corner(ring.vertex, s) as usize] = false;
        }
    }
    for half in 0..roots.halves.len() as u32 {
        let crease = roots.crease_of[roots.halves.edge(half) as usize];
        if crease == NONE || roots.halves.twin(half).is_none() {
            continue;
        }
        let (root, k) = (half as usize / 4, half as usize % 4);
        let sharp = |piece: usize| creases.sharpness(crease as usize, creases.levels(), piece) > 0.0;
        for t in 0..s {
            let piece = if roots.halves.is_first(half) { t } else { s - 1 - t };
            for at in [t, t + 1] {
                let [x, y] = [[at, 0], [s, at], [s - at, s], [0, s - at]][k];
                smooth[roots.vertex(root, x, y, s) as usize] &= !sharp(piece);
            }
        }
    }
    smooth
}
