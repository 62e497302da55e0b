// Elementary functions and hashes: the same text as src/language/elementary.rs, operation by
// operation.

import numbers;

fn quarter_turns(x: f32) -> vec2f {
  let n = round(x * 0.63661975);
  let r = ((x - n * 1.5703125) - n * 0.0004837513) - n * 0.0000000754979;
  let quadrant = n - 4.0 * floor(n * 0.25);
  return vec2f(quadrant, min(max(r, -0.79), 0.79));
}

fn sin_of_rest(r: f32) -> f32 {
  let z = r * r;
  return ((-0.00019515296 * z + 0.008332161) * z - 0.16666655) * z * r + r;
}

fn cos_of_rest(r: f32) -> f32 {
  let z = r * r;
  return 1.0 - z * (0.5 - z * ((0.000024433157 * z - 0.0013887316) * z + 0.041666646));
}

fn portable_sin(x: f32) -> f32 {
  if is_special(x) {
    return not_a_number();
  }
  let t = quarter_turns(x);
  if t.x == 0.0 {
    return sin_of_rest(t.y);
  }
  if t.x == 1.0 {
    return cos_of_rest(t.y);
  }
  if t.x == 2.0 {
    return -sin_of_rest(t.y);
  }
  return -cos_of_rest(t.y);
}

fn portable_cos(x: f32) -> f32 {
  if is_special(x) {
    return not_a_number();
  }
  let t = quarter_turns(x);
  if t.x == 0.0 {
    return cos_of_rest(t.y);
  }
  if t.x == 1.0 {
    return -sin_of_rest(t.y);
  }
  if t.x == 2.0 {
    return -cos_of_rest(t.y);
  }
  return sin_of_rest(t.y);
}

fn portable_tan(x: f32) -> f32 {
  if is_special(x) {
    return not_a_number();
  }
  return portable_sin(x) / portable_cos(x);
}

fn power_of_two(n: f32) -> f32 {
  return bitcast<f32>(u32(i32(n) + 127) << 23u);
}

fn exp_of_rest(n: f32, r: f32) -> f32 {
  let p = ((((0.00019875691 * r + 0.0013981999) * r + 0.008333452) * r + 0.041665796) * r + 0.16666665) * r + 0.5;
  let y = (p * r * r + r) + 1.0;
  let half = floor(n * 0.5);
  return (y * power_of_two(half)) * power_of_two(n - half);
}

fn portable_exp(x: f32) -> f32 {
  if is_nan(x) {
    return not_a_number();
  }
  let c = clamped(x, -87.0, 88.0);
  let n = round(c * 1.442695);
  let r = (c - n * 0.6933594) - n * -0.00021219444;
  return exp_of_rest(n, r);
}

fn portable_exp2(x: f32) -> f32 {
  if is_nan(x) {
    return not_a_number();
  }
  let c = clamped(x, -126.0, 127.0);
  let n = round(c);
  return exp_of_rest(n, (c - n) * 0.6931472);
}

fn portable_log(x: f32) -> f32 {
  // The greatest float lies below infinity.
  if !is_at_most(x, bitcast<f32>(0x7f7fffffu)) {
    return x;
  }
  if is_at_most(x, 0.0) {
    return bitcast<f32>(0xff7fffffu);
  }
  let bits = bitcast<u32>(x);
  var e = f32(bits >> 23u) - 126.0;
  var m = bitcast<f32>((bits & 0x007fffffu) | 0x3f000000u);
  if m < 0.70710677 {
    e -= 1.0;
    m += m;
  }
  m -= 1.0;
  let z = m * m;
  let p = ((((((((0.070376836 * m - 0.1151461) * m + 0.11676998) * m - 0.12420141) * m + 0.14249323) * m - 0.16668057) * m + 0.20000714) * m - 0.24999994) * m + 0.3333333) * m * z;
  let y = (p + e * -0.00021219444) - 0.5 * z;
  return (m + y) + e * 0.6933594;
}

fn portable_log2(x: f32) -> f32 {
  let natural = portable_log(x);
  // The least float, infinity and what is not a number stay.
  if magnitude(natural) >= 0x7f7fffffu {
    return natural;
  }
  return natural * 1.442695;
}

fn portable_pow(x: f32, y: f32) -> f32 {
  if magnitude(y) == 0u {
    return 1.0;
  }
  if is_nan(x) || is_nan(y) {
    return not_a_number();
  }
  if is_at_most(x, 0.0) {
    return 0.0;
  }
  if is_equal(x, 1.0) {
    return 1.0;
  }
  if is_special(x) || is_special(y) {
    return portable_exp(select(-87.0, 88.0, is_less(1.0, x) == is_less(0.0, y)));
  }
  return portable_exp(y * portable_log(x));
}

fn portable_atan(x: f32) -> f32 {
  if is_nan(x) {
    return not_a_number();
  }
  if is_special(x) {
    return select(1.5707964, -1.5707964, sign_bit(x) != 0u);
  }
  let a = abs(x);
  var base = 0.0;
  var t = a;
  if a > 2.4142137 {
    base = 1.5707964;
    t = -1.0 / a;
  } else if a > 0.41421357 {
    base = 0.7853982;
    t = (a - 1.0) / (a + 1.0);
  }
  let z = t * t;
  let p = (((0.08053744 * z - 0.13877686) * z + 0.19977711) * z - 0.3333295) * z * t + t;
  let y = base + p;
  return select(y, -y, x < 0.0);
}

// Of a coordinate where one of two is infinite.
fn far_off(c: f32) -> f32 {
  return select(0.0, select(1.0, -1.0, sign_bit(c) != 0u), is_special(c));
}

fn portable_atan2(given_y: f32, given_x: f32) -> f32 {
  if is_nan(given_y) || is_nan(given_x) {
    return not_a_number();
  }
  var y = given_y;
  var x = given_x;
  if is_special(y) || is_special(x) {
    y = far_off(given_y);
    x = far_off(given_x);
  }
  if x == 0.0 {
    return select(select(0.0, -1.5707964, y < 0.0), 1.5707964, y > 0.0);
  }
  let a = portable_atan(y / x);
  if x > 0.0 {
    return a;
  }
  if y < 0.0 {
    return a - 3.1415927;
  }
  return a + 3.1415927;
}

fn portable_asin(x: f32) -> f32 {
  if is_nan(x) {
    return not_a_number();
  }
  let c = clamped(x, -1.0, 1.0);
  return portable_atan2(c, sqrt((1.0 - c) * (1.0 + c)));
}

fn portable_acos(x: f32) -> f32 {
  if is_nan(x) {
    return not_a_number();
  }
  let c = clamped(x, -1.0, 1.0);
  return portable_atan2(sqrt((1.0 - c) * (1.0 + c)), c);
}

fn hash_word(state: u32, word: u32) -> u32 {
  var h = (state ^ word) * 0x9e3779b1u + 0x85ebca77u;
  h ^= h >> 16u;
  h *= 0x85ebca6bu;
  h ^= h >> 13u;
  h *= 0xc2b2ae35u;
  return h ^ (h >> 16u);
}

// The upper word of a * b.
fn scale_word(a: u32, b: u32) -> u32 {
  let ah = a >> 16u;
  let al = a & 0xffffu;
  let bh = b >> 16u;
  let bl = b & 0xffffu;
  let middle = ah * bl + ((al * bl) >> 16u);
  let other = al * bh + (middle & 0xffffu);
  return ah * bh + (middle >> 16u) + (other >> 16u);
}

fn slices_of_hash(h: u32) -> u32 {
  return (h >> 16u) + (h & 0xffffu);
}

fn unit_of_hash(h: u32) -> f32 {
  return f32(h >> 8u) * 0.000000059604645;
}

fn fade(t: f32) -> f32 {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

fn gradient(i: vec3f, x: f32, y: f32, z: f32) -> f32 {
  let word = bitcast<vec3u>(vec3i(i));
  let h = hash_word(hash_word(hash_word(0u, word.x), word.y), word.z) & 15u;
  let u = select(y, x, h < 8u);
  let v = select(select(z, x, h == 12u || h == 14u), y, h < 4u);
  return select(-u, u, (h & 1u) == 0u) + select(-v, v, (h & 2u) == 0u);
}

fn between(a: f32, b: f32, t: f32) -> f32 {
  return a + t * (b - a);
}

fn noise_edge(c: vec3f, d: vec3f, t: f32, j: f32, k: f32) -> f32 {
  let y = d.y - j;
  let z = d.z - k;
  let a = gradient(vec3f(c.x, c.y + j, c.z + k), d.x, y, z);
  let b = gradient(vec3f(c.x + 1.0, c.y + j, c.z + k), d.x - 1.0, y, z);
  return between(a, b, t);
}

fn gradient_noise(x: f32, y: f32, z: f32) -> f32 {
  if is_nan(x) || is_nan(y) || is_nan(z) {
    return not_a_number();
  }
  let p = vec3f(clamped(x, -1048576.0, 1048576.0), clamped(y, -1048576.0, 1048576.0), clamped(z, -1048576.0, 1048576.0));
  let c = floor(p);
  let d = p - c;
  let t = vec3f(fade(d.x), fade(d.y), fade(d.z));
  let low = between(noise_edge(c, d, t.x, 0.0, 0.0), noise_edge(c, d, t.x, 1.0, 0.0), t.y);
  let high = between(noise_edge(c, d, t.x, 0.0, 1.0), noise_edge(c, d, t.x, 1.0, 1.0), t.y);
  return between(low, high, t.z);
}
