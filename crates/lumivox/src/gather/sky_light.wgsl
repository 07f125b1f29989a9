// What the sky sends to one surfel per invocation: the mean over its rays, of which those that left the grid see the sky.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> sky: array<vec4f>;
@group(0) @binding(2) var<storage, read> due: DueSurfels;
@group(0) @binding(3) var<storage, read> hits: array<u32>;
@group(0) @binding(4) var<storage, read_write> sky_light: array<vec2u>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= due.count {
        return;
    }
    let place = due.surfels[nth].x;
    var sum = vec3f(0.0);
    var squares = 0.0;
    var known = 0.0;
    for (var ray = 0u; ray < settings.rays; ray++) {
        let hit = hits[place * settings.rays + ray];
        known += select(0.0, 1.0, is_known(hit));
        if is_sky_hit(hit) {
            let radiance = sky[hit - FIRST_SKY_HIT].rgb;
            sum += radiance;
            squares += brightness(radiance) * brightness(radiance);
        }
    }
    let mean = sum / max(known, 1.0);
    sky_light[place] = pack_half4(vec4f(mean, deviation_of_mean(brightness(mean), squares, known)));
}
