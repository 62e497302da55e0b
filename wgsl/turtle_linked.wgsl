// Where the turtle stands at each module of a word with links: each begins with its own motion and what it hangs on; in a
// round, what stands there is composed before it and its link followed, so that what is composed doubles. Rounds go from
// one half of the columns to the other and back.
//
// A round reads 104 bytes a module and writes 52, for 75 flops; log₂ n of them are done. Records are read once, and a row of 16
// bytes written.

import extent;
import address;
import motion;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> records: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> attributes: array<u32>;
@group(0) @binding(3) var<storage, read_write> motions: array<Motion>;
@group(0) @binding(4) var<storage, read_write> links: array<u32>;

// What a module hangs on: only what stands before it, so that a ring has a start.
fn parent_of(i: u32, m: Record) -> u32 {
  let parent = link_of(m) & 0x7fffffffu;
  return select(NOWHERE, parent, parent < i);
}

@compute @workgroup_size(WORKGROUP)
fn begin(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let m = read_record(i);
  motions[i] = then_module(still(), m);
  links[i] = parent_of(i, m);
}

fn follow(i: u32, here: u32, there: u32) {
  let link = links[here + i];
  if link == NOWHERE {
    motions[there + i] = motions[here + i];
    links[there + i] = NOWHERE;
    return;
  }
  motions[there + i] = composed(motions[here + link], motions[here + i]);
  links[there + i] = links[here + link];
}

@compute @workgroup_size(WORKGROUP)
fn away(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i < extent.count {
    follow(i, 0u, extent.count);
  }
}

@compute @workgroup_size(WORKGROUP)
fn back(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i < extent.count {
    follow(i, extent.count, 0u);
  }
}

@compute @workgroup_size(WORKGROUP)
fn turtle_linked(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  if !BEFORE {
    write_row(i, motions[i]);
    return;
  }
  let parent = parent_of(i, read_record(i));
  if parent == NOWHERE {
    write_row(i, still());
  } else {
    write_row(i, motions[parent]);
  }
}
