// Which rules fire of those that match: a rule of several predecessors claims the modules behind its first, from left to
// right and without overlap. What is claimed becomes nothing.
//
// Which module begins free hangs on all before it: how many modules are still claimed is the state of an automaton, each
// module a function of states 0..7, and functions are composed as sums are added up: reduce, spine, claim. A function takes 3
// bits a state. 8 bytes a module are read and 4 written, and 40 operations done for each of two passes.

import extent;
import rules;
import compositions;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read_write> rules: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;
@group(0) @binding(4) var<storage, read_write> status: Status;

const STATES = 8u;

// A function of states.
alias Element = u32;

// Every state itself.
fn identity() -> u32 {
  return 0xfac688u;
}

fn after(f: u32, state: u32) -> u32 {
  return (f >> (3u * state)) & 7u;
}

fn composed(first: u32, second: u32) -> u32 {
  var f = 0u;
  for (var s = 0u; s < STATES; s++) {
    f |= after(second, after(first, s)) << (3u * s);
  }
  return f;
}

// The state behind a module that is reached in this one.
fn next_state(state: u32, rule: u32) -> u32 {
  if state > 0u {
    return state - 1u;
  }
  return (rule_word(rule) >> 16u) & 7u;
}

// What an invocation's modules do to a state.
fn function_of(start: u32, end: u32) -> u32 {
  var f = identity();
  for (var i = start; i < end; i++) {
    let rule = rules[i];
    var next = 0u;
    for (var s = 0u; s < STATES; s++) {
      next |= next_state(after(f, s), rule) << (3u * s);
    }
    f = next;
  }
  return f;
}

@compute @workgroup_size(WORKGROUP)
fn reduce(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = min(tile * TILE + local * ITEMS, extent.count);
  let f = workgroup_composed(local, function_of(start, min(start + ITEMS, extent.count)));
  if local == WORKGROUP - 1u && tile < tile_count(extent.count) {
    sums[tile] = f;
  }
}

// The state in which each tile begins; the state behind the last goes to the next chunk.
@compute @workgroup_size(WORKGROUP)
fn spine(@builtin(local_invocation_index) local: u32) {
  let tiles = tile_count(extent.count);
  let each = (tiles + WORKGROUP - 1u) / WORKGROUP;
  let start = min(local * each, tiles);
  let end = min(start + each, tiles);
  var f = identity();
  for (var t = start; t < end; t++) {
    f = composed(f, sums[t]);
  }
  let inclusive = workgroup_composed(local, f);
  let before = before_of(local);
  let entered = select(status.claimed, 0u, extent.before == 0u);
  var state = after(before, entered);
  for (var t = start; t < end; t++) {
    let here = sums[t];
    sums[t] = state;
    state = after(here, state);
  }
  storageBarrier();
  workgroupBarrier();
  if local == WORKGROUP - 1u {
    status.claimed = after(inclusive, entered);
  }
}

@compute @workgroup_size(WORKGROUP)
fn claim(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let tile = tile_of(group, groups);
  let start = min(tile * TILE + local * ITEMS, extent.count);
  let end = min(start + ITEMS, extent.count);
  let inclusive = workgroup_composed(local, function_of(start, end));
  let before = before_of(local);
  if tile >= tile_count(extent.count) {
    return;
  }
  var state = after(before, sums[tile]);
  for (var i = start; i < end; i++) {
    let rule = rules[i];
    if state > 0u {
      rules[i] = KEEP + 1u;
    }
    state = next_state(state, rule);
  }
}
