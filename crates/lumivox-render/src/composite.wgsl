// The picture, one pixel per invocation, in linear radiance.

struct CompositeUniform {
    sky: vec3f,
    layer: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> composite: CompositeUniform;
@group(0) @binding(2) var depth: texture_depth_2d;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var emission: texture_2d<f32>;
@group(0) @binding(6) var radiance: texture_2d<f32>;
@group(0) @binding(7) var irradiance: texture_2d<f32>;

const PI: f32 = 3.1415927;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0);
    if pixel_depth == view.far_depth {
        return vec4f(select(vec3f(0.0), min(composite.sky, vec3f(HALF_MAX)), composite.layer == 0u), 0.0);
    }
    let reflectance = textureLoad(albedo, texel, 0).rgb;
    let direct = textureLoad(radiance, texel, 0).rgb;
    let indirect = reflectance / PI * textureLoad(irradiance, texel, 0).rgb;
    var shown: vec3f;
    switch composite.layer {
        case 1u: { shown = direct; }
        case 2u: { shown = indirect; }
        case 3u: { shown = reflectance; }
        case 4u: { shown = 0.5 + 0.5 * normalize(textureLoad(normal, texel, 0).xyz); }
        case 5u: { shown = vec3f(eye_distance(view, world_from_texel(view, texel, pixel_depth))); }
        default: { shown = direct + indirect + textureLoad(emission, texel, 0).rgb; }
    }
    return vec4f(min(shown, vec3f(HALF_MAX)), 1.0);
}
