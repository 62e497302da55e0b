// Both halves of a cubic Bézier curve by midpoints. (a + b)·0.5 is exact scaling of one rounded
// sum, so no compiler's fusing of multiply and add changes a bit.

// Control points of the halves; the last of the first is the first of the second.
struct Halves {
  a0: vec4f,
  a1: vec4f,
  a2: vec4f,
  middle: vec4f,
  b1: vec4f,
  b2: vec4f,
  b3: vec4f,
}

fn halve(p0: vec4f, p1: vec4f, p2: vec4f, p3: vec4f) -> Halves {
  let ab = (p0 + p1) * 0.5;
  let bc = (p1 + p2) * 0.5;
  let cd = (p2 + p3) * 0.5;
  let abc = (ab + bc) * 0.5;
  let bcd = (bc + cd) * 0.5;
  return Halves(p0, ab, abc, (abc + bcd) * 0.5, bcd, cd, p3);
}
