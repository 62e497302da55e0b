// What there is to write, whether it fits, and the arguments of the draw. Where it does not fit nothing is
// written: what the buffers hold of the frame before, and the arguments of its draw, stay.

import lattice;
import budget;
import workgroups;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> budget: Budget;
@group(0) @binding(4) var<storage, read_write> status: array<u32, 12>;
@group(0) @binding(5) var<storage, read_write> draw: array<u32>;
@group(0) @binding(6) var<storage, read_write> last: vec4u;

@compute @workgroup_size(1)
fn finish() {
  let vertices = offsets[range.count];
  let indices = 3u * offsets[sizes.section + range.count];
  // Without a word, and none from before: adopt.wgsl.
  let nothing = range.count == 0u && (status[9] > status[10] || status[11] != 0u);
  let fits = vertices <= sizes.vertices && indices <= sizes.indices && !nothing;
  status[0] = range.needed;
  status[1] = sizes.nodes;
  status[2] = vertices;
  status[3] = sizes.vertices;
  status[4] = indices;
  status[5] = sizes.indices;
  status[6] = select(1u, 0u, fits);
  status[7] += 1u;
  status[8] = budget.coarser;
  last = vec4u(select(vec3u(0u), workgroups(range.count, WORKGROUP), fits), 0u);
  if fits {
    let at = sizes.draw_word;
    draw[at] = indices;
    draw[at + 1u] = 1u;
    draw[at + 2u] = sizes.first_index;
    draw[at + 3u] = sizes.base_vertex;
    draw[at + 4u] = 0u;
  }
}
