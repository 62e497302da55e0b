// Reads one vec4 and writes four, an invocation each: the traffic of a 2×2 split without its arithmetic.

import extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> source: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> expanded: array<vec4f>;

@compute @workgroup_size(WORKGROUP)
fn expand(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let i = linear(id, groups);
  if i < extent.count {
    let p = source[i];
    expanded[i * 4u] = p;
    expanded[i * 4u + 1u] = p;
    expanded[i * 4u + 2u] = p;
    expanded[i * 4u + 3u] = p;
  }
}
