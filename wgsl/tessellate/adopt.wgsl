// Whether the word that was derived takes the place of the one before, which else goes on; and the workgroups
// for it.
//
// One invocation.

import lattice;
import progress;
import workgroups;

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var<storage, read> progress: Progress;
@group(0) @binding(2) var<storage, read_write> ranges: array<u32>;
@group(0) @binding(3) var<storage, read_write> dispatches: array<vec4u>;
@group(0) @binding(4) var<storage, read_write> too_deep: u32;
@group(0) @binding(5) var<storage, read_write> adopted: u32;
@group(0) @binding(6) var<storage, read_write> status: array<u32, 12>;

@compute @workgroup_size(1)
fn adopt() {
  let deep = max(progress.too_deep, too_deep);
  let whole = progress.needed <= progress.capacity && deep == 0u;
  too_deep = 0u;
  adopted = select(0u, 1u, whole);
  if whole {
    ranges[0] = progress.modules;
  }
  dispatches[0] = vec4u(workgroups(ranges[0], WORKGROUP), 0u);
  dispatches[1] = vec4u(workgroups(ranges[0], sizes.tile), 0u);
  status[9] = progress.needed;
  status[10] = progress.capacity;
  status[11] = deep;
}
