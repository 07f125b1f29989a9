// What a ray sees. The shader that uses this binds `shown` and `sky`, and what is needed to know what a ray met.

// Radiance that arrives at a point in sub-cells from a direction.
fn radiance_along(origin: vec3f, direction: vec3f) -> vec3f {
    let met = march(origin, direction, 1e9);
    if met.ended != MET_SUBCELL {
        return sky[sky_square(direction)].rgb;
    }
    let place = surfel_met(met, -direction);
    if place == DARK_HIT {
        return vec3f(0.0);
    }
    return unpack_half4(shown[place].xy).rgb;
}
