// The children: symbols, parameters, addresses, and nets by midpoints.
//
// An invocation a module. A net of degree m × n has R = m + 1 rows and C = n + 1 columns of 16-byte points; a 2×2
// split reads 16·R·C bytes of net and 16·QUADS of record and writes four times that, and does
// C·m(m + 1)/2 + R·n(n + 1) midpoints of vec4: 84 for bicubic nets, 0.5 flop a byte. The triangle of midpoints along u stands in the net's own rows: after each level the
// first of them is the next row of the first half, which is halved along v and written, and at last
// they are the second half. So R·C + C points are held, up to 30 for degree 4; above it
// emit_by_line.wgsl holds less, and is sooner compiled. Lanes read and write at strides of a net and of four, but each lane's
// loads and stores fill whole lines one after the other, so what the caches hold for a moment leaves
// as full lines.
//
// One shared split serves all rules: which directions are halved and which cells live comes from
// the rule table. Where one rule word serves all modules it is a constant and the tests fold away.
// Trip counts are constants, inner ones too, so that drivers unroll the loops.

import extent;
import rules;
import address;
import children;
import rows;
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
  var net: array<array<vec4f, COLUMNS>, ROWS>;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      net[r][c] = nets[i * POINTS + r * COLUMNS + c];
    }
  }
  if !u {
    for (var r = 0u; r < ROWS; r++) {
      write_row(v, net[r], r, at0, at1);
    }
    return;
  }
  for (var level = 0u; level < ROWS; level++) {
    write_row(v, net[0], level, at0, at1);
    for (var r = 0u; r + 1u < ROWS; r++) {
      if r + level + 1u < ROWS {
        for (var c = 0u; c < COLUMNS; c++) {
          net[r][c] = (net[r][c] + net[r + 1u][c]) * 0.5;
        }
      }
    }
  }
  for (var r = 0u; r < ROWS; r++) {
    write_row(v, net[r], r, at2, at3);
  }
}
