// Each vertex once, by the leaf that owns it: first those at its corners, in order, then its centre, then
// those that its triangles bring.
//
// An invocation a leaf. A vertex of 32 bytes takes a root's control points, which caches hold, and about 350
// flops: bound by arithmetic on drivers that run on the CPU, by bandwidth on GPUs.

import lattice;
import topology;
import tree;
import control;
import surface;
import placement;

// tessellate/vertex.rs
struct Outputs {
  middle: vec4f,
  extent: vec4f,
  // For each attribute the word where it begins, or NOWHERE, and the words from vertex to vertex.
  position: vec2u,
  normal: vec2u,
  tangent: vec2u,
  uv: vec2u,
  source: vec2u,
  reserved: vec2u,
}

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> outputs: Outputs;
@group(0) @binding(2) var<storage, read> topology: array<u32>;
@group(0) @binding(3) var<storage, read> nets: array<vec4f>;
@group(0) @binding(4) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(5) var<storage, read> children: array<u32>;
@group(0) @binding(6) var<storage, read> table: array<u32>;
@group(0) @binding(7) var<storage, read> marks: array<u32>;
@group(0) @binding(8) var<storage, read> offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> vertex_words: array<u32>;
// Of a placement: plan/placement.rs.
@group(0) @binding(10) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;

fn put(at: u32, value: f32) {
  vertex_words[at] = bitcast<u32>(value);
}

fn snorm16(v: vec2f) -> u32 {
  let s = vec2i(floor(clamp(v, vec2f(-1.0), vec2f(1.0)) * 32767.0 + vec2f(0.5)));
  return (u32(s.x) & 0xffffu) | (u32(s.y) << 16u);
}

fn snorm8(v: vec4f) -> u32 {
  let s = vec4u(vec4i(floor(clamp(v, vec4f(-1.0), vec4f(1.0)) * 127.0 + vec4f(0.5)))) & vec4u(0xffu);
  return s.x | (s.y << 8u) | (s.z << 16u) | (s.w << 24u);
}

fn octahedral(n: vec3f) -> vec2f {
  let p = n.xy / ((abs(n.x) + abs(n.y)) + abs(n.z));
  if n.z >= 0.0 {
    return p;
  }
  return (vec2f(1.0) - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
}

// The same point as one of patch k of those that share it, and its root: k = 0 is the one that is asked.
struct Place {
  root: u32,
  p: vec2u,
  // The entry of the patch that is asked, which comes again among the others.
  again: bool,
}

fn place_of(a: Around, k: u32) -> Place {
  if k == 0u {
    return Place(a.root, a.p, false);
  }
  let entry = entry_at(a.record, k - 1u);
  if a.kind == CURVE {
    let root = entry >> 3u;
    let side = (entry >> 1u) & 3u;
    let t = turned(a.t, (entry & 1u) != 0u);
    let end = (side & 1u) * FULL;
    return Place(root, select(vec2u(t, end), vec2u(end, t), side < 2u), root == a.root && side == a.side);
  }
  let corner = vec2u(entry & 1u, (entry >> 1u) & 1u);
  return Place(entry >> 2u, corner * FULL, entry == ((a.root << 2u) | a.corner));
}

// Some unit vector at right angles to a unit vector.
fn at_right_angles(n: vec3f) -> vec3f {
  let other = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(n.x) < 0.5);
  let v = vec3f(n.y * other.z - n.z * other.y, n.z * other.x - n.x * other.z, n.x * other.y - n.y * other.x);
  return v / length_of(v);
}

// The unit vector along the file's u at right angles to the normal.
fn tangent_of(orientation: u32, along_x: vec3f, along_y: vec3f, normal: vec3f) -> vec3f {
  var u = select(along_x, along_y, (orientation & 4u) != 0u);
  u = select(u, -u, (orientation & 1u) != 0u);
  let tangent = u - normal * product_of(normal, u);
  let size = length_of(tangent);
  if size > 0.0 {
    return tangent / size;
  }
  return at_right_angles(normal);
}

// A lattice point as the file has it.
fn in_file(orientation: u32, p: vec2u) -> vec2u {
  var q = select(p, p.yx, (orientation & 4u) != 0u);
  q.x = turned(q.x, (orientation & 1u) != 0u);
  q.y = turned(q.y, (orientation & 2u) != 0u);
  return q;
}

fn write_vertex(v: u32, root: u32, p: vec2u, symbol: u32) {
  let orientation = orientation_of(root);
  let a = around(root, p);
  // The mean of the normals of all patches that share the vertex, each turned to the side of the first.
  var patches = 1u;
  if SHARED && (NORMAL != 0u || TANGENT != 0u) && a.kind != INNER {
    patches = 1u + entry_count(a.record);
  }
  // Whether, and where, it is displaced.
  let moves = PLACED && (!PLACED_ON || lies_on(a));
  var record: Record;
  var placed = vec3f(0.0);
  if moves {
    record = own_record(a);
    // +0 for -0.
    placed = bitcast<vec3f>(record.q1.xyz) + placement(record) + vec3f(0.0);
  }
  var own = vec3f(0.0);
  var first = vec3f(0.0);
  var sum = vec3f(0.0);
  var position = vec3f(0.0);
  var along_x = vec3f(0.0);
  var along_y = vec3f(0.0);
  for (var k = 0u; k < patches; k++) {
    let place = place_of(a, k);
    if place.again {
      continue;
    }
    load_net(place.root);
    let found = normal_at(place.p);
    let n = select(found.normal, -found.normal, mirrors(place.root));
    var face = Face(n, found.sample.du, found.sample.dv);
    if moves && (NORMAL != 0u || TANGENT != 0u) {
      face = placed_face(record.q0.yzw, place.root, place.p, found.sample, n, placed);
    }
    if k == 0u {
      own = n;
      first = face.normal;
      position = position_at(p, found.sample.position);
      along_x = face.du;
      along_y = face.dv;
    }
    // By the smooth ones: displaced, both sides of a groove may face each other.
    sum += select(face.normal, -face.normal, product_of(n, own) < 0.0);
  }
  if moves {
    position = placed;
  }
  let at = outputs.position.x + v * outputs.position.y;
  if POSITION_SNORM {
    let share = (position - outputs.middle.xyz) / outputs.extent.xyz;
    vertex_words[at] = snorm16(share.xy);
    vertex_words[at + 1u] = snorm16(vec2f(share.z, 1.0));
  } else {
    put(at, position.x);
    put(at + 1u, position.y);
    put(at + 2u, position.z);
  }
  if NORMAL != 0u || TANGENT != 0u {
    let total = length_of(sum);
    var normal = first;
    if patches > 1u && total > 0.0 {
      normal = sum / total;
    }
    let at = outputs.normal.x + v * outputs.normal.y;
    if NORMAL == 1u {
      put(at, normal.x);
      put(at + 1u, normal.y);
      put(at + 2u, normal.z);
    } else if NORMAL == 2u {
      vertex_words[at] = snorm16(octahedral(normal));
    }
    if TANGENT != 0u {
      let tangent = tangent_of(orientation, along_x, along_y, normal);
      let at = outputs.tangent.x + v * outputs.tangent.y;
      if TANGENT == 1u {
        put(at, tangent.x);
        put(at + 1u, tangent.y);
        put(at + 2u, tangent.z);
        put(at + 3u, 1.0);
      } else {
        vertex_words[at] = snorm8(vec4f(tangent, 1.0));
      }
    }
  }
  if UV != 0u {
    let uv = vec2f(in_file(orientation, p)) / f32(FULL);
    let at = outputs.uv.x + v * outputs.uv.y;
    if UV == 1u {
      put(at, uv.x);
      put(at + 1u, uv.y);
    } else {
      let s = vec2u(floor(clamp(uv, vec2f(0.0), vec2f(1.0)) * 65535.0 + vec2f(0.5)));
      vertex_words[at] = s.x | (s.y << 16u);
    }
  }
  if SOURCE {
    let at = outputs.source.x + v * outputs.source.y;
    vertex_words[at] = root;
    vertex_words[at + 1u] = symbol;
  }
}

fn symbol_of(n: vec4u) -> u32 {
  return (n.y >> 16u) & 0x7fffu;
}

@compute @workgroup_size(WORKGROUP)
fn vertices(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= range.count || children[i] != LEAF {
    return;
  }
  let n = nodes[i];
  let mark = marks[i];
  var at = offsets[i];
  // The corners in order, then the centre; each invocation its own next, since most leaves own but one. Then the
  // ends of its sides on other patches. All are written in one place: the kernel is long enough once.
  var rest = (mark >> OWNS) & 31u;
  let depth = depth_of(n);
  var side = 0u;
  var other = 0u;
  var end = 0u;
  loop {
    var root = n.x;
    var symbol = symbol_of(n);
    var p = centre_of(n);
    var found = rest != 0u;
    if found {
      let c = firstTrailingBit(rest);
      rest &= rest - 1u;
      if c < 4u {
        p = corner_of(n, c);
      }
    } else if !SHARED {
      while side < 4u && !found {
        let count = across_count(n, side);
        if other >= count || !on_border(n, side) || !pushes(n, side, mark, count) {
          side += 1u;
          other = 0u;
          continue;
        }
        let to = across(n, side, other);
        if takes(to, depth[along(side)]) {
          root = to.root;
          symbol = symbol_of(nodes[to.node]);
          p = foreign(n, side, to)[end];
          found = !has_corner(nodes[to.node], p);
          end = 1u - end;
        }
        other += select(1u, 0u, end != 0u);
      }
    }
    if !found {
      break;
    }
    write_vertex(at, root, p, symbol);
    at += 1u;
  }
}
