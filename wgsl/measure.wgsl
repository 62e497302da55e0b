// The attributes of nets that the rules read: plan/measure.rs.
//
// An invocation a module: reads its net (16·POINTS bytes), and its record for `uv`; writes
// 4·MEASURED. Flatness does some 30 flops a point, 2 a byte of the net. What no rule reads has no
// place and folds away. Every sum runs over the net row by row, and lengths are spelled out.

import extent;
import address;
import measures;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> nets: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> attributes: array<u32>;

const GREATEST = 0x1.fffffep+127f;

// As they stand in memory; in space, divided by their weights; on the screen.
var<private> homogeneous: array<vec4f, POINTS>;
var<private> points: array<vec3f, POINTS>;
var<private> pixels: array<vec2f, POINTS>;

fn square(d: vec3f) -> f32 {
  return d.x * d.x + d.y * d.y + d.z * d.z;
}

fn load(i: u32) {
  for (var k = 0u; k < POINTS; k++) {
    let h = nets[i * POINTS + k];
    homogeneous[k] = h;
    points[k] = h.xyz;
    if RATIONAL {
      points[k] = h.xyz / h.w;
    }
  }
}

// Mean of the control points.
fn centroid() -> vec3f {
  var sum = points[0];
  for (var k = 1u; k < POINTS; k++) {
    sum += points[k];
  }
  return sum / f32(POINTS);
}

// Greatest distance of a point from the bilinear patch of the corners at its parameters.
fn flatness() -> f32 {
  let c00 = points[0];
  let c01 = points[COLUMNS - 1u];
  let c10 = points[POINTS - COLUMNS];
  let c11 = points[POINTS - 1u];
  var greatest = 0.0;
  for (var i = 0u; i < ROWS; i++) {
    let u = f32(i) / f32(ROWS - 1u);
    let left = c00 + (c10 - c00) * u;
    let right = c01 + (c11 - c01) * u;
    for (var j = 0u; j < COLUMNS; j++) {
      let v = f32(j) / f32(COLUMNS - 1u);
      greatest = max(greatest, square(points[i * COLUMNS + j] - (left + (right - left) * v)));
    }
  }
  return sqrt(greatest);
}

// Greatest second difference of points that stand `stride` apart, of so many rows and columns.
fn bend(rows: u32, columns: u32, stride: u32) -> f32 {
  var greatest = 0.0;
  for (var i = 0u; i < rows; i++) {
    for (var j = 0u; j < columns; j++) {
      let k = i * COLUMNS + j;
      greatest = max(greatest, square((points[k + 2u * stride] + points[k]) - points[k + stride] * 2.0));
    }
  }
  return sqrt(greatest);
}

// Areas of the net's quads, summed: half the cross product of the diagonals each.
fn area() -> f32 {
  var sum = 0.0;
  for (var i = 0u; i + 1u < ROWS; i++) {
    for (var j = 0u; j + 1u < COLUMNS; j++) {
      let k = i * COLUMNS + j;
      let a = points[k + COLUMNS + 1u] - points[k];
      let b = points[k + 1u] - points[k + COLUMNS];
      sum += sqrt(square(vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)));
    }
  }
  return sum * 0.5;
}

// The points on the screen. Returns how large the net is there where that is known without, else
// less than 0: nothing behind the eye, and beyond all bounds where it reaches through its plane.
fn project() -> f32 {
  let v = VIEW / 4u;
  let c0 = bitcast<vec4f>(environment[v]);
  let c1 = bitcast<vec4f>(environment[v + 1u]);
  let c2 = bitcast<vec4f>(environment[v + 2u]);
  let c3 = bitcast<vec4f>(environment[v + 3u]);
  let scale = bitcast<vec4f>(environment[v + 4u]).xy * 0.5;
  var before = 0u;
  for (var k = 0u; k < POINTS; k++) {
    let h = homogeneous[k];
    let clip = c0 * h.x + c1 * h.y + c2 * h.z + c3 * h.w;
    if clip.w > 0.0 {
      before += 1u;
    }
    pixels[k] = clip.xy / clip.w * scale;
  }
  if before == 0u {
    return 0.0;
  }
  return select(GREATEST, -1.0, before == POINTS);
}

// Greater side of the net's box on the screen.
fn bbox_px() -> f32 {
  var least = pixels[0];
  var greatest = pixels[0];
  for (var k = 1u; k < POINTS; k++) {
    least = min(least, pixels[k]);
    greatest = max(greatest, pixels[k]);
  }
  return max(greatest.x - least.x, greatest.y - least.y);
}

// Areas of the net's quads on the screen, summed.
fn area_px() -> f32 {
  var sum = 0.0;
  for (var i = 0u; i + 1u < ROWS; i++) {
    for (var j = 0u; j + 1u < COLUMNS; j++) {
      let k = i * COLUMNS + j;
      let a = pixels[k + COLUMNS + 1u] - pixels[k];
      let b = pixels[k + 1u] - pixels[k + COLUMNS];
      sum += abs(a.x * b.y - a.y * b.x);
    }
  }
  return sum * 0.5;
}

// (2·index + 1) / 2^(halvings + 1): the middle of a cell.
fn middle(index: u32, halvings: u32) -> f32 {
  return f32(2u * index + 1u) * bitcast<f32>((126u - halvings) << 23u);
}

fn put(at: u32, value: f32) {
  attributes[at] = bitcast<u32>(value);
}

@compute @workgroup_size(WORKGROUP)
fn measure(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let row = extent.given + i * MEASURED;
  if READS_NETS {
    load(i);
  }
  if CENTROID != NOWHERE {
    let c = centroid();
    put(row + CENTROID, c.x);
    put(row + CENTROID + 1u, c.y);
    put(row + CENTROID + 2u, c.z);
  }
  if FLATNESS != NOWHERE {
    put(row + FLATNESS, flatness());
  }
  if BEND_U != NOWHERE {
    put(row + BEND_U, bend(max(ROWS, 2u) - 2u, COLUMNS, COLUMNS));
  }
  if BEND_V != NOWHERE {
    put(row + BEND_V, bend(ROWS, max(COLUMNS, 2u) - 2u, 1u));
  }
  if AREA != NOWHERE {
    put(row + AREA, area());
  }
  if BBOX_PX != NOWHERE || AREA_PX != NOWHERE {
    let known = project();
    if BBOX_PX != NOWHERE {
      put(row + BBOX_PX, select(known, bbox_px(), known < 0.0));
    }
    if AREA_PX != NOWHERE {
      put(row + AREA_PX, select(known, area_px(), known < 0.0));
    }
  }
  if UV != NOWHERE {
    let m = read_record(i);
    put(row + UV, middle(m.q1.x, (m.q0.x >> 16u) & 0xffu));
    put(row + UV + 1u, middle(m.q1.y, m.q0.x >> 24u));
  }
}
