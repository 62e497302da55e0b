// The modules of a word that was derived anew, as leaves: canonical, each with the node that had its cell in the
// frame before. Nothing that stands is changed, since the word may yet turn out to be none.
//
// An invocation a module: reads 24 bytes of its record and about 40 more, writes 20.

import lattice;
import topology;
import progress;
import source;
import table;

@group(0) @binding(0) var<uniform> source: Source;
@group(0) @binding(1) var<storage, read> progress: Progress;
@group(0) @binding(2) var<storage, read> records: array<vec4u>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> nodes: array<vec4u>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read_write> leaves: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> leaves_before: array<u32>;
@group(0) @binding(8) var<storage, read_write> too_deep: atomic<u32>;

// The file's halvings, row and column of a cell as canonical ones: tessellate/orientation.rs.
fn canonical(root: u32, depth: vec2u, cell: vec2u) -> vec4u {
  let orientation = orientation_of(root);
  let last = (vec2u(1u) << depth) - vec2u(1u);
  var turned_cell = cell;
  if (orientation & 1u) != 0u {
    turned_cell.x = last.x - cell.x;
  }
  if (orientation & 2u) != 0u {
    turned_cell.y = last.y - cell.y;
  }
  let across = (orientation & 4u) != 0u;
  return vec4u(select(depth, depth.yx, across), select(turned_cell, turned_cell.yx, across));
}

@compute @workgroup_size(WORKGROUP)
fn recall(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k >= progress.modules {
    return;
  }
  let head = records[k * source.quads];
  let place = records[k * source.quads + 1u].xy;
  let root = head.y;
  let depth = vec2u((head.x >> 16u) & 0xffu, head.x >> 24u);
  if any(depth >= vec2u(LEVELS)) {
    atomicStore(&too_deep, 1u);
    return;
  }
  let symbol = head.x & 0xffffu;
  let hole = symbol == source.hole || is_void(root);
  let c = canonical(root, depth, place);
  let shape = c.x | (c.y << 8u);
  leaves[k] = vec4u(root, shape | ((symbol & 0x7fffu) << 16u) | select(0u, 0x80000000u, hole), c.zw);
  leaves_before[k] = leaf_at(root, shape, c.zw);
}
