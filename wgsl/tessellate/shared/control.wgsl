// A root's control points in its canonical orientation: tessellate/surface/mod.rs.
//
// Rows and columns are indices of their own and loops run over all of each, so that drivers unroll them and keep
// the net in registers.

var<private> net: array<array<vec4f, COLUMNS>, ROWS>;

// Where point (r, c) of the canonical net stands in the file's: tessellate/orientation.rs.
fn place_in_file(orientation: u32, r: u32, c: u32) -> u32 {
  let turn = (orientation & 4u) != 0u;
  let a = select(r, c, turn);
  let b = select(c, r, turn);
  return select(a, ROWS - 1u - a, (orientation & 1u) != 0u) * COLUMNS
    + select(b, COLUMNS - 1u - b, (orientation & 2u) != 0u);
}

fn load_net(root: u32) {
  let orientation = orientation_of(root);
  let base = root * POINTS;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      net[r][c] = nets[base + place_in_file(orientation, r, c)];
    }
  }
}

// Spelled out: drivers differ on `length`, `dot` and `normalize`.
fn length_of(v: vec3f) -> f32 {
  return sqrt((v.x * v.x + v.y * v.y) + v.z * v.z);
}

fn product_of(a: vec3f, b: vec3f) -> f32 {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
