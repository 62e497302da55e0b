// What a placement sees of a surface, and the slopes of what it makes of it: tessellate/placement.rs. Without one
// nothing of this is asked for.

import ops;
import displacement;

// A vertex's record: plan/placement.rs.
struct Record {
  q0: vec4u,
  q1: vec4u,
  q2: vec4u,
  q3: vec4u,
  q4: vec4u,
}

// A word of the environment.
fn uniform_word(at: u32) -> u32 {
  let quad = environment[at >> 2u];
  return quad[at & 3u];
}

// A word of what the host gives, the index clamped; they stand behind the topology.
fn given_word(at: i32) -> u32 {
  let last = max(uniform_word(SEED + 2u), 1u) - 1u;
  return topology[uniform_word(SEED + 1u) + min(u32(at), last)];
}

const STEPS = 2048.0;
const ROUGHER = 64.0;

fn cross_of(a: vec3f, b: vec3f) -> vec3f {
  return vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

fn corner_point(p: vec4f) -> vec3f {
  return p.xyz / p.w;
}

// Mean of the two diagonals between the corners of the net.
fn scale_of_net() -> f32 {
  let first = length_of(corner_point(net[0][0]) - corner_point(net[ROWS - 1u][COLUMNS - 1u]));
  let second = length_of(corner_point(net[ROWS - 1u][0]) - corner_point(net[0][COLUMNS - 1u]));
  return (first + second) * 0.5 * net_size;
}

// A place of a patch at these canonical parameters, with this position and the file's normal.
fn record_at(key: vec3u, root: u32, at: vec2f, s: Sample, position: vec3f, normal: vec3f, scale: f32) -> Record {
  let orientation = orientation_of(root);
  let tangent = tangent_of(orientation, s.du, s.dv, normal);
  let bitangent = cross_of(normal, tangent);
  let q = select(at, at.yx, (orientation & 4u) != 0u);
  let uv = select(q, vec2f(1.0) - q, vec2<bool>((orientation & 1u) != 0u, (orientation & 2u) != 0u));
  return Record(
    vec4u(0u, key),
    bitcast<vec4u>(vec4f(position, scale)),
    bitcast<vec4u>(vec4f(normal, uv.x)),
    bitcast<vec4u>(vec4f(tangent, uv.y)),
    bitcast<vec4u>(vec4f(bitangent, 0.0)),
  );
}

// The vertex as its owner sees it: the first patch of its curve or point.
fn own_record(a: Around) -> Record {
  var count = 1u;
  var skipped = 0u;
  if a.kind != INNER {
    count = entry_count(a.record);
    skipped = 1u;
  }
  var owner: Place;
  var s: Sample;
  var own = vec3f(0.0);
  var sum = vec3f(0.0);
  var position = vec3f(0.0);
  var scale = 0.0;
  for (var k = 0u; k < count; k++) {
    let place = place_of(a, k + skipped);
    load_net(place.root);
    let found = normal_at(place.p);
    let n = select(found.normal, -found.normal, mirrors(place.root));
    if k == 0u {
      owner = place;
      s = found.sample;
      own = n;
      position = position_at(place.p, s.position);
      scale = scale_of_net();
    }
    sum += select(n, -n, product_of(n, own) < 0.0);
  }
  var normal = own;
  let total = length_of(sum);
  if a.kind != INNER && total > 0.0 {
    normal = sum / total;
  }
  let key = vec3u(owner.root, in_file(orientation_of(owner.root), owner.p));
  return record_at(key, owner.root, vec2f(owner.p) / f32(FULL), s, position, normal, scale);
}

// A displaced patch at a vertex.
struct Face {
  normal: vec3f,
  du: vec3f,
  dv: vec3f,
}

// Of the patch whose net is loaded, with its smooth sample and normal, at a vertex that went to `position`.
fn placed_face(key: vec3u, root: u32, p: vec2u, s: Sample, smooth_normal: vec3f, position: vec3f) -> Face {
  let at = vec2f(p) / f32(FULL);
  let scale = scale_of_net();
  var slopes = array<vec3f, 2>(vec3f(0.0), vec3f(0.0));
  for (var n = 0u; n < 6u; n++) {
    let direction = n / 3u;
    let k = n % 3u;
    let t = at[direction];
    // The middle; at the ends of a side all three places lie on the patch.
    var off = f32(k) - 1.0;
    var weights = vec3f(-0.5, 0.0, 0.5);
    if t < 1.0 / STEPS {
      off = f32(k);
      weights = vec3f(-1.5, 2.0, -0.5);
    } else if t > 1.0 - 1.0 / STEPS {
      off = -f32(k);
      weights = vec3f(1.5, -2.0, 0.5);
    }
    let weight = weights[k];
    if weight == 0.0 {
      continue;
    }
    var place = at;
    place[direction] += off / STEPS;
    let found = normal_near(place);
    let normal = select(found.normal, -found.normal, mirrors(root));
    let m = record_at(key, root, place, found.sample, found.sample.position, normal, scale);
    slopes[direction] += placement(m) * weight;
  }
  var face: Face;
  face.du = s.du + slopes[0] * STEPS;
  face.dv = s.dv + slopes[1] * STEPS;
  face.normal = smooth_normal;
  let far = max(abs(position.x), max(abs(position.y), abs(position.z)));
  let rough = ROUGHER * max(NOISE * far_of_net() * net_size, NOISE * far);
  let product = cross_of(face.du, face.dv);
  let size = length_of(product);
  if size > rough * length_of(face.du) + rough * length_of(face.dv) {
    face.normal = product / size;
    if mirrors(root) {
      face.normal = -face.normal;
    }
  }
  return face;
}

// Leaf k of those around a point, of every patch that shares it.
fn leaf_around(a: Around, k: u32) -> u32 {
  if a.kind == INNER {
    return locate(a.root, a.p - vec2u(1u) + vec2u(k & 1u, k >> 1u)).node;
  }
  if a.kind == POINT {
    let entry = entry_at(a.record, k);
    return locate(entry >> 2u, vec2u(entry & 1u, (entry >> 1u) & 1u) * (FULL - 1u)).node;
  }
  let entry = entry_at(a.record, k >> 1u);
  let t = turned(a.t, (entry & 1u) != 0u);
  return locate(entry >> 3u, beside((entry >> 1u) & 3u, t - (k & 1u))).node;
}

// Whether all leaves that touch the point have symbols that are moved; holes do not count.
fn lies_on(a: Around) -> bool {
  for (var k = 0u; k < a.count; k++) {
    let n = nodes[leaf_around(a, k)];
    if !is_hole(n) && !placed_symbol(symbol_of(n)) {
      return false;
    }
  }
  return true;
}
