// Direct light of one view of a light, one pixel per invocation.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> light: LightUniform;
@group(0) @binding(2) var<uniform> shadow_view: ViewUniform;
@group(0) @binding(3) var depth: texture_depth_2d;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var albedo: texture_2d<f32>;
@group(0) @binding(6) var shadow_depth: texture_depth_2d;
@group(0) @binding(7) var shadow_comparison: sampler_comparison;

// Share of the light that arrives, or none outside the map. Whether a point is inside is asked where it is, before it is
// moved off its surface: points on the seam of two views belong to one of them, whatever their texels measure.
fn visible_share(p: vec3f, n: vec3f) -> f32 {
    let m = shadow_view.clip_from_world;
    let own = m * vec4f(p, 1.0);
    if own.w <= 0.0 {
        return 0.0;
    }
    if any(abs(own.xy) > vec2f(own.w)) || own.z < 0.0 {
        return select(0.0, 1.0, light.kind == LIGHT_DIRECTIONAL);
    }
    let row_x = vec3f(m[0].x, m[1].x, m[2].x);
    let texel_size = 2.0 * own.w / (length(row_x) * f32(shadow_view.size.x));
    let clip = m * vec4f(p + 1.6 * texel_size * n, 1.0);
    if clip.w <= 0.0 {
        return 0.0;
    }
    // Beyond its border the map goes on as its last texels; the scene ends before the far plane does.
    let ndc = vec3f(clip.xy / clip.w, saturate(clip.z / clip.w));
    let uv = uv_from_ndc(ndc.xy);
    let texel = 1.0 / vec2f(shadow_view.size);
    var lit = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let offset = 0.5 * (vec2f(f32(i % 3u), f32(i / 3u)) - 1.0);
        lit += textureSampleCompareLevel(shadow_depth, shadow_comparison, uv + offset * texel, ndc.z);
    }
    return lit / 9.0;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0);
    if pixel_depth == view.far_depth {
        return vec4f(0.0);
    }
    let n = normalize(textureLoad(normal, texel, 0).xyz);
    let p = world_from_texel(view, texel, pixel_depth);
    let irradiance = light_irradiance(light, p, n);
    if all(irradiance <= vec3f(0.0)) {
        return vec4f(0.0);
    }
    return vec4f(textureLoad(albedo, texel, 0).rgb / PI * irradiance * visible_share(p, n), 1.0);
}
