// Floats told apart by their bits: src/language/numbers.rs.
//
// WGSL lets a driver assume that nothing is infinite or not a number (NaN), so what the language says of such values
// is spelled out: comparisons are those of integers, and arithmetic with such an operand never reaches the device's. So
// is the sign of a result of zero, which tells x / 0 from x / -0: drivers make -z of 0 - z, and 0 of 0 * z.

const INFINITE = 0x7f800000u;

// A function, since a constant expression may be no such number.
fn of_bits(bits: u32) -> f32 {
  return bitcast<f32>(bits);
}

fn not_a_number() -> f32 {
  return of_bits(0x7fc00000u);
}

fn magnitude(x: f32) -> u32 {
  return bitcast<u32>(x) & 0x7fffffffu;
}

fn sign_bit(x: f32) -> u32 {
  return bitcast<u32>(x) & 0x80000000u;
}

fn is_nan(x: f32) -> bool {
  return magnitude(x) > INFINITE;
}

// Infinite or not a number.
fn is_special(x: f32) -> bool {
  return magnitude(x) >= INFINITE;
}

// An integer in the order of floats; both zeros are one.
fn order_of(x: f32) -> i32 {
  let b = bitcast<i32>(x);
  return select(b, (-2147483647i - 1i) - b, b < 0i);
}

fn is_less(a: f32, b: f32) -> bool {
  let x = order_of(a);
  let y = order_of(b);
  // Beyond the infinities lies what is not a number.
  return x < y && x >= -0x7f800000i && y <= 0x7f800000i;
}

fn is_at_most(a: f32, b: f32) -> bool {
  let x = order_of(a);
  let y = order_of(b);
  return x <= y && x >= -0x7f800000i && y <= 0x7f800000i;
}

fn is_equal(a: f32, b: f32) -> bool {
  let x = order_of(a);
  return x == order_of(b) && abs(x) <= 0x7f800000i;
}

fn least_of(a: f32, b: f32) -> f32 {
  return select(a, b, is_less(b, a));
}

fn greatest_of(a: f32, b: f32) -> f32 {
  return select(a, b, is_less(a, b));
}

fn clamped(x: f32, low: f32, high: f32) -> f32 {
  return least_of(greatest_of(x, low), high);
}

fn sign_of(x: f32) -> f32 {
  // Of integers: drivers make -0 of a choice between 0 and -1.
  return f32(i32(is_less(0.0, x)) - i32(is_less(x, 0.0)));
}

fn negative_of(x: f32) -> f32 {
  return select(of_bits(bitcast<u32>(x) ^ 0x80000000u), x, is_nan(x));
}

// Of operands of which at least one is special.
fn special_sum(a: f32, b: f32) -> f32 {
  let apart = is_special(a) && is_special(b) && sign_bit(a) != sign_bit(b);
  if is_nan(a) || is_nan(b) || apart {
    return not_a_number();
  }
  return select(b, a, is_special(a));
}

fn sum_of(a: f32, b: f32) -> f32 {
  if is_special(a) || is_special(b) {
    return special_sum(a, b);
  }
  let sum = a + b;
  if magnitude(sum) == 0u {
    return of_bits(sign_bit(a) & sign_bit(b));
  }
  return sum;
}

fn difference_of(a: f32, b: f32) -> f32 {
  if is_special(a) || is_special(b) {
    return special_sum(a, negative_of(b));
  }
  let difference = a - b;
  if magnitude(difference) == 0u {
    return of_bits(sign_bit(a) & (sign_bit(b) ^ 0x80000000u));
  }
  return difference;
}

fn scalar_product(a: f32, b: f32) -> f32 {
  if is_special(a) || is_special(b) {
    if is_nan(a) || is_nan(b) || magnitude(a) == 0u || magnitude(b) == 0u {
      return not_a_number();
    }
    return of_bits((sign_bit(a) ^ sign_bit(b)) | INFINITE);
  }
  let product = a * b;
  if magnitude(product) == 0u {
    return of_bits(sign_bit(a) ^ sign_bit(b));
  }
  return product;
}

fn quotient_of(a: f32, b: f32) -> f32 {
  if is_special(a) || is_special(b) || magnitude(b) == 0u {
    let without = is_special(a) && is_special(b) || magnitude(a) == 0u && magnitude(b) == 0u;
    if is_nan(a) || is_nan(b) || without {
      return not_a_number();
    }
    return of_bits((sign_bit(a) ^ sign_bit(b)) | select(INFINITE, 0u, is_special(b)));
  }
  let quotient = a / b;
  if magnitude(quotient) == 0u {
    return of_bits(sign_bit(a) ^ sign_bit(b));
  }
  return quotient;
}

fn square_root(x: f32) -> f32 {
  if is_nan(x) || sign_bit(x) != 0u && magnitude(x) != 0u {
    return not_a_number();
  }
  if is_special(x) {
    return x;
  }
  return sqrt(x);
}

// Not whole only below 2^23.
fn has_fraction(x: f32) -> bool {
  return magnitude(x) < 0x4b000000u;
}

fn whole_below(x: f32) -> f32 {
  if has_fraction(x) {
    return floor(x);
  }
  return x;
}

fn whole_above(x: f32) -> f32 {
  if has_fraction(x) {
    return ceil(x);
  }
  return x;
}

fn nearest_whole(x: f32) -> f32 {
  if has_fraction(x) {
    return round(x);
  }
  return x;
}

fn whole_part(x: f32) -> f32 {
  if has_fraction(x) {
    return trunc(x);
  }
  return x;
}

fn to_int(x: f32) -> i32 {
  if is_nan(x) {
    return 0i;
  }
  return i32(clamped(x, -2147483648.0, 2147483520.0));
}
