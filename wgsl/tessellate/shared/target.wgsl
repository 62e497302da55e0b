// How fine a tessellation is to be: tessellate/level.rs.

struct Target {
  clip: mat4x4f,
  half_size: vec2f,
  near: f32,
  tolerance: f32,
  keep: f32,
  pixels: u32,
  least: u32,
  most: u32,
  // Triangles; 0 for as many as it takes.
  budget: u32,
  reserved_0: u32,
  reserved_1: u32,
  reserved_2: u32,
}
