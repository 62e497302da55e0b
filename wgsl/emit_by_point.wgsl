// The children, as emit.wgsl makes them, by another mapping: an invocation a control point.
//
// Sixteen invocations share a net: each loads one point, halves its column and its row in workgroup
// memory, and stores one point of each of the four children. So 16 neighbours load 256 bytes and
// store 256 bytes in one piece: every access is coalesced by construction, for 20 midpoints an
// invocation in place of 5 (2 flops a byte) and two barriers. For GPUs; on CPU drivers, where
// workgroup memory and barriers are dear, emit.wgsl is faster. The same midpoints in the same order
// give the same bits.

import extent;
import rules;
import address;
import children;
import halving;
import attributes;
import ops;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> nets: array<vec4f>;
@group(0) @binding(4) var<storage, read> rules: array<u32>;
@group(0) @binding(5) var<storage, read> offsets: array<u32>;
@group(0) @binding(6) var<storage, read> attributes: array<u32>;
@group(0) @binding(7) var<storage, read_write> next_records: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> next_nets: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: Status;

// The nets as they are read, and after u was halved: the first halves, then the second.
var<workgroup> points: array<vec4f, WORKGROUP>;
var<workgroup> upper: array<vec4f, WORKGROUP>;
var<workgroup> lower: array<vec4f, WORKGROUP>;

fn of_first_half(h: Halves, k: u32) -> vec4f {
  switch k {
    case 0u: { return h.a0; }
    case 1u: { return h.a1; }
    case 2u: { return h.a2; }
    default: { return h.middle; }
  }
}

fn of_second_half(h: Halves, k: u32) -> vec4f {
  switch k {
    case 0u: { return h.middle; }
    case 1u: { return h.b1; }
    case 2u: { return h.b2; }
    default: { return h.b3; }
  }
}

// Point k of cell c.
fn write_point(e: Emission, c: u32, k: u32, p: vec4f) {
  if lives(e, c) {
    next_nets[place(e, c) * 16u + k] = p;
  }
}

@compute @workgroup_size(WORKGROUP)
fn emit(
  @builtin(global_invocation_id) id: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let lane = linear(id, groups);
  let i = lane >> 4u;
  let k = lane & 15u;
  let row = k >> 2u;
  let column = k & 3u;
  let net = local & ~15u;
  var m = Record();
  var e = Emission();
  if i < extent.count {
    points[local] = nets[lane];
    m = read_record(i);
    e = emission(i, m);
  }
  let u = (e.halves & 1u) != 0u;
  let v = (e.halves & 2u) != 0u;
  workgroupBarrier();
  let c = net + column;
  let h = halve(points[c], points[c + 4u], points[c + 8u], points[c + 12u]);
  upper[local] = select(points[local], of_first_half(h, row), u);
  lower[local] = of_second_half(h, row);
  workgroupBarrier();
  if !e.fits {
    return;
  }
  // The first four invocations of a net write the records, one each.
  switch k {
    case 0u: { write_child(e, 0u, m); }
    case 1u: { write_child(e, 1u, m); }
    case 2u: { write_child(e, 2u, m); }
    case 3u: { write_child(e, 3u, m); }
    default: {}
  }
  let r = net + row * 4u;
  if v {
    let above = halve(upper[r], upper[r + 1u], upper[r + 2u], upper[r + 3u]);
    write_point(e, 0u, k, of_first_half(above, column));
    write_point(e, 1u, k, of_second_half(above, column));
    if u {
      let below = halve(lower[r], lower[r + 1u], lower[r + 2u], lower[r + 3u]);
      write_point(e, 2u, k, of_first_half(below, column));
      write_point(e, 3u, k, of_second_half(below, column));
    }
  } else {
    write_point(e, 0u, k, upper[local]);
    if u {
      write_point(e, 2u, k, lower[local]);
    }
  }
}
