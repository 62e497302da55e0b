// The point at which a turtle starts: the trace of a word of which nothing is left (plan/turtle.rs). It stands where the
// first point of the trace goes, if there is one.

@group(0) @binding(0) var<uniform> start: array<vec4u, QUADS>;
@group(0) @binding(1) var<storage, read_write> next_records: array<vec4u>;

@compute @workgroup_size(1)
fn start_word() {
  for (var q = 0u; q < QUADS; q++) {
    next_records[HALO * QUADS + q] = start[q];
  }
}
