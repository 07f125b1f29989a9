// What may be in shadow: of each pixel the metres along the view to its surface, or -1 where there is none, or none that the light
// shines on.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var depth: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel_depth = textureLoad(depth, vec2u(position.xy), 0).r;
    if pixel_depth == volume.far_depth {
        return vec4f(-1.0);
    }
    let world = world_of_pixel(vec2u(position.xy), pixel_depth);
    var is_lit = volume.light_views == 0u;
    for (var n = 0u; n < volume.light_views; n++) {
        is_lit |= is_inside(volume.clip_from_world_of_light[n] * vec4f(world, 1.0));
    }
    return vec4f(select(-1.0, max(dot(volume.distance, vec4f(world, 1.0)), 0.0), is_lit));
}
