// What contexts see around the modules of a linked word, and, when the rules are known, what its modules come to hang
// on: plan/links.rs.
//
// Ignored modules, and those that leave nothing on their axis, are jumped: where a link leads to one, it takes the link of
// that one in its place. A round doubles how far each link reaches, so log2 n rounds do. Links are read while others
// write them; either value leads to the same end. A module reads its record's link (a 16-byte load) and 4 bytes for each
// section of the column that is filled, and writes these; a round reads 8 and writes 4 of those that are not settled.

import extent;
import rules;
import links;
import ignored;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> rules: array<u32>;
@group(0) @binding(4) var<storage, read_write> links: array<atomic<u32>>;

const NOTHING = SETTLED | TARGET;

fn place(section: u32, i: u32) -> u32 {
  return section * extent.count + i;
}

// A link to a module, which is looked through where contexts ignore it.
fn seen(i: u32) -> u32 {
  return i | select(SETTLED, 0u, ignored(symbol_at(i)));
}

@compute @workgroup_size(WORKGROUP)
fn start(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let before = link_at(i) & NONE;
  var up = NOTHING;
  if before != NONE {
    up = seen(before);
  }
  atomicStore(&links[place(UP, i)], up);
  atomicStore(&links[place(DOWN, i)], NOTHING);
  atomicStore(&links[place(LAST, i)], 0u);
}

// Each module tells the one that it hangs on.
@compute @workgroup_size(WORKGROUP)
fn link(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let own = link_at(i);
  let before = own & NONE;
  if before == NONE {
    return;
  }
  if (own & LATERAL) == 0u {
    atomicStore(&links[place(DOWN, before)], seen(i));
  }
  if before < i {
    atomicMax(&links[place(LAST, before)], i);
  }
}

// The last of what hangs on a module is itself, if nothing does.
@compute @workgroup_size(WORKGROUP)
fn settle(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let last = atomicLoad(&links[place(LAST, i)]);
  if last == 0u {
    atomicStore(&links[place(LAST, i)], i | SETTLED);
    return;
  }
  // Whatever of its own settling is done there.
  let further = atomicLoad(&links[place(LAST, last)]);
  let is_last = further == 0u || (further & TARGET) == last;
  atomicStore(&links[place(LAST, i)], last | select(0u, SETTLED, is_last));
}

fn jump_in(section: u32, i: u32) {
  let own = atomicLoad(&links[place(section, i)]);
  if (own & SETTLED) != 0u {
    return;
  }
  let further = atomicLoad(&links[place(section, own & TARGET)]);
  atomicStore(&links[place(section, i)], further | (own & LATERAL));
}

@compute @workgroup_size(WORKGROUP)
fn jump(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i < extent.count {
    jump_in(UP, i);
    jump_in(DOWN, i);
    jump_in(LAST, i);
  }
}

@compute @workgroup_size(WORKGROUP)
fn unhang(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let own = link_at(i);
  let before = own & NONE;
  var hangs = NOTHING;
  if before != NONE {
    hangs = before | select(0u, SETTLED, exit_of(rules[before]) != NO_EXIT);
  }
  atomicStore(&links[place(HANGS, i)], hangs | (own & LATERAL));
}

@compute @workgroup_size(WORKGROUP)
fn rehang(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i < extent.count {
    jump_in(HANGS, i);
  }
}
