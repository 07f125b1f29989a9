// A picture cut into tiles.

struct TileUniform {
    // Tiles, and texels, along x and y.
    tiles: vec2u,
    size: vec2u,
    object_count: u32,
    // Words of a tile's set of objects; one more for each 32 of them says which hold any.
    words: u32,
    // How far occlusion reaches beyond an object's sphere, in metres, and to how many of its radii at most.
    reach: f32,
    reach_in_radii: f32,
    // A sphere around the light, for shadows, or the way to a sun and the tangent of its angle.
    light: vec3f,
    light_radius: f32,
    // One of the ROUND_ constants: what the objects of a tile are looked for round.
    kind: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

const TILE_SIDE: u32 = 8u;

// Words that say which of a tile's words hold any objects, behind those.
fn filled_words() -> u32 {
    return (tiles.words + 31u) / 32u;
}

// Where a tile's set begins.
fn first_word(tile: u32) -> u32 {
    return tile * (tiles.words + filled_words());
}
