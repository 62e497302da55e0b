// Points of a root's surface: tessellate/surface/mod.rs.

struct Sample {
  position: vec3f,
  du: vec3f,
  dv: vec3f,
}

// Bernstein weights and their derivatives.
struct Basis {
  w: array<f32, LINES>,
  d: array<f32, LINES>,
}

fn bernstein(points: u32, t: f32) -> Basis {
  let s = 1.0 - t;
  var b: Basis;
  b.w[0] = 1.0;
  for (var n = 1u; n < LINES; n++) {
    if n < points {
      if n + 1u == points {
        var before = 0.0;
        for (var k = 0u; k < LINES; k++) {
          if k < points {
            b.d[k] = f32(n) * (before - b.w[k]);
            before = b.w[k];
          }
        }
      }
      b.w[n] = t * b.w[n - 1u];
      for (var k = LINES - 1u; k > 0u; k--) {
        if k < n {
          b.w[k] = s * b.w[k] + t * b.w[k - 1u];
        }
      }
      b.w[0] *= s;
    }
  }
  return b;
}

// About the root's place, in units of its size.
fn sample(uv: vec2f) -> Sample {
  let u = bernstein(ROWS, uv.x);
  let v = bernstein(COLUMNS, uv.y);
  var point: vec4f;
  var du: vec4f;
  var dv: vec4f;
  // The first term begins a sum: 0 + x costs an addition.
  for (var c = 0u; c < COLUMNS; c++) {
    var value = u.w[0] * net[0][c];
    var slope = u.d[0] * net[0][c];
    for (var r = 1u; r < ROWS; r++) {
      value += u.w[r] * net[r][c];
      slope += u.d[r] * net[r][c];
    }
    if c == 0u {
      point = v.w[0] * value;
      du = v.w[0] * slope;
      dv = v.d[0] * value;
    } else {
      point += v.w[c] * value;
      du += v.w[c] * slope;
      dv += v.d[c] * value;
    }
  }
  if !RATIONAL {
    return Sample(point.xyz, du.xyz, dv.xyz);
  }
  let position = point.xyz / point.w;
  return Sample(position, (du.xyz - position * du.w) / point.w, (dv.xyz - position * dv.w) / point.w);
}

// Whether a point comes before another by its coordinates.
fn comes_first(a: vec4f, b: vec4f) -> bool {
  for (var k = 0u; k < 4u; k++) {
    if a[k] != b[k] {
      return a[k] < b[k];
    }
  }
  return true;
}

// The point at t / FULL of a side, by midpoints alone; far off they are taken about one of its ends. Read either way it has the
// same bits.
fn on_side(side: u32, at: u32) -> vec3f {
  let count = select(ROWS, COLUMNS, side < 2u);
  let orientation = orientation_of(net_root);
  let base = net_root * POINTS;
  let across = select(ROWS, COLUMNS, side > 1u) - 1u;
  let line = select(0u, across, (side & 1u) != 0u);
  var curve: array<vec4f, LINES>;
  for (var k = 0u; k < LINES; k++) {
    let at = min(k, count - 1u);
    let cell = select(vec2u(at, line), vec2u(line, at), side < 2u);
    curve[k] = nets[base + place_in_file(orientation, cell.x, cell.y)];
  }
  let first = curve[0];
  // Those beyond the last are the last.
  let last = curve[LINES - 1u];
  if at == 0u {
    return projected(first);
  }
  if at == FULL {
    return projected(last);
  }
  let end = projected(select(last, first, comes_first(first, last)));
  var far = 0.0;
  var about_end = 0.0;
  for (var k = 0u; k < LINES; k++) {
    far = max(far, greatest(curve[k]));
    about_end = max(about_end, greatest(about(curve[k], end)));
  }
  let origin = select(vec3f(0.0), end, far > FAR_OFF * about_end);
  for (var k = 0u; k < LINES; k++) {
    curve[k] = about(curve[k], origin);
  }
  // Halve, and keep the half where t lies; at last it is the point between the two.
  var rest = at;
  for (var halving = 0u; halving < LEVELS; halving++) {
    rest *= 2u;
    if rest >= FULL {
      for (var level = 1u; level < LINES; level++) {
        for (var k = 0u; k + 1u < LINES; k++) {
          if k + level < count {
            curve[k] = (curve[k] + curve[k + 1u]) * 0.5;
          }
        }
      }
    } else {
      for (var level = 1u; level < LINES; level++) {
        for (var j = 0u; j + 1u < LINES; j++) {
          let k = LINES - 1u - j;
          if k < count && k >= level {
            curve[k] = (curve[k] + curve[k - 1u]) * 0.5;
          }
        }
      }
    }
    if rest == FULL {
      break;
    }
    rest = select(rest, rest - FULL, rest > FULL);
  }
  return projected(curve[0]) + origin;
}

fn position_at(p: vec2u, inside: vec3f) -> vec3f {
  let x = side_at(p.x, 0u);
  let y = side_at(p.y, 1u);
  var position = inside;
  if x != NOWHERE {
    position = on_side(x, p.y);
  } else if y != NOWHERE {
    position = on_side(y, p.x);
  }
  // +0 for -0.
  return position + vec3f(0.0);
}

const NOISE = 4e-6;

struct Normal {
  normal: vec3f,
  sample: Sample,
}

// The largest coordinate of the net about its place, in units of its size.
fn far_of_net() -> f32 {
  var far = 0.0;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      let p = net[r][c];
      let a = abs(p.xyz);
      far = max(far, max(a.x, max(a.y, a.z)) / p.w);
    }
  }
  return far;
}

// The unit normal, of a point a little towards the middle where the product is nothing but rounding.
fn normal_at(p: vec2u) -> Normal {
  return normal_near(vec2f(p) / f32(FULL));
}

fn normal_near(at: vec2f) -> Normal {
  let noise = NOISE * far_of_net();
  var result: Normal;
  result.normal = vec3f(0.0, 0.0, 1.0);
  for (var attempt = 0u; attempt < 3u; attempt++) {
    var nudge = 0.0;
    if attempt == 1u {
      nudge = 1.0 / 1024.0;
    } else if attempt == 2u {
      nudge = 1.0 / 32.0;
    }
    let s = sample(at + (vec2f(0.5) - at) * nudge);
    if attempt == 0u {
      result.sample = Sample(s.position * net_size + net_origin, s.du * net_size, s.dv * net_size);
    }
    let n = vec3f(
      s.du.y * s.dv.z - s.du.z * s.dv.y,
      s.du.z * s.dv.x - s.du.x * s.dv.z,
      s.du.x * s.dv.y - s.du.y * s.dv.x,
    );
    let size = length_of(n);
    if size > noise * length_of(s.du) + noise * length_of(s.dv) {
      result.normal = n / size;
      break;
    }
  }
  return result;
}
