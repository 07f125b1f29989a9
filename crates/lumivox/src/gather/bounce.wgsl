// One more bounce of light for one surfel that is due per invocation: what its rays met shines on it.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> albedo: array<vec2u>;
@group(0) @binding(2) var<storage, read> emission: array<vec2u>;
@group(0) @binding(3) var<storage, read> due: DueSurfels;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read> hits: array<u32>;
// Radiance that leaves a surfel (xy), and its irradiance from surfaces with the deviation of its brightness (zw).
@group(0) @binding(6) var<storage, read> before: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> after: array<vec4u>;
// Mean radiance of the sky over a surfel's rays.
@group(0) @binding(8) var<storage, read> sky_light: array<vec2u>;

const PI: f32 = 3.1415927;

// Mean radiance of the surfaces that the surfel's rays met, and how far its brightness may be off: one standard deviation.
fn gathered(place: u32) -> vec4f {
    var sum = vec3f(0.0);
    var squares = 0.0;
    var known = 0.0;
    for (var ray = 0u; ray < settings.rays; ray++) {
        let hit = hits[place * settings.rays + ray];
        known += select(0.0, 1.0, is_known(hit));
        if hit < FIRST_SKY_HIT {
            let radiance = unpack_half4(before[hit].xy).rgb;
            sum += radiance;
            squares += brightness(radiance) * brightness(radiance);
        }
    }
    let mean = sum / max(known, 1.0);
    return vec4f(mean, deviation_of_mean(brightness(mean), squares, known));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= due.count {
        return;
    }
    let place = due.surfels[nth].x;
    let cell = due.surfels[nth].y;
    let found = gathered(place);
    let mean = found.rgb;
    // What moves has other neighbors in each frame, and would flicker with them: it keeps its own grain.
    let moves = light[place].w < NEW || light[place].w > SETTLED;
    let irradiance = pack_half4(vec4f(PI * mean, select(PI * found.w, KEEPS_GRAIN, moves)));
    if light[place].w == INHERITED {
        after[place] = vec4u(before[place].xy, irradiance);
        return;
    }
    let own = light[place].rgb + unpack_half4(emission[cell]).rgb;
    let arriving = mean + unpack_half4(sky_light[place]).rgb;
    let leaving = own + saturate(unpack_half4(albedo[cell]).rgb) * arriving;
    after[place] = vec4u(pack_half4(vec4f(leaving, 0.0)), irradiance);
}
