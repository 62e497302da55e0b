// The children: symbols, parameters, addresses, and nets by midpoints.
//
// An invocation a module. A net of degree m × n has R = m + 1 rows and C = n + 1 columns of 16-byte
// points; a 2×2 split reads 16·R·C bytes of net and 16·QUADS of record and writes four times that, and
// does C·m(m + 1)/2 + R·n(n + 1) midpoints of vec4: 84 for bicubic nets, 0.5 flop a byte. The triangle
// of midpoints along u stands in the net's own rows: after each level the first of them is the next row
// of the first half, which is halved along v and written, and at last they are the second half. So
// R·C + C points are held, up to 30 for degree 4; above it emit_by_line.wgsl holds less, and is sooner
// compiled. Lanes read and write at strides of a net and of four, but each lane's loads and stores fill
// whole lines soon after each other, so what the caches hold for a moment leaves as full lines. Nets are
// loaded column by column: lavapipe runs that faster than row by row, most of all for degrees but 3.
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
  if !e.fits {
    return;
  }
  write_child(e, 0u, m);
  write_child(e, 1u, m);
  write_child(e, 2u, m);
  write_child(e, 3u, m);

  let u = (e.halves & 1u) != 0u;
  let v = (e.halves & 2u) != 0u;
  var net: array<array<vec4f, COLUMNS>, ROWS>;
  for (var c = 0u; c < COLUMNS; c++) {
    for (var r = 0u; r < ROWS; r++) {
      net[r][c] = nets[i * POINTS + r * COLUMNS + c];
    }
  }
  if !u {
    for (var r = 0u; r < ROWS; r++) {
      write_row(e, 0u, v, net[r], r);
    }
    return;
  }
  for (var level = 0u; level < ROWS; level++) {
    write_row(e, 0u, v, net[0], level);
    for (var r = 0u; r + 1u < ROWS; r++) {
      if r + level + 1u < ROWS {
        for (var c = 0u; c < COLUMNS; c++) {
          net[r][c] = (net[r][c] + net[r + 1u][c]) * 0.5;
        }
      }
    }
  }
  for (var r = 0u; r < ROWS; r++) {
    write_row(e, 2u, v, net[r], r);
  }
}
