// One more bounce of light for one surfel per invocation: what its rays met shines on it. Before the first, its own light.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> albedo: array<vec2u>;
@group(0) @binding(2) var<storage, read> emission: array<vec2u>;
@group(0) @binding(3) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read> hits: array<u32>;
// Radiance that leaves a surfel (xy), and its irradiance without direct light (zw).
@group(0) @binding(6) var<storage, read> before: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> after: array<vec4u>;

const PI: f32 = 3.1415927;

// Whether rays are asked, or what they said last is kept and only the surfel's own light is new.
override GATHERS: bool;

// Mean radiance of what the surfel's rays met.
fn gathered(place: u32) -> vec3f {
    var sum = vec3f(0.0);
    var traced = 0.0;
    for (var ray = 0u; ray < settings.rays; ray++) {
        let hit = hits[place * settings.rays + ray];
        if hit == UNTRACED {
            continue;
        }
        traced += 1.0;
        if hit == SKY_HIT {
            sum += settings.sky;
        } else if hit != DARK_HIT {
            sum += unpack_half4(before[hit].xy).rgb;
        }
    }
    return sum / max(traced, 1.0);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity {
        return;
    }
    let surfel = unpack_surfel(surfels[place]);
    if !surfel.exists {
        after[place] = vec4u(0u);
        return;
    }
    let mean = select(unpack_half4(before[place].zw).rgb / PI, gathered(place), GATHERS);
    let own = light[place].rgb + unpack_half4(emission[surfel.cell]).rgb;
    let leaving = own + saturate(unpack_half4(albedo[surfel.cell]).rgb) * mean;
    after[place] = vec4u(pack_half4(vec4f(leaving, 0.0)), pack_half4(vec4f(PI * mean, 0.0)));
}
