// What a ray met. The shader that uses this binds `table` and `surfels`, and what rays need.

// The surfel that a sub-cell belongs to, on the side that a ray entered through; else on the side that faces it most.
fn surfel_met(met: March, towards: vec3f) -> u32 {
    let at = SIDES * cell_index(grid, vec3u(met.at / SUBCELLS));
    let bit = subcell_bit(met.at);
    var best = DARK_HIT;
    var best_along = 0.0;
    for (var side = 0u; side < SIDES; side++) {
        let place = table[at + side];
        if place == NO_SURFEL || !has_bit(surfels[place].zw, bit) {
            continue;
        }
        let face = side / 2u;
        let along = dot(towards, FACE_NORMALS[face]) + select(0.0, 2.0, face == met.face);
        if along > best_along {
            best = place;
            best_along = along;
        }
    }
    return best;
}
