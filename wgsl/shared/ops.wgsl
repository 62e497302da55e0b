// Operations of the table (src/language/ops.rs) that need more than an expression.

// As functions, so that a divisor that is a constant 0 is no error of the shader: x / 0 = x.
fn int_div(a: i32, b: i32) -> i32 {
  return a / b;
}

// x % 0 = 0
fn int_rem(a: i32, b: i32) -> i32 {
  return a % b;
}
