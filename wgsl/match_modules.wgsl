// Which rule fires on each module: the first, by priority, of its symbol whose guards all hold.
//
// An invocation a module: reads its record (16·QUADS bytes) and what was measured of it, writes 4.

import extent;
import rules;
import address;
import attributes;
import branches;
import matching;
import ops;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<uniform> environment: array<vec4u, ENVIRONMENT_QUADS>;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> attributes: array<u32>;
@group(0) @binding(4) var<storage, read_write> rules: array<u32>;
@group(0) @binding(5) var<storage, read_write> status: Status;
@group(0) @binding(6) var<storage, read> links: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn match_modules(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i >= extent.count {
    return;
  }
  let m = read_record(i);
  var rule = KEEP;
  if extent.halted == 0u {
    rule = matching_rule(m);
  }
  rules[i] = rule;
  // Loads are cheaper than atomics that everybody does: each flag is raised once or so.
  if rule < KEEP {
    if atomicLoad(&status.fired) == 0u {
      atomicStore(&status.fired, 1u);
    }
    if too_deep(m, rule_word(rule) & 3u) {
      atomicStore(&status.too_deep, 1u);
    }
  }
  if rule > KEEP {
    let bit = 1u << (symbol_of(m) & 31u);
    if (atomicLoad(&status.retired_symbols) & bit) == 0u {
      atomicOr(&status.retired_symbols, bit);
    }
  }
}
