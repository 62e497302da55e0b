// The beginning of a frame: the first level is there to be split, and of a tolerance that was raised as much
// is given back as the triangles of the frame before leave room for.

import lattice;
import target;
import budget;
import workgroups;

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var<uniform> wanted: Target;
@group(0) @binding(2) var<storage, read> ranges: array<u32>;
@group(0) @binding(3) var<storage, read_write> dispatches: array<vec4u>;
@group(0) @binding(4) var<storage, read_write> budget: Budget;

@compute @workgroup_size(1)
fn begin() {
  dispatches[0] = vec4u(workgroups(ranges[0], WORKGROUP), 0u);
  dispatches[1] = vec4u(workgroups(ranges[0], sizes.tile), 0u);
  var back = budget.coarser;
  if wanted.budget != 0u {
    // With some room to spare, or the next frame takes it back.
    back = 0u;
    while back < budget.coarser && f32(budget.triangles) * (raised(back + 1u) * 1.125) <= f32(wanted.budget) {
      back += 1u;
    }
  }
  budget.coarser -= back;
  budget.fits = 0u;
}
