// Retired modules, copied once to where they stay: reads and writes a record and a net each.

import extent;

@group(0) @binding(0) var<uniform> extent: Extent;
@group(0) @binding(1) var<storage, read> records: array<vec4u>;
@group(0) @binding(2) var<storage, read> nets: array<vec4f>;
@group(0) @binding(3) var<storage, read> retired: array<u32>;
@group(0) @binding(4) var<storage, read_write> finished_records: array<vec4u>;
@group(0) @binding(5) var<storage, read_write> finished_nets: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> status: Status;

@compute @workgroup_size(WORKGROUP)
fn retire(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k >= extent.count {
    return;
  }
  if k >= extent.capacity {
    atomicMax(&status.needed_finished, k + 1u);
    return;
  }
  let i = retired[k];
  for (var q = 0u; q < QUADS; q++) {
    finished_records[k * QUADS + q] = records[i * QUADS + q];
  }
  for (var p = 0u; p < POINTS; p++) {
    finished_nets[k * POINTS + p] = nets[i * POINTS + p];
  }
}
