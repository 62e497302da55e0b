// How far the triangles of a cell with the control points `net` can be from its surface, in units of the root's size:
// tessellate/bound.rs.

// The size of a difference, or its square where weights are all 1: of the largest square one root is taken.
fn difference_size(d: vec4f, middle: vec3f, r: f32, projective: bool, unit: vec3f) -> f32 {
  if !projective {
    return product_of(d.xyz, d.xyz);
  }
  // What is common to all differences is multiplied last: compilers take it out of sums.
  return length_of((d.xyz - middle * d.w) * unit) + r * abs(d.w);
}

fn error_bound(projective: bool, unit: vec3f) -> f32 {
  var low = vec3f(3.4e38);
  var high = vec3f(-3.4e38);
  var least = 1.0;
  var middle = vec3f(0.0);
  var r = 0.0;
  if projective {
    least = 3.4e38;
    for (var i = 0u; i < ROWS; i++) {
      for (var j = 0u; j < COLUMNS; j++) {
        let p = net[i][j];
        low = min(low, p.xyz / p.w);
        high = max(high, p.xyz / p.w);
        least = min(least, p.w);
      }
    }
    middle = (low + high) * 0.5;
    r = length_of((high - low) * 0.5 * unit);
  }
  var xx = 0.0;
  var xy = 0.0;
  var yy = 0.0;
  for (var i = 0u; i < ROWS; i++) {
    for (var j = 0u; j < COLUMNS; j++) {
      if i + 2u < ROWS {
        let d = (net[i + 2u][j] + net[i][j]) - 2.0 * net[i + 1u][j];
        xx = max(xx, difference_size(d, middle, r, projective, unit));
      }
      if i + 1u < ROWS && j + 1u < COLUMNS {
        let d = (net[i][j] + net[i + 1u][j + 1u]) - (net[i][j + 1u] + net[i + 1u][j]);
        xy = max(xy, difference_size(d, middle, r, projective, unit));
      }
      if j + 2u < COLUMNS {
        let d = (net[i][j + 2u] + net[i][j]) - 2.0 * net[i][j + 1u];
        yy = max(yy, difference_size(d, middle, r, projective, unit));
      }
    }
  }
  if !projective {
    xx = sqrt(xx);
    xy = sqrt(xy);
    yy = sqrt(yy);
  }
  let m = f32(ROWS) - 1.0;
  let n = f32(COLUMNS) - 1.0;
  let k = m * (m - 1.0) * xx + 2.0 * m * n * xy + n * (n - 1.0) * yy;
  return k * 0.125 / least;
}
