//! Levels of meshes compared: where their points are, and which faces they have.

use crate::oracle::mesh::{Level, Point};
use burgeon::cpu::refine::quads;
use burgeon::mesh::Topology;

/// The points of a level, and those of its faces that are drawn.
pub struct Surface {
    pub points: Vec<Point>,
    pub quads: Vec<[usize; 4]>,
}

impl Surface {
    /// What the oracle has.
    pub fn naive(level: &Level) -> Surface {
        let quads = level.drawn().map(|face| face[..].try_into().expect("a quad")).collect();
        Surface { points: level.points.clone(), quads }
    }

    /// What was refined on the CPU.
    pub fn refined(topology: &Topology, level: u32, points: &[[f32; 3]]) -> Surface {
        let quads = quads(topology, level).into_iter().map(|quad| quad.map(|v| v as usize)).collect();
        Surface { points: points.iter().map(|p| p.map(f64::from)).collect(), quads }
    }

    /// What is wrong with another surface, which should have the same points in any order, and at them the same faces,
    /// wound the same way, from any of their corners on.
    pub fn compare(&self, other: &Surface, within: f64) -> Result<(), String> {
        if self.points.len() != other.points.len() {
            return Err(format!("{} points, not {}", other.points.len(), self.points.len()));
        }
        let places = Places::new(&self.points, within);
        let own: Vec<usize> = (0..self.points.len()).map(|v| places.first[v]).collect();
        let mut theirs = Vec::with_capacity(own.len());
        for (v, point) in other.points.iter().enumerate() {
            let Some((nearest, _)) = places.nearest(point) else {
                return Err(format!("there is no point near vertex {v}, {point:?}"));
            };
            theirs.push(places.first[nearest]);
        }
        let counts = |list: &[usize]| {
            let mut counts = vec![0usize; own.len()];
            list.iter().for_each(|&place| counts[place] += 1);
            counts
        };
        let (expected, found) = (counts(&own), counts(&theirs));
        if let Some(place) = (0..own.len()).find(|&place| expected[place] != found[place]) {
            let at = self.points[place];
            return Err(format!("{} points at {at:?}, not {}", found[place], expected[place]));
        }
        let expected = canonical(&self.quads, &own);
        let found = canonical(&other.quads, &theirs);
        if expected == found {
            return Ok(());
        }
        let missing = expected.iter().find(|quad| found.binary_search(quad).is_err());
        let more = found.iter().find(|quad| expected.binary_search(quad).is_err());
        let shown = |quad: Option<&[usize; 4]>| quad.map(|quad| quad.map(|v| self.points[v]));
        Err(format!(
            "{} faces, not {}: {:?} is missing, {:?} is there",
            found.len(),
            expected.len(),
            shown(missing),
            shown(more)
        ))
    }
}

/// Faces as places, each from that corner on from which it comes first, in order.
fn canonical(quads: &[[usize; 4]], places: &[usize]) -> Vec<[usize; 4]> {
    let turned = |quad: &[usize; 4]| (0..4).map(|by| [0, 1, 2, 3].map(|k| places[quad[(k + by) % 4]])).min();
    let mut all: Vec<[usize; 4]> = quads.iter().map(|quad| turned(quad).expect("four")).collect();
    all.sort();
    all
}

/// Points by where they are.
struct Places<'a> {
    points: &'a [Point],
    within: f64,
    /// Along a line on which hardly any two come together that are not the same, and its points.
    order: Vec<usize>,
    along: Vec<f64>,
    /// For each point the first, along that line, that is in the same place.
    first: Vec<usize>,
}

impl<'a> Places<'a> {
    fn new(points: &'a [Point], within: f64) -> Places<'a> {
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&i, &j| on_line(&points[i]).total_cmp(&on_line(&points[j])));
        let along = order.iter().map(|&i| on_line(&points[i])).collect();
        let mut places = Places { points, within, order, along, first: (0..points.len()).collect() };
        for at in 0..points.len() {
            let vertex = places.order[at];
            let near = places.near(&points[vertex]);
            let before = near.into_iter().take_while(|&(i, _)| i != vertex).map(|(i, _)| i);
            if let Some(before) = before.min_by_key(|&i| places.first[i]) {
                places.first[vertex] = places.first[before];
            }
        }
        places
    }

    /// Those near a point, along the line, with their distance.
    fn near(&self, point: &Point) -> Vec<(usize, f64)> {
        let at = on_line(point);
        let from = self.along.partition_point(|&x| x < at - self.within);
        let window = self.along[from..].iter().take_while(|&&x| x <= at + self.within).count();
        let here = self.order[from..from + window].iter();
        here.map(|&i| (i, distance(&self.points[i], point))).filter(|(_, d)| *d <= self.within).collect()
    }

    fn nearest(&self, point: &Point) -> Option<(usize, f64)> {
        self.near(point).into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn on_line(point: &Point) -> f64 {
    0.358_1 * point[0] + 0.479_3 * point[1] + 0.801_2 * point[2]
}

pub fn distance(a: &Point, b: &Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn surfaces_differ_by_a_point_a_face_or_a_winding() {
    let point = |k: usize| [(k % 3) as f64, (k / 3) as f64, 0.1 * k as f64];
    let surface = || Surface { points: (0..6).map(point).collect(), quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]] };
    let mut turned = surface();
    turned.points.reverse();
    turned.quads =
        vec![[0, 1, 4, 3], [2, 5, 4, 1]].into_iter().map(|quad| quad.map(|v| 5 - v)).rev().collect();
    let compare = |other: &Surface| surface().compare(other, 1e-6).map_err(|e| e.chars().take(24).collect());
    assert_eq!(compare(&turned), Ok(()));

    let changed = |change: fn(&mut Surface)| {
        let mut other = surface();
        change(&mut other);
        compare(&other)
    };
    let wrong = |e: &str| Err(e.to_string());
    assert_eq!(changed(|s| s.points[2][1] += 1e-5), wrong("there is no point near v"));
    assert_eq!(changed(|s| s.points[2][1] += 1e-7), Ok(()));
    assert_eq!(changed(|s| s.points[2] = s.points[1]), wrong("2 points at [1.0, 0.0, 0"));
    assert_eq!(changed(|s| s.points.truncate(5)), wrong("5 points, not 6"));
    assert_eq!(changed(|s| s.quads[0].reverse()), wrong("2 faces, not 2: Some([[0"));
    assert_eq!(changed(|s| s.quads[1] = s.quads[0]), wrong("2 faces, not 2: Some([[1"));
    assert_eq!(changed(|s| s.quads.truncate(1)), wrong("1 faces, not 2: Some([[1"));
}
