// A rendered view: the GPU's side of lumivox_core::View, with the sizes of its pictures.

struct ViewUniform {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    eye_from_world: mat4x4f,
    // Size of the view's textures and of the grid of points that is injected from them.
    size: vec2u,
    points: vec2u,
    // Depth of what is infinitely far, or has not been drawn: 1, or 0 when reversed.
    far_depth: f32,
    // The largest radiance that injection represents.
    radiance_max: f32,
    // Fixed-point steps per unit of a sum: of normals and albedo, and of one light's radiance.
    unit_steps: f32,
    light_steps: f32,
    // In which order points are taken: INJECT_LINEAR, INJECT_BLOCK or INJECT_STIPPLED.
    pattern: u32,
    // Over how many frames they are split, and the number of this one.
    split: u32,
    phase: u32,
    spare: u32,
}

// Fixed-point steps per unit of summed emission, which is an attribute with the range of radiances.
fn emission_steps(view: ViewUniform) -> f32 {
    return view.unit_steps / view.radiance_max;
}

fn within_range(view: ViewUniform, color: vec3f) -> vec3f {
    return clamp(color, vec3f(0.0), vec3f(view.radiance_max));
}

fn ndc_from_uv(uv: vec2f) -> vec2f {
    return vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
}

fn uv_from_ndc(ndc: vec2f) -> vec2f {
    return vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
}

// The world point that a texel shows.
fn world_from_texel(view: ViewUniform, texel: vec2u, depth: f32) -> vec3f {
    let uv = (vec2f(texel) + 0.5) / vec2f(view.size);
    let world = view.world_from_clip * vec4f(ndc_from_uv(uv), depth, 1.0);
    return world.xyz / world.w;
}

// Distance from the eye along the view direction, in metres.
fn eye_distance(view: ViewUniform, world: vec3f) -> f32 {
    return -(view.eye_from_world * vec4f(world, 1.0)).z;
}
