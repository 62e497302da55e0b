//! Leaves to triangles: the pure definitions.
