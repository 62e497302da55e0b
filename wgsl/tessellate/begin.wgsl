// The beginning of a frame: the first level is there to be split, and of a tolerance that was raised as much
// is given back as the triangles of the frame before leave room for.

import lattice;
import target;
import budget;

@group(0) @binding(0) var<uniform> sizes: Sizes;
@group(0) @binding(1) var<uniform> wanted: Target;
@group(0) @binding(2) var<storage, read> ranges: array<u32>;
@group(0) @binding(3) var<storage, read_write> dispatches: array<u32>;
@group(0) @binding(4) var<storage, read_write> budget: Budget;

fn dispatch(at: u32, invocations: u32, workgroup: u32) {
  let groups = (invocations + workgroup - 1u) / workgroup;
  dispatches[at] = min(groups, 32768u);
  dispatches[at + 1u] = (groups + 32767u) / 32768u;
  dispatches[at + 2u] = 1u;
}

@compute @workgroup_size(1)
fn begin() {
  dispatch(0u, ranges[0], WORKGROUP);
  dispatch(4u, ranges[0], sizes.tile);
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
