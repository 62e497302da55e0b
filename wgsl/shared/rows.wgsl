// Rows of a net, halved along v by midpoints. (a + b)·0.5 is exact scaling of one rounded sum, so no
// compiler's fusing of multiply and add changes a bit.
//
// Trip counts are constants, inner ones too, so that drivers unroll the loops and a row stays in
// registers.

// Row r of the cells at `left` and `right`: its halves if `split`, else `left` has it as it is. The
// triangle of midpoints stands in the row itself: after each level its first point is the next of
// the first half, and at last it is the second half.
fn write_row(split: bool, row: array<vec4f, COLUMNS>, r: u32, left: u32, right: u32) {
  if left == NOWHERE && right == NOWHERE {
    return;
  }
  var line = row;
  if split {
    // Where the left cell does not live its points go to the right one, which is written over them.
    let to = select(left, right, left == NOWHERE) * POINTS + r * COLUMNS;
    for (var level = 0u; level < COLUMNS; level++) {
      next_nets[to + level] = line[0];
      for (var c = 0u; c + 1u < COLUMNS; c++) {
        if c + level + 1u < COLUMNS {
          line[c] = (line[c] + line[c + 1u]) * 0.5;
        }
      }
    }
  }
  let at = select(left, right, split);
  if at != NOWHERE {
    for (var c = 0u; c < COLUMNS; c++) {
      next_nets[at * POINTS + r * COLUMNS + c] = line[c];
    }
  }
}
