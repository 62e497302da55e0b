// Rows of a net, halved along v by midpoints. (a + b)·0.5 is exact scaling of one rounded sum, so no
// compiler's fusing of multiply and add changes a bit.
//
// Trip counts are constants, inner ones too, so that drivers unroll the loops and a row stays in
// registers.

// Row r of cells c and c + 1: its halves if `split`, else cell c has it as it is. The triangle of
// midpoints stands in the row itself: after each level its first point is the next of the first half,
// and at last it is the second half.
fn write_row(e: Emission, c: u32, split: bool, row: array<vec4f, COLUMNS>, r: u32) {
  var line = row;
  if split {
    let to = place(e, c) * POINTS + r * COLUMNS;
    for (var level = 0u; level < COLUMNS; level++) {
      if lives(e, c) {
        next_nets[to + level] = line[0];
      }
      for (var k = 0u; k + 1u < COLUMNS; k++) {
        if k + level + 1u < COLUMNS {
          line[k] = (line[k] + line[k + 1u]) * 0.5;
        }
      }
    }
  }
  let last = select(c, c + 1u, split);
  if lives(e, last) {
    let to = place(e, last) * POINTS + r * COLUMNS;
    for (var k = 0u; k < COLUMNS; k++) {
      next_nets[to + k] = line[k];
    }
  }
}
