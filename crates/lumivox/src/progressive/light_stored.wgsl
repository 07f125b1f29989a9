// Light stays until it is replaced. Not zero where samples of this frame have fallen.
@group(0) @binding(13) var<storage, read_write> reached: array<u32>;

// The first samples of a frame take the place of what is stored.
fn keeps_light(index: u32, adds: bool) -> bool {
    let is_of_this_frame = reached[index] != 0u;
    reached[index] = 1u;
    return adds && is_of_this_frame;
}
