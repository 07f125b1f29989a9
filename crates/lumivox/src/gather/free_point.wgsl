// Where a pixel looks from. The shader that uses this binds what rays need.

fn is_free(point: vec3f) -> bool {
    let at = vec3i(floor(point));
    return any(at < vec3i(0)) || any(at >= SUBCELLS * vec3i(grid.dims)) || empty_side(at) > 0;
}

// A point in free space just off a surface, in sub-cells: towards the eye it is free, but for sub-cells that the surface
// fills in part.
fn free_point(p: vec3f, n: vec3f, towards_eye: vec3f) -> vec3f {
    let surface = 4.0 * p + 0.6 * n;
    for (var step = 1; step < 5; step++) {
        let point = surface + 0.6 * f32(step) * towards_eye;
        if is_free(point) {
            return point;
        }
    }
    return surface + 0.6 * towards_eye;
}
