// Whether the triangles of a round keep to the budget: then no later round does anything. Else the tolerance is
// raised by as much as they are too many, since it goes with their number on a surface.

import lattice;
import target;
import budget;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<uniform> wanted: Target;
@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read_write> dispatches: array<u32>;
@group(0) @binding(5) var<storage, read_write> budget: Budget;

@compute @workgroup_size(1)
fn afford() {
  if budget.fits != 0u {
    return;
  }
  budget.triangles = offsets[sizes.section + range.count];
  if budget.triangles <= wanted.budget {
    budget.fits = 1u;
    for (var k = 0u; k < 8u * (sizes.all + 1u); k++) {
      dispatches[k] = 0u;
    }
    return;
  }
  var more = 1u;
  while more < MOST_RAISED && f32(wanted.budget) * raised(more) < f32(budget.triangles) {
    more += 1u;
  }
  budget.coarser = min(budget.coarser + more, MOST_RAISED);
}
