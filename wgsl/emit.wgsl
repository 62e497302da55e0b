// The children: symbols, parameters, addresses, and nets by midpoints.
//
// An invocation a module, its net in registers. A 2×2 split of a bicubic net reads 16·16 bytes of
// net and 16·QUADS of record and writes four times that; 84 midpoints of vec4, 0.5 flop a byte:
// bound by bandwidth. Lanes read and write at strides of 256 and 1,024 bytes, but each lane's
// loads and stores fill whole 128-byte lines one after the other, so what the caches hold for a
// moment leaves as full lines.
//
// One shared split serves all rules: which directions are halved and which cells live comes from
// the rule table. Where one rule word serves all modules it is a constant and the tests fold away.

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

fn write_four(at: u32, p0: vec4f, p1: vec4f, p2: vec4f, p3: vec4f) {
  next_nets[at] = p0;
  next_nets[at + 1u] = p1;
  next_nets[at + 2u] = p2;
  next_nets[at + 3u] = p3;
}

// Row r of the cells at `left` and `right`.
fn write_row(split: bool, r: u32, left: u32, right: u32, p0: vec4f, p1: vec4f, p2: vec4f, p3: vec4f) {
  let h = halve_if(split, p0, p1, p2, p3);
  if left != NOWHERE {
    write_four(left * 16u + r * 4u, h.a0, h.a1, h.a2, h.middle);
  }
  if right != NOWHERE {
    write_four(right * 16u + r * 4u, h.middle, h.b1, h.b2, h.b3);
  }
}

@compute @workgroup_size(WORKGROUP)
fn emit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let m = read_record(i);
  let e = emission(i, m);
  if e.live == 0u {
    return;
  }
  let at0 = place(e.first, e.live, 0u);
  let at1 = place(e.first, e.live, 1u);
  let at2 = place(e.first, e.live, 2u);
  let at3 = place(e.first, e.live, 3u);
  write_child(e.rule, 0u, m, e.halves, at0);
  write_child(e.rule, 1u, m, e.halves, at1);
  write_child(e.rule, 2u, m, e.halves, at2);
  write_child(e.rule, 3u, m, e.halves, at3);

  let u = (e.halves & 1u) != 0u;
  let v = (e.halves & 2u) != 0u;
  let b = i * 16u;
  let c0 = halve_if(u, nets[b], nets[b + 4u], nets[b + 8u], nets[b + 12u]);
  let c1 = halve_if(u, nets[b + 1u], nets[b + 5u], nets[b + 9u], nets[b + 13u]);
  let c2 = halve_if(u, nets[b + 2u], nets[b + 6u], nets[b + 10u], nets[b + 14u]);
  let c3 = halve_if(u, nets[b + 3u], nets[b + 7u], nets[b + 11u], nets[b + 15u]);
  write_row(v, 0u, at0, at1, c0.a0, c1.a0, c2.a0, c3.a0);
  write_row(v, 1u, at0, at1, c0.a1, c1.a1, c2.a1, c3.a1);
  write_row(v, 2u, at0, at1, c0.a2, c1.a2, c2.a2, c3.a2);
  write_row(v, 3u, at0, at1, c0.middle, c1.middle, c2.middle, c3.middle);
  if u {
    write_row(v, 0u, at2, at3, c0.middle, c1.middle, c2.middle, c3.middle);
    write_row(v, 1u, at2, at3, c0.b1, c1.b1, c2.b1, c3.b1);
    write_row(v, 2u, at2, at3, c0.b2, c1.b2, c2.b2, c3.b2);
    write_row(v, 3u, at2, at3, c0.b3, c1.b3, c2.b3, c3.b3);
  }
}
