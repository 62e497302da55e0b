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
fn element_of(start: u32, end: u32) -> Motion {
  var motion = still();
  for (var i = start; i < end; i++) {
    motion = then_module(motion, read_record(i));
  }
  return motion;
}

fn kept(tile: u32) -> Motion {
  return motions[tile];
}

fn keep(tile: u32, motion: Motion) {
  motions[tile] = motion;
}

// The state in which the chunk begins; that behind its last module goes to the next one.
fn entered() -> Motion {
  if extent.before > 0u {
    return carried[0];
  }
  return still();
}

fn leave(all: Motion) {
  carried[0] = all;
}

@compute @workgroup_size(WORKGROUP)
fn turtle(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let own = own_of(group, groups, local);
  let inclusive = workgroup_composed(local, element_of(own.start, own.end));
  let before = before_of(local);
  if own.tile >= tile_count(extent.count) {
    return;
  }
  var state = composed(motions[own.tile], before);
  for (var i = own.start; i < own.end; i++) {
    let next = then_module(state, read_record(i));
    if BEFORE {
      write_row(i, state);
    } else {
      write_row(i, next);
    }
    state = next;
  }
}
