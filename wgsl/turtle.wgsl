// Where the turtle stands at each module, and how wide it draws: rigid motions, composed as sums are added up: reduce,
// spine, turtle. The state behind the last module goes to the next chunk.
//
// A record of 16·QUADS bytes is read twice a module, and a row of 16 bytes written. A turn takes 40 flops for its product and
// 30 for its sine and cosine, a move 25, each in both passes; the compositions of a workgroup, 75 flops each, are few
// beside them. So there are about 2 flops a byte, and memory bounds it.

import extent;
import address;
import motion;
import compositions;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> records: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> attributes: array<u32>;
@group(0) @binding(3) var<storage, read_write> motions: array<Motion>;
@group(0) @binding(4) var<storage, read_write> carried: array<Motion>;

alias Element = Motion;

fn identity() -> Motion {
  return still();
}

// What an invocation's modules do together.
fn motion_of(start: u32, end: u32) -> Motion {
  var motion = still();
  for (var i = start; i < end; i++) {
    motion = then_module(motion, read_record(i));
  }
  return motion;
}

@compute @workgroup_size(WORKGROUP)
fn reduce(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = min(tile * TILE + local * ITEMS, extent.count);
  let motion = workgroup_composed(local, motion_of(start, min(start + ITEMS, extent.count)));
  if local == WORKGROUP - 1u && tile < tile_count(extent.count) {
    motions[tile] = motion;
  }
}

// The state in which each tile begins.
@compute @workgroup_size(WORKGROUP)
fn spine(@builtin(local_invocation_index) local: u32) {
  let tiles = tile_count(extent.count);
  let each = (tiles + WORKGROUP - 1u) / WORKGROUP;
  let start = min(local * each, tiles);
  let end = min(start + each, tiles);
  var motion = still();
  for (var t = start; t < end; t++) {
    motion = composed(motion, motions[t]);
  }
  let inclusive = workgroup_composed(local, motion);
  var entered = still();
  if extent.before > 0u {
    entered = carried[0];
  }
  var state = composed(entered, before_of(local));
  for (var t = start; t < end; t++) {
    let here = motions[t];
    motions[t] = state;
    state = composed(state, here);
  }
  storageBarrier();
  workgroupBarrier();
  if local == WORKGROUP - 1u {
    carried[0] = composed(entered, inclusive);
  }
}

@compute @workgroup_size(WORKGROUP)
fn turtle(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = min(tile * TILE + local * ITEMS, extent.count);
  let end = min(start + ITEMS, extent.count);
  let inclusive = workgroup_composed(local, motion_of(start, end));
  let before = before_of(local);
  if tile >= tile_count(extent.count) {
    return;
  }
  var state = composed(motions[tile], before);
  for (var i = start; i < end; i++) {
    let next = then_module(state, read_record(i));
    if BEFORE {
      write_row(i, state);
    } else {
      write_row(i, next);
    }
    state = next;
  }
}
