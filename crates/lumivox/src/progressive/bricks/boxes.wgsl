// The boxes that something moved in. Goes with a shader that declares `bricks` and `boxes`.

// Whether a cube of so many metres a side touches one of them, or there are none.
fn may_change(low: vec3f, side: f32) -> bool {
    for (var n = 0u; n < bricks.box_count; n++) {
        if all(low <= boxes[2u * n + 1u].xyz) && all(low + side >= boxes[2u * n].xyz) {
            return true;
        }
    }
    return bricks.box_count == 0u;
}
