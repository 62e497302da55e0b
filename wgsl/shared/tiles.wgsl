// Tiles of TILE = WORKGROUP·ITEMS elements, one a workgroup.

fn tile_count(count: u32) -> u32 {
  return (count + TILE - 1u) / TILE;
}

fn tile_of(group: vec3u, groups: vec3u) -> u32 {
  return group.x + group.y * groups.x;
}
