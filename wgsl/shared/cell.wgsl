// The address of a child: plan/layout.rs.

import address;

// `child` has its symbol and parameters; this gives it the address of cell (hu, hv) of `m`.
fn with_address(child: Record, m: Record, halves: u32, hu: u32, hv: u32) -> Record {
  let su = halves & 1u;
  let sv = halves >> 1u;
  let du = ((m.q0.x >> 16u) & 0xffu) + su;
  let dv = (m.q0.x >> 24u) + sv;
  // The new bits stand left-aligned behind those that are there: row bit first.
  let bits = (hu << sv) | hv;
  let shift = (64u - du - dv) & 63u;
  var high = m.q0.z;
  var low = m.q0.w;
  if du + dv != 0u {
    if shift >= 32u {
      high |= bits << (shift - 32u);
    } else {
      low |= bits << shift;
      // Two bits may straddle the words.
      if shift == 31u {
        high |= bits >> 1u;
      }
    }
  }
  var r = child;
  r.q0 = vec4u((child.q0.x & 0xffffu) | (du << 16u) | (dv << 24u), m.q0.y, high, low);
  r.q1.x = (m.q1.x << su) | hu;
  r.q1.y = (m.q1.y << sv) | hv;
  return r;
}
