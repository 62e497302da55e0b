// The same bits, in a way that no compiler sees through: `zero` is 0 and stands in a uniform. Compilers may rearrange and
// fuse what is computed between two pins. What stands there has weights that are powers of two, or is one sum or product.
fn pin(p: vec3f) -> vec3f {
  return bitcast<vec3f>(bitcast<vec3u>(p) | vec3u(params.zero));
}

// What two rules make of a point, where the second counts so much.
fn blended(new_point: vec3f, old_point: vec3f, weight: f32) -> vec3f {
  return pin(pin(new_point * (1.0 - weight)) + pin(old_point * weight));
}

const NONE = 0xffffffffu;
