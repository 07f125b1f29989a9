// From pixels to the world, and into a view of the light. The shader that uses this binds `volume`.

fn world_of_pixel(pixel: vec2u, depth: f32) -> vec3f {
    let uv = (vec2f(pixel) + 0.5) / vec2f(volume.size);
    let world = volume.world_from_clip * vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, depth, 1.0);
    return world.xyz / world.w;
}

fn is_inside(clip: vec4f) -> bool {
    return clip.w > 0.0 && all(abs(clip.xy) <= vec2f(clip.w));
}
