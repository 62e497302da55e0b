// Sums as a scan has them: wrapping at 2^32, those of tiles in `sums`, with the total after the last.
alias Element = u32;

fn identity() -> u32 {
  return 0u;
}

fn composed(first: u32, second: u32) -> u32 {
  return first + second;
}

fn kept(tile: u32) -> u32 {
  return sums[tile];
}

fn keep(tile: u32, sum: u32) {
  sums[tile] = sum;
}

fn entered() -> u32 {
  return 0u;
}

fn leave(total: u32) {
  sums[tile_count(extent.count)] = total;
}
