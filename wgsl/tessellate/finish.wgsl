// What there is to write, whether it fits, and the arguments of the draw. Where it does not fit nothing is
// written: what the buffers hold of the frame before, and the arguments of its draw, stay.

import lattice;
import budget;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> budget: Budget;
@group(0) @binding(4) var<storage, read_write> status: array<u32, 9>;
@group(0) @binding(5) var<storage, read_write> draw: array<u32, 5>;
@group(0) @binding(6) var<storage, read_write> last: array<u32, 3>;

@compute @workgroup_size(1)
fn finish() {
  let vertices = offsets[range.count];
  let indices = 3u * offsets[sizes.section + range.count];
  let fits = vertices <= sizes.vertices && indices <= sizes.indices;
  status[0] = range.needed;
  status[1] = sizes.nodes;
  status[2] = vertices;
  status[3] = sizes.vertices;
  status[4] = indices;
  status[5] = sizes.indices;
  status[6] = select(1u, 0u, fits);
  status[7] += 1u;
  status[8] = budget.coarser;
  let groups = (range.count + WORKGROUP - 1u) / WORKGROUP;
  last[0] = select(0u, min(groups, 32768u), fits);
  last[1] = (groups + 32767u) / 32768u;
  last[2] = 1u;
  if fits {
    draw[0] = indices;
    draw[1] = 1u;
    draw[2] = sizes.first_index;
    draw[3] = sizes.base_vertex;
    draw[4] = 0u;
  }
}
