// Scans, of numbers that are added up and of what is composed in order: reduce, spine, then down.
//
// Three dispatches and no spinning: WebGPU promises no progress between workgroups, and some drivers end a loop that
// waits. Each invocation takes ITEMS consecutive elements, which are read twice and written once. ITEMS is large on CPU
// drivers, where barriers and loads are dear, and 16 elsewhere: 64 bytes of u32 an invocation, whole cache lines.
//
// The kernel says what an `Element` is, which one changes nothing (`identity`), and how two become one (`composed`, the
// first one first); what an invocation's elements are together (`element_of`); where those of tiles are (`kept`, `keep`);
// what stands before the first tile (`entered`), and what becomes of all (`leave`).

import tiles;

var<workgroup> partial: array<Element, WORKGROUP>;

// Inclusive composition over the workgroup.
fn workgroup_composed(local: u32, element: Element) -> Element {
  partial[local] = element;
  workgroupBarrier();
  for (var distance = 1u; distance < WORKGROUP; distance = distance << 1u) {
    var before = identity();
    if local >= distance {
      before = partial[local - distance];
    }
    workgroupBarrier();
    if local >= distance {
      partial[local] = composed(before, partial[local]);
    }
    workgroupBarrier();
  }
  return partial[local];
}

// What stands before an invocation in its workgroup.
fn before_of(local: u32) -> Element {
  if local == 0u {
    return identity();
  }
  return partial[local - 1u];
}

// What is an invocation's own.
struct Own {
  tile: u32,
  start: u32,
  end: u32,
}

fn own_of(group: vec3u, groups: vec3u, local: u32) -> Own {
  let tile = tile_of(group, groups);
  let start = min(tile * TILE + local * ITEMS, extent.count);
  return Own(tile, start, min(start + ITEMS, extent.count));
}

@compute @workgroup_size(WORKGROUP)
fn reduce(
  @builtin(workgroup_id) group: vec3u,
  @builtin(num_workgroups) groups: vec3u,
  @builtin(local_invocation_index) local: u32,
) {
  let own = own_of(group, groups, local);
  let inclusive = workgroup_composed(local, element_of(own.start, own.end));
  if local == WORKGROUP - 1u && own.tile < tile_count(extent.count) {
    keep(own.tile, inclusive);
  }
}

// The middle, by one workgroup: each tile keeps what stands before it.
@compute @workgroup_size(WORKGROUP)
fn spine(@builtin(local_invocation_index) local: u32) {
  let tiles = tile_count(extent.count);
  let each = (tiles + WORKGROUP - 1u) / WORKGROUP;
  let start = min(local * each, tiles);
  let end = min(start + each, tiles);
  var element = identity();
  for (var t = start; t < end; t++) {
    element = composed(element, kept(t));
  }
  let inclusive = workgroup_composed(local, element);
  let first = entered();
  var state = composed(first, before_of(local));
  for (var t = start; t < end; t++) {
    let here = kept(t);
    keep(t, state);
    state = composed(state, here);
  }
  // What all enter with may stand where the last one leaves.
  storageBarrier();
  workgroupBarrier();
  if local == WORKGROUP - 1u {
    leave(composed(first, inclusive));
  }
}
