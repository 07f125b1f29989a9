// What thin absorbers leave of light at a point. The shader that uses this binds `slicemap`, `slicemap_bits`, `slicemap_extents` and
// `transmittance`, and counts ones by `slicemap_ones`.

struct TransmittanceUniform {
    through_0: vec3f,
    bias: f32,
    through_1: vec3f,
    interpolates: u32,
    through_2: vec3f,
    only_inside: u32,
    through_3: vec3f,
    reserved: f32,
}

// Surfaces of a set before a place in a column: whole slices, and of the slice that it lies in a part, if asked for.
fn surfaces_before(column: u32, bit_set: u32, place: f32) -> f32 {
    let word = slicemap_word(column, bit_set);
    let end = u32(clamp(floor(place), 0.0, f32(slicemap.slices)));
    var count = 0u;
    for (var n = 0u; 32u * n < end; n++) {
        count += slicemap_ones(slicemap_bits[word + n] & slicemap_bits_before(32u * n, end));
    }
    var partly = 0.0;
    if transmittance.interpolates != 0u && end < slicemap.slices && place > 0.0 {
        partly = fract(place) * f32((slicemap_bits[word + end / 32u] >> (end % 32u)) & 1u);
    }
    return f32(count) + partly;
}

fn through(kind: u32) -> vec3f {
    switch kind {
        case 0u: { return transmittance.through_0; }
        case 1u: { return transmittance.through_1; }
        case 2u: { return transmittance.through_2; }
        default: { return transmittance.through_3; }
    }
}

fn light_left(column: u32, distance: f32) -> vec3f {
    var near = slicemap.near;
    var far = slicemap.far;
    if slicemap.is_local != 0u {
        let last = slicemap_extents[2u * column + 1u];
        near = bitcast<f32>(~slicemap_extents[2u * column]);
        far = bitcast<f32>(last);
        if last == 0u {
            return vec3f(1.0);
        }
    }
    // What lies beyond all slices has all of them before it.
    let place = select(slicemap_place(distance, near, far), f32(slicemap.slices), distance > far);
    if distance <= near {
        return vec3f(1.0);
    }
    let faces = 1u + slicemap.splits_faces;
    var left = vec3f(1.0);
    for (var bit_set = 0u; bit_set < slicemap.sets; bit_set++) {
        // Powers of zero are not the same everywhere, least of all the zeroth.
        left *= pow(max(through(bit_set / faces), vec3f(1e-6)), vec3f(surfaces_before(column, bit_set, place)));
    }
    return left;
}

// What is left of the light at a point of the world, 1 outside of the slicemap.
fn lumivox_light_left(world: vec3f) -> vec3f {
    let clip = slicemap.clip_from_world * vec4f(world, 1.0);
    let uv = vec2f(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
    if clip.w <= 0.0 || any(uv < vec2f(0.0)) || any(uv >= vec2f(1.0)) {
        return vec3f(1.0);
    }
    let column = slicemap_column(vec2u(uv * vec2f(slicemap.size)));
    return light_left(column, slicemap_distance(world) - transmittance.bias);
}
