// What a ray sees. The shader that uses this binds `shown` and `sky`, and what is needed to know what a ray met.

// Radiance that arrives at a point in sub-cells from a direction, and whether it is known: what has no surfel on the side that
// a ray meets is the inside of something, which rays at a grazing angle may meet.
fn known_along(origin: vec3f, direction: vec3f) -> vec4f {
    let met = march(origin, direction, 1e9);
    if met.ended != MET_SUBCELL {
        return vec4f(sky[sky_square(direction)].rgb, 1.0);
    }
    let place = surfel_met(met, -direction);
    if place == DARK_HIT {
        return vec4f(0.0);
    }
    return vec4f(unpack_half4(shown[place].xy).rgb, 1.0);
}

fn radiance_along(origin: vec3f, direction: vec3f) -> vec3f {
    return known_along(origin, direction).rgb;
}
