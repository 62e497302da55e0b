// Between two sweeps of a recorded derivation: how long the word is now, what time it is, whether its derive
// has come to its end, and the workgroups of what comes next: plan/turns.rs. The host does the same for a
// derivation that waits: plan/derive.rs.
//
// One invocation: reads some 60 bytes and writes 80.

import extent;
import progress;
import workgroups;

struct Turn {
  index: u32,
  growth: u32,
  flags: u32,
  children: u32,
}

@group(0) @binding(0) var<uniform> turn: Turn;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read_write> status: Status;
@group(0) @binding(3) var<storage, read_write> extents: array<u32>;
@group(0) @binding(4) var<storage, read_write> dispatches: array<vec4u>;
@group(0) @binding(5) var<storage, read_write> progress: Progress;

const ENDS_STEP = 1u;
const ENDS_DERIVE = 2u;
const UNTIL_TERMINAL = 4u;
const STARTS = 8u;

// Words from one extent to the next, and of an extent: uniforms begin at multiples of 256 bytes.
const EXTENT_WORDS = 64u;
const CAPACITY = 1u;
const RUN_STEP = 4u;
const HALTED = 7u;
const BEHIND = 9u;

// Before the first sweep; the host has written its extent.
@compute @workgroup_size(1)
fn start() {
  progress.modules = extents[0];
  progress.needed = extents[0];
  progress.capacity = extents[CAPACITY];
  progress.too_deep = 0u;
  progress.steps = 0u;
  progress.frame += 1u;
  atomicStore(&status.fired, 0u);
  atomicStore(&status.too_deep, 0u);
}

@compute @workgroup_size(1)
fn proceed() {
  let at = turn.index * EXTENT_WORDS;
  let count = extents[at];
  // Sums wrap at 2^32, which no word with room comes near.
  var total = turn.growth * count;
  var fired = min(total, 1u);
  if turn.growth == 0u {
    fired = atomicLoad(&status.fired);
    if count > 0u {
      total = offsets[count];
    }
  }
  progress.needed = max(progress.needed, total);
  progress.too_deep |= atomicLoad(&status.too_deep);
  // The point at which a turtle starts stands there.
  if total == 0u && (turn.flags & STARTS) != 0u {
    total = 1u;
  }
  // A word that is not whole is none.
  if progress.needed > progress.capacity || progress.too_deep != 0u {
    total = 0u;
  }
  progress.fired |= fired;
  atomicStore(&status.fired, 0u);
  if (turn.flags & ENDS_STEP) != 0u {
    if (turn.flags & UNTIL_TERMINAL) != 0u && progress.fired == 0u {
      progress.halted = 1u;
    }
    if progress.halted == 0u {
      progress.steps += 1u;
    }
    progress.fired = 0u;
  }
  if (turn.flags & ENDS_DERIVE) != 0u {
    progress.halted = 0u;
  }
  progress.modules = total;
  let next = turn.index + 1u;
  extents[next * EXTENT_WORDS] = total;
  extents[next * EXTENT_WORDS + RUN_STEP] = progress.steps;
  extents[next * EXTENT_WORDS + HALTED] = progress.halted;
  extents[next * EXTENT_WORDS + BEHIND] = total;
  // For an invocation a module, for their scan, and for their children.
  dispatches[3u * next] = vec4u(workgroups(total, WORKGROUP), 0u);
  dispatches[3u * next + 1u] = vec4u(workgroups(total, TILE), 0u);
  dispatches[3u * next + 2u] = vec4u(workgroups(total, turn.children), 0u);
}
