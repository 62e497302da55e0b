// The middle of a prefix sum, by one workgroup: the tiles' sums become their exclusive prefix sums,
// and the total stands behind the last.

@compute @workgroup_size(WORKGROUP)
fn spine(@builtin(local_invocation_index) local: u32) {
  let tiles = tile_count(extent.count);
  let each = (tiles + WORKGROUP - 1u) / WORKGROUP;
  let start = min(local * each, tiles);
  let end = min(start + each, tiles);
  var sum = 0u;
  for (var t = start; t < end; t++) {
    sum += sums[t];
  }
  let inclusive = workgroup_sum(local, sum);
  var running = inclusive - sum;
  for (var t = start; t < end; t++) {
    let here = sums[t];
    sums[t] = running;
    running += here;
  }
  if local == WORKGROUP - 1u {
    sums[tiles] = inclusive;
  }
}
