// Listed tiles as quads, after the part for tiles. The shader that uses this binds `tiles` and `tile_list`.

struct TileVertex {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) tile: u32,
}

// A corner of a listed tile: two triangles of corners 0 1 2 and 1 2 3.
@vertex
fn tile_corner(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> TileVertex {
    let tile = tile_list[instance];
    let number = select(vertex - 2u, vertex, vertex < 3u);
    let corner = vec2u(tile % tiles.tiles.x, tile / tiles.tiles.x) + vec2u(number & 1u, number >> 1u);
    let uv = vec2f(min(corner * TILE_SIDE, tiles.size)) / vec2f(tiles.size);
    return TileVertex(vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0), tile);
}
