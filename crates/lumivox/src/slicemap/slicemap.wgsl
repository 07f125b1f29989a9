// What a slicemap holds. The shader that uses this binds `slicemap`, `slicemap_bits` (read) and `slicemap_extents` (read).

struct SlicemapUniform {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    eye_from_world: mat4x4f,
    size: vec2u,
    slices: u32,
    words: u32,
    near: f32,
    far: f32,
    sets: u32,
    bit_set: u32,
    is_local: u32,
    splits_faces: u32,
    far_depth: f32,
    reserved: u32,
}

// Metres along the view.
fn slicemap_distance(world: vec3f) -> f32 {
    return -(slicemap.eye_from_world * vec4f(world, 1.0)).z;
}

// Where a distance lies among the slices of a range: its whole part is the slice.
fn slicemap_place(distance: f32, near: f32, far: f32) -> f32 {
    return (distance - near) / max(far - near, 1e-30) * f32(slicemap.slices);
}

fn slicemap_slice(distance: f32, near: f32, far: f32) -> u32 {
    return u32(clamp(floor(slicemap_place(distance, near, far)), 0.0, f32(slicemap.slices) - 1.0));
}

fn slicemap_column(pixel: vec2u) -> u32 {
    return pixel.y * slicemap.size.x + pixel.x;
}

// The first word of a set of a column.
fn slicemap_word(column: u32, bit_set: u32) -> u32 {
    return (column * slicemap.sets + bit_set) * slicemap.words;
}

// Of a word's 32 slices from `first` on, those before `end`.
fn slicemap_bits_before(first: u32, end: u32) -> u32 {
    if end <= first {
        return 0u;
    }
    return select((1u << (end - first)) - 1u, 0xffffffffu, end - first >= 32u);
}
