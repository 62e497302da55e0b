// The leaves of the word as the nodes of the first level, and the table in which they are found: tessellate/word.rs.
//
// Which slot a leaf takes hangs on who comes first; which leaf is found in a place does not.
//
// forget: an invocation a slot. enter: a leaf, reads 16 bytes and writes 24. arrange: one workgroup.

import lattice;
import hash;
import source;

@group(0) @binding(0) var<uniform> range: Range;
@group(0) @binding(1) var<uniform> source: Source;
@group(0) @binding(2) var<storage, read> adopted: u32;
@group(0) @binding(3) var<storage, read> leaves: array<vec4u>;
@group(0) @binding(4) var<storage, read_write> leaves_before: array<u32>;
@group(0) @binding(5) var<storage, read_write> nodes: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> table: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> shapes: array<atomic<u32>, SHAPES>;

fn shape_of(n: vec4u) -> u32 {
  return (n.y & 0xffu) * LEVELS + ((n.y >> 8u) & 0xffu);
}

@compute @workgroup_size(WORKGROUP)
fn forget(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k < source.slots {
    atomicStore(&table[SLOTS + k], 0u);
  }
  if k < SHAPES {
    atomicStore(&shapes[k], 0u);
  }
}

@compute @workgroup_size(WORKGROUP)
fn enter(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
  let k = linear(id, groups);
  if k >= range.count {
    return;
  }
  if adopted != 0u {
    nodes[k] = leaves[k];
  } else {
    leaves_before[k] = k;
  }
  let n = nodes[k];
  atomicAdd(&shapes[shape_of(n)], 1u);
  let mask = source.slots - 1u;
  var slot = hash(n.x, n.y & 0xffffu, n.z, n.w) & mask;
  for (var probes = 0u; probes <= mask; probes++) {
    // Exchanging may fail without a reason; then the slot is still free.
    let found = atomicCompareExchangeWeak(&table[SLOTS + slot], 0u, k + 1u);
    if found.exchanged {
      break;
    }
    if found.old_value != 0u {
      slot = (slot + 1u) & mask;
    }
  }
}

// The shapes that occur, the commonest first.
@compute @workgroup_size(WORKGROUP)
fn arrange(@builtin(local_invocation_index) local: u32) {
  for (var s = local; s < SHAPES; s += WORKGROUP) {
    let count = atomicLoad(&shapes[s]);
    var before = 0u;
    var all = 0u;
    for (var other = 0u; other < SHAPES; other++) {
      let c = atomicLoad(&shapes[other]);
      all += select(0u, 1u, c != 0u);
      before += select(0u, 1u, c > count || (c == count && c != 0u && other < s));
    }
    if count != 0u {
      atomicStore(&table[2u + before], (s / LEVELS) | ((s % LEVELS) << 8u));
    }
    if s == 0u {
      atomicStore(&table[0], all);
    }
  }
}
