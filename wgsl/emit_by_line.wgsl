// The children, as emit.wgsl makes them, of nets of any degree: an invocation a line.
//
// A net of degree m × n has R = m + 1 rows and C = n + 1 columns of 16-byte points. LINES = max(R, C)
// invocations share it: each halves one column, hands both halves over in workgroup memory, and after
// the one barrier halves one row of each. So no midpoint is made twice and no invocation holds more
// than one line: at most 9 points, where a net has up to 81. A 2×2 split reads 16·R·C bytes of net and 16·QUADS of
// record and writes four times that, as it must, and moves 64·R·C bytes through workgroup memory;
// C·m(m + 1)/2 + R·n(n + 1) midpoints of vec4: 0.5 flop a byte for bicubic nets, 1.2 for degree 8.
// Columns are read coalesced; rows are written in runs of 16·C bytes.
//
// For GPUs; on CPU drivers, where workgroup memory and barriers are dear, emit.wgsl is faster. The same midpoints
// in the same order give the same bits.

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

// Of each net the first half along u, then the second.
var<workgroup> halves: array<vec4f, NETS * 2u * POINTS>;

// Column c of a net, halved if `split` as rows are, to the halves that begin at `to`.
fn read_column(split: bool, net: u32, c: u32, to: u32) {
  var first: array<vec4f, ROWS>;
  for (var r = 0u; r < ROWS; r++) {
    first[r] = nets[net * POINTS + r * COLUMNS + c];
  }
  var second = first;
  if split {
    for (var level = 1u; level < ROWS; level++) {
      for (var r = 0u; r + 1u < ROWS; r++) {
        if r + level < ROWS {
          second[r] = (second[r] + second[r + 1u]) * 0.5;
        }
      }
      first[level] = second[0];
    }
  }
  for (var r = 0u; r < ROWS; r++) {
    halves[to + r * COLUMNS + c] = first[r];
    halves[to + POINTS + r * COLUMNS + c] = second[r];
  }
}

// Row r of the half that begins at `begin`.
fn half_row(begin: u32, r: u32) -> array<vec4f, COLUMNS> {
  var row: array<vec4f, COLUMNS>;
  for (var c = 0u; c < COLUMNS; c++) {
    row[c] = halves[begin + r * COLUMNS + c];
  }
  return row;
}

@compute @workgroup_size(WORKGROUP)
fn emit(
  @builtin(global_invocation_id) id: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  // NETS nets a workgroup; invocations that are left over do nothing.
  let slot = local / LINES;
  let k = local % LINES;
  let i = linear(id, groups) / WORKGROUP * NETS + slot;
  let begin = slot * 2u * POINTS;
  var m = Record();
  var e = Emission();
  if slot < NETS && i < extent.count {
    m = read_record(i);
    e = emission(i, m);
  }
  let u = (e.halves & 1u) != 0u;
  let v = (e.halves & 2u) != 0u;
  if e.fits && k < COLUMNS {
    read_column(u, i, k, begin);
  }
  workgroupBarrier();
  if !e.fits {
    return;
  }
  for (var c = k; c < 4u; c += LINES) {
    write_child(e, c, m);
  }
  if k < ROWS {
    write_row(e, 0u, v, half_row(begin, k), k);
    if u {
      write_row(e, 2u, v, half_row(begin + POINTS, k), k);
    }
  }
}
