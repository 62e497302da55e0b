// How far a tolerance is raised to keep to a budget of triangles: tessellate/budget.rs.

struct Budget {
  // In quarters of an octave.
  coarser: u32,
  // Not 0: this frame keeps to it.
  fits: u32,
  // Of the round that ran last.
  triangles: u32,
  reserved: u32,
}

const MOST_RAISED = 120u;

// 2^(quarters / 4), with one rounding.
fn raised(quarters: u32) -> f32 {
  var part = 1.0;
  switch quarters & 3u {
    case 1u: { part = 1.1892071; }
    case 2u: { part = 1.4142135; }
    case 3u: { part = 1.6817928; }
    default: {}
  }
  return part * f32(1u << (quarters >> 2u));
}
