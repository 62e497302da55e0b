// All levels of all rings in one dispatch: a vertex around which no grid goes on needs itself and its neighbours alone.
//
// An invocation a ring, which loops over levels without a barrier. A level of a ring of n faces reads and writes
// 16 (1 + 2n) bytes; a valence of 1,000 is one invocation that works long.

import extent;
import pinned;
import masks;

struct Params {
  count: u32,
  zero: u32,
  levels: u32,
  reserved: u32,
}

struct Ring {
  // Its first point among those of all rings and levels, and among the numbers of points.
  base: u32,
  first: u32,
  faces: u32,
  edges: u32,
  // Where its plan begins, a row a level; NONE where nothing is sharp.
  plan: u32,
  // Of a smooth vertex: what itself and what the sum of its neighbours counts.
  own: f32,
  others: f32,
  reserved: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read> list: array<Ring>;
@group(0) @binding(3) var<storage, read> numbers: array<u32>;
// The rule after a level, the rule before, how much the latter counts, the sharp edges of both; then for each edge how much
// its middle counts.
@group(0) @binding(4) var<storage, read> plans: array<u32>;
@group(0) @binding(5) var<storage, read_write> rings: array<vec4f>;

const SMOOTH = 0u;
const CREASE = 1u;
const CORNER = 2u;
const HEAD = 8u;

fn smooth_vertex(r: Ring, old: u32, new_: u32) -> vec3f {
  let p = rings[old].xyz;
  let e = old + 1u;
  let f = new_ + 1u + r.edges;
  // What is smooth has no border.
  if r.faces == 4u {
    return inner(
      p, rings[e].xyz, rings[e + 2u].xyz, rings[e + 1u].xyz, rings[e + 3u].xyz,
      rings[f].xyz, rings[f + 2u].xyz, rings[f + 1u].xyz, rings[f + 3u].xyz,
    );
  }
  var edges = rings[e].xyz;
  for (var i = 1u; i < r.edges; i++) {
    edges = pin(edges + rings[e + i].xyz);
  }
  var faces = rings[f].xyz;
  for (var i = 1u; i < r.faces; i++) {
    faces = pin(faces + rings[f + i].xyz);
  }
  return pin(pin(p * r.own) + pin(pin(edges + faces) * r.others));
}

fn vertex_by(rule: u32, a: u32, b: u32, r: Ring, old: u32, new_: u32) -> vec3f {
  if rule == CORNER {
    return rings[old].xyz;
  }
  if rule == CREASE {
    return crease(rings[old].xyz, rings[old + 1u + a].xyz, rings[old + 1u + b].xyz);
  }
  return smooth_vertex(r, old, new_);
}

fn edge_by(weight: f32, p: vec3f, e: vec3f, f: vec3f, g: vec3f) -> vec3f {
  if weight == 1.0 {
    return middle(p, e);
  }
  let smooth_point = edge(p, e, f, g);
  if weight <= 0.0 {
    return smooth_point;
  }
  return blended(smooth_point, middle(p, e), weight);
}

@compute @workgroup_size(WORKGROUP)
fn refine_rings(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let index = linear(id, groups);
  if index >= params.count {
    return;
  }
  let r = list[index];
  let size = 1u + r.edges + r.faces;
  for (var i = 0u; i < size; i++) {
    rings[r.base + i] = points[numbers[r.first + i]];
  }
  for (var level = 0u; level < params.levels; level++) {
    let old = r.base + level * size;
    let new_ = old + size;
    let p = rings[old].xyz;
    for (var i = 0u; i < r.faces; i++) {
      let after = select(i + 1u, 0u, i + 1u == r.edges);
      let corner = rings[old + 1u + r.edges + i].xyz;
      let point = face(p, rings[old + 1u + i].xyz, corner, rings[old + 1u + after].xyz);
      rings[new_ + 1u + r.edges + i] = vec4f(point, 1.0);
    }
    let plan = r.plan + level * (HEAD + r.edges);
    for (var i = 0u; i < r.edges; i++) {
      var weight = 0.0;
      if r.plan != NONE {
        weight = bitcast<f32>(plans[plan + HEAD + i]);
      }
      let f = rings[new_ + 1u + r.edges + select(i - 1u, r.faces - 1u, i == 0u)].xyz;
      let g = rings[new_ + 1u + r.edges + select(i, 0u, i >= r.faces)].xyz;
      rings[new_ + 1u + i] = vec4f(edge_by(weight, p, rings[old + 1u + i].xyz, f, g), 1.0);
    }
    if r.plan == NONE {
      rings[new_] = vec4f(smooth_vertex(r, old, new_), 1.0);
      continue;
    }
    let before = vertex_by(plans[plan + 1u], plans[plan + 5u], plans[plan + 6u], r, old, new_);
    var vertex = before;
    if plans[plan] != plans[plan + 1u] {
      let after = vertex_by(plans[plan], plans[plan + 3u], plans[plan + 4u], r, old, new_);
      vertex = blended(after, before, bitcast<f32>(plans[plan + 2u]));
    }
    rings[new_] = vec4f(vertex, 1.0);
  }
}
