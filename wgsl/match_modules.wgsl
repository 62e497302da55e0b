// Which rule fires on each module: the first, by priority, of its symbol whose guards all hold.
//
// An invocation a module: reads its record (16·QUADS bytes), writes 4.

import extent;
import rules;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> rules: array<u32>;
@group(0) @binding(4) var<storage, read_write> status: Status;

@compute @workgroup_size(WORKGROUP)
fn match_modules(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let rule = matching_rule(read_record(i));
  rules[i] = rule;
  // A load is cheaper than a store that everybody makes.
  if rule < KEEP && atomicLoad(&status.fired) == 0u {
    atomicStore(&status.fired, 1u);
  }
}
