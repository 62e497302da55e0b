// A root's control points in its canonical orientation: tessellate/surface/mod.rs.
//
// Rows and columns are indices of their own and loops run over all of each, so that drivers unroll them and keep
// the net in registers.

// As they lie about the root's own place, in units of its size: tessellate/surface/place.rs.
var<private> net: array<array<vec4f, COLUMNS>, ROWS>;

// The root, the origin for its points, and a power of two.
var<private> net_root: u32;
var<private> net_origin: vec3f;
var<private> net_size: f32;

// Where point (r, c) of the canonical net stands in the file's: tessellate/orientation.rs.
fn place_in_file(orientation: u32, r: u32, c: u32) -> u32 {
  let turn = (orientation & 4u) != 0u;
  let a = select(r, c, turn);
  let b = select(c, r, turn);
  return select(a, ROWS - 1u - a, (orientation & 1u) != 0u) * COLUMNS
    + select(b, COLUMNS - 1u - b, (orientation & 2u) != 0u);
}

// Where a homogeneous point lies.
fn projected(p: vec4f) -> vec3f {
  if RATIONAL {
    return p.xyz / p.w;
  }
  return p.xyz;
}

// A homogeneous point with the origin moved.
fn about(p: vec4f, origin: vec3f) -> vec4f {
  if RATIONAL {
    return vec4f(p.xyz - origin * p.w, p.w);
  }
  return vec4f(p.xyz - origin, p.w);
}

// 1 / size, exactly.
fn inverse_size() -> f32 {
  return bitcast<f32>((254u << 23u) - bitcast<u32>(net_size));
}

fn greatest(p: vec4f) -> f32 {
  let a = abs(p.xyz);
  return max(a.x, max(a.y, a.z));
}

// So many times its size away a net is far off.
const FAR_OFF = 4.0;

fn load_net(root: u32) {
  let orientation = orientation_of(root);
  let base = root * POINTS;
  let first = projected(nets[base + place_in_file(orientation, 0u, 0u)]);
  var far = 0.0;
  var about_first = 0.0;
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      let p = nets[base + place_in_file(orientation, r, c)];
      far = max(far, greatest(p));
      about_first = max(about_first, greatest(about(p, first)));
      net[r][c] = p;
    }
  }
  let is_far_off = far > FAR_OFF * about_first;
  let size = select(far, about_first, is_far_off);
  net_root = root;
  net_origin = select(vec3f(0.0), first, is_far_off);
  net_size = bitcast<f32>(clamp(bitcast<u32>(size) & 0x7f800000u, 1u << 23u, 253u << 23u));
  let inverse = inverse_size();
  for (var r = 0u; r < ROWS; r++) {
    for (var c = 0u; c < COLUMNS; c++) {
      let p = about(net[r][c], net_origin);
      net[r][c] = vec4f(p.xyz * inverse, p.w);
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
