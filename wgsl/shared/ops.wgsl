// Operations of the table (src/language/ops.rs) that need more than an expression.

import numbers;
import elementary;

// Towards zero; x / 0 = x and the least int over -1 is itself. The divisor is replaced by hand:
// what WGSL defines some backends leave undefined.
fn int_div(a: i32, b: i32) -> i32 {
  let undefined = b == 0i || (b == -1i && a == (-2147483647i - 1i));
  return a / select(b, 1i, undefined);
}

// With the sign of a; a % 0 = 0. GLSL leaves negative operands of % undefined.
fn int_rem(a: i32, b: i32) -> i32 {
  if b == 0i {
    return 0i;
  }
  return a - int_div(a, b) * b;
}
