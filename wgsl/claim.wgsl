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
fn element_of(start: u32, end: u32) -> u32 {
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

fn kept(tile: u32) -> u32 {
  return sums[tile];
}

fn keep(tile: u32, f: u32) {
  sums[tile] = f;
}

// The function that leads to the state in which the chunk begins, from whatever state.
fn entered() -> u32 {
  return 0x249249u * select(status.claimed, 0u, extent.before == 0u);
}

// The state behind the last module goes to the next chunk.
fn leave(all: u32) {
  status.claimed = after(all, 0u);
}

@compute @workgroup_size(WORKGROUP)
fn claim(
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
  var state = after(before, after(sums[own.tile], 0u));
  for (var i = own.start; i < own.end; i++) {
    let rule = rules[i];
    if state > 0u {
      rules[i] = KEEP + 1u;
    }
    state = next_state(state, rule);
  }
}
