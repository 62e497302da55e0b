//! Points and normals of nets, and the grids made of them.
