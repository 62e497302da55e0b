//! What a module knows of itself: the attributes of patch systems.

use super::halving::Net;
use super::value::Value;
use super::word::Module;

/// The value of an attribute, computed when it is asked for. `bbox_px` and `area_px` are left out:
/// the oracle has no view.
pub fn attribute(name: &str, module: &Module, step: usize, rational: bool) -> Option<Value> {
    let points = || Points::new(&module.net, rational);
    Some(match name {
        "level" => Value::Int(module.level() as i32),
        "step" => Value::Int(step as i32),
        "uv" => Value::Vector(centre(module).to_vec()),
        "centroid" => Value::Vector(points().centroid().to_vec()),
        "flatness" => Value::Float(points().flatness()),
        "bend_u" => Value::Float(points().bend(1, 0)),
        "bend_v" => Value::Float(points().bend(0, 1)),
        "area" => Value::Float(points().area()),
        _ => return None,
    })
}

/// The centre of the module's cell in the root's unit square.
fn centre(module: &Module) -> [f64; 2] {
    let cell = module.cell();
    let middle = |index: u64, halvings: u32| (index as f64 + 0.5) / 2f64.powi(halvings as i32);
    [middle(cell.i, cell.du), middle(cell.j, cell.dv)]
}

/// A net's points in space: projected if they are homogeneous.
struct Points {
    rows: Vec<Vec<[f64; 3]>>,
}

impl Points {
    fn new(net: &Net, rational: bool) -> Points {
        let project = |[x, y, z, w]: [f64; 4]| {
            let w = if rational && w != 0.0 { w } else { 1.0 };
            [x / w, y / w, z / w]
        };
        let row = |r| (0..=net.degree[1]).map(|c| project(net.point(r, c))).collect();
        Points { rows: (0..=net.degree[0]).map(row).collect() }
    }

    fn centroid(&self) -> [f64; 3] {
        let points: Vec<_> = self.rows.iter().flatten().collect();
        let mean = |axis| points.iter().map(|p| p[axis]).sum::<f64>() / points.len() as f64;
        [mean(0), mean(1), mean(2)]
    }

    /// The greatest distance of the net from its bilinear corner patch.
    fn flatness(&self) -> f64 {
        let (m, n) = (self.rows.len() - 1, self.rows[0].len() - 1);
        let corners = [self.rows[0][0], self.rows[0][n], self.rows[m][0], self.rows[m][n]];
        let mut greatest: f64 = 0.0;
        for (i, row) in self.rows.iter().enumerate() {
            for (j, point) in row.iter().enumerate() {
                let (u, v) = (i as f64 / m as f64, j as f64 / n as f64);
                let weights = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v];
                let flat = |axis: usize| (0..4).map(|k| weights[k] * corners[k][axis]).sum::<f64>();
                greatest = greatest.max(norm([0, 1, 2].map(|axis| point[axis] - flat(axis))));
            }
        }
        greatest
    }

    /// The areas of the net's quads, each as if it were flat.
    fn area(&self) -> f64 {
        let mut sum = 0.0;
        for rows in self.rows.windows(2) {
            for (near, far) in rows[0].windows(2).zip(rows[1].windows(2)) {
                let [a, b] = [[far[1], near[0]], [near[1], far[0]]]
                    .map(|[to, from]| [0, 1, 2].map(|k: usize| to[k] - from[k]));
                let minor = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
                sum += 0.5 * norm([minor(1, 2), minor(2, 0), minor(0, 1)]);
            }
        }
        sum
    }

    /// The greatest second difference in the direction of (down, across).
    fn bend(&self, down: usize, across: usize) -> f64 {
        let mut greatest: f64 = 0.0;
        for i in 0..self.rows.len().saturating_sub(2 * down) {
            for j in 0..self.rows[0].len().saturating_sub(2 * across) {
                let at = |k: usize| self.rows[i + k * down][j + k * across];
                let difference = [0, 1, 2].map(|axis| at(0)[axis] - 2.0 * at(1)[axis] + at(2)[axis]);
                greatest = greatest.max(norm(difference));
            }
        }
        greatest
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
