// Scans of what is composed rather than added up, in order: reduce, spine, then down, as in prefix.wgsl. The kernel says
// what an `Element` is, which one changes nothing (`identity`), and how two become one (`composed`, the first one first).

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
