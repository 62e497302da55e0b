// Where the next level begins: behind the nodes that are there; and the workgroups for it, and for all nodes.

import lattice;
import budget;

struct Turn {
  level: u32,
}

@group(0) @binding(0) var<uniform> turn: Turn;
@group(0) @binding(1) var<uniform> sizes: Sizes;
@group(0) @binding(2) var<storage, read> offsets: array<u32>;
@group(0) @binding(3) var<storage, read> budget: Budget;
@group(0) @binding(4) var<storage, read_write> ranges: array<u32>;
@group(0) @binding(5) var<storage, read_write> dispatches: array<u32>;

// Words from one range to the next: uniforms begin at multiples of 256 bytes.
const RANGE_WORDS = 64u;
const ALONG_X = 32768u;

fn dispatch(at: u32, invocations: u32, workgroup: u32) {
  let groups = (invocations + workgroup - 1u) / workgroup;
  dispatches[at] = min(groups, ALONG_X);
  dispatches[at + 1u] = (groups + ALONG_X - 1u) / ALONG_X;
  dispatches[at + 2u] = 1u;
}

fn write_range(slot: u32, count: u32, first: u32, needed: u32) {
  let at = slot * RANGE_WORDS;
  ranges[at] = count;
  ranges[at + 1u] = first;
  ranges[at + 2u] = slot;
  ranges[at + 3u] = needed;
  dispatch(slot * 8u, count, WORKGROUP);
  dispatch(slot * 8u + 4u, count, sizes.tile);
}

@compute @workgroup_size(1)
fn advance() {
  // A later round of a frame that keeps to its budget changes nothing.
  if budget.fits != 0u {
    return;
  }
  let at = turn.level * RANGE_WORDS;
  let count = ranges[at];
  let end = ranges[at + 1u] + count;
  var splits = 0u;
  if count > 0u {
    splits = offsets[count];
  }
  let room = select((sizes.nodes - end) / 4u, 0u, sizes.nodes < end);
  let children = 4u * min(splits, room);
  var needed = end + 4u * splits;
  if turn.level > 0u {
    needed = max(needed, ranges[sizes.all * RANGE_WORDS + 3u]);
  }
  write_range(turn.level + 1u, children, end, 0u);
  write_range(sizes.all, end + children, 0u, needed);
}
