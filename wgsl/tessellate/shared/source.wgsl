// How a derivation says what it made, which is taken in each frame: gpu/tessellate/buffers.rs.

struct Source {
  // vec4u of a record.
  quads: u32,
  // The symbol of erased cells.
  hole: u32,
  // Slots of the table.
  slots: u32,
  reserved_0: u32,
}
