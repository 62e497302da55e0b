// The children of a curve's modules: symbols and parameters, which may be made of what stands around.
//
// An invocation a module, or, where one production fires on all, EACH of them: reads its record of 16·QUADS bytes, its
// neighbours' from the caches, and writes one such record for each child. Chaikin's rule on points of up to three
// coordinates reads 16 and writes 32 bytes, for 12 flops.

import extent;
import rules;
import address;
import attributes;
import branches;
import matching;
import successors;
import write_record;
import only_children;
import ops;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> rules: array<u32>;
@group(0) @binding(4) var<storage, read> offsets: array<u32>;
@group(0) @binding(5) var<storage, read> attributes: array<u32>;
@group(0) @binding(6) var<storage, read_write> next_records: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> status: Status;
@group(0) @binding(8) var<storage, read> links: array<u32>;

// What the children of a module hang on outside of it.
fn hang_of(i: u32) -> u32 {
  let link = links[HANGS * extent.count + i];
  let on = found(link);
  if on == NOWHERE {
    // All that a turtle writes hangs on the point at which it starts.
    if TRACED {
      return offsets[first_of(i)] | (link & LATERAL);
    }
    return NONE | (link & LATERAL);
  }
  return (offsets[on] + exit_of(rules[on])) | (link & LATERAL);
}

// New modules before those of a module: of all chunks, or where there are several words of its own.
fn number_before(i: u32) -> u32 {
  if WORD != 0u {
    return offsets[i] - offsets[first_of(i)];
  }
  return extent.made + offsets[i];
}

@compute @workgroup_size(WORKGROUP)
fn emit_word(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if ONLY {
    if i * EACH >= extent.count {
      return;
    }
    let end = min((i + 1u) * EACH, extent.count) * CLOSED;
    if end > extent.capacity {
      atomicMax(&status.needed, end);
      return;
    }
    write_children(i * EACH);
    return;
  }
  if i >= extent.count {
    return;
  }
  let m = read_record(i);
  var rule = 0u;
  var first = i * CLOSED;
  if CLOSED != 0u {
    rule = matching_rule(m);
  } else {
    rule = rules[i];
    first = offsets[i];
  }
  let count = (rule_word(rule) >> 8u) & 255u;
  if first + count > extent.capacity {
    atomicMax(&status.needed, first + count);
    return;
  }
  for (var c = 0u; c < count; c++) {
    write_record(first + c, successor(rule, c, m));
  }
}
