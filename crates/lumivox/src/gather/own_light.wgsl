// Takes up what one surfel per invocation sends out by itself, beside what its rays said last. In both states of a bounce, since that
// writes those of surfels that are due alone.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> albedo: array<vec2u>;
@group(0) @binding(2) var<storage, read> emission: array<vec2u>;
@group(0) @binding(3) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read> sky_light: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> shine: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> next_shine: array<vec4u>;

const PI: f32 = 3.1415927;

fn with_own_light(place: u32) -> vec4u {
    let cell = surfels[place].x / SIDES;
    let own = light[place].rgb + unpack_half4(emission[cell]).rgb;
    let arriving = unpack_half4(shine[place].zw).rgb / PI + unpack_half4(sky_light[place]).rgb;
    let leaving = own + saturate(unpack_half4(albedo[cell]).rgb) * arriving;
    return vec4u(pack_half4(vec4f(leaving, 0.0)), shine[place].zw);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity {
        return;
    }
    var now = vec4u(0u);
    if surfels[place].x != NO_SURFEL {
        now = shine[place];
        // One that no view has been asked about sends out what its neighbors do.
        if light[place].w != INHERITED {
            now = with_own_light(place);
        }
    }
    shine[place] = now;
    next_shine[place] = now;
}
