// Light that thin absorbers leave for one pixel per invocation.

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

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var normal: texture_2d<f32>;
@group(0) @binding(3) var<uniform> slicemap: SlicemapUniform;
@group(0) @binding(4) var<storage, read> slicemap_bits: array<u32>;
@group(0) @binding(5) var<storage, read> slicemap_extents: array<u32>;
@group(0) @binding(6) var<uniform> transmittance: TransmittanceUniform;
// Of each byte the number of its ones: the paper's summask.
@group(0) @binding(7) var<storage, read> summask: array<u32>;

// Whether ones are counted by the table, or by the processor.
override USES_TABLE: bool;

fn ones(word: u32) -> u32 {
    if !USES_TABLE {
        return countOneBits(word);
    }
    return summask[word & 0xffu] + summask[(word >> 8u) & 0xffu] + summask[(word >> 16u) & 0xffu] + summask[word >> 24u];
}

// Surfaces of a set before a place in a column: whole slices, and of the slice that it lies in a part, if asked for.
fn surfaces_before(column: u32, bit_set: u32, place: f32) -> f32 {
    let word = slicemap_word(column, bit_set);
    let end = u32(clamp(floor(place), 0.0, f32(slicemap.slices)));
    var count = 0u;
    for (var n = 0u; 32u * n < end; n++) {
        count += ones(slicemap_bits[word + n] & slicemap_bits_before(32u * n, end));
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
        left *= pow(through(bit_set / faces), vec3f(surfaces_before(column, bit_set, place)));
    }
    return left;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    var left = vec3f(1.0);
    var is_inside = false;
    if pixel_depth != view.far_depth && dot(n, n) > 0.25 {
        let world = world_from_texel(view, texel, pixel_depth);
        let clip = slicemap.clip_from_world * vec4f(world, 1.0);
        let uv = uv_from_ndc(clip.xy / clip.w);
        is_inside = clip.w > 0.0 && all(uv >= vec2f(0.0)) && all(uv < vec2f(1.0));
        if is_inside {
            let column = slicemap_column(vec2u(uv * vec2f(slicemap.size)));
            left = light_left(column, slicemap_distance(world) - transmittance.bias);
        }
    }
    if !is_inside && transmittance.only_inside != 0u {
        discard;
    }
    return vec4f(left, 1.0);
}
