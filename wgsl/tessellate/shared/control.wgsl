// A root's control points in its canonical orientation: tessellate/surface.rs.

var<private> net: array<vec4f, POINTS>;

// Where point (r, c) of the canonical net stands in the file's: tessellate/orientation.rs.
fn place_in_file(orientation: u32, r: u32, c: u32) -> u32 {
  var a = r;
  var b = c;
  if (orientation & 4u) != 0u {
    a = c;
    b = r;
  }
  if (orientation & 1u) != 0u {
    a = ROWS - 1u - a;
  }
  if (orientation & 2u) != 0u {
    b = COLUMNS - 1u - b;
  }
  return a * COLUMNS + b;
}

fn load_net(root: u32) {
  let orientation = orientation_of(root);
  let base = root * POINTS;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      net[r * COLUMNS + c] = nets[base + place_in_file(orientation, r, c)];
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
