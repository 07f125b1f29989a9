// Direct light through a batch of shadow views, one pixel per invocation.

struct ShadowViewUniform {
    clip_from_world: mat4x4f,
    tile_origin: vec2f,
    tile_size: f32,
    texels: f32,
    light: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

struct ShadowBatchUniform {
    first_view: u32,
    view_count: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> batch: ShadowBatchUniform;
@group(0) @binding(2) var<storage, read> lights: array<LightUniform>;
@group(0) @binding(3) var<storage, read> shadow_views: array<ShadowViewUniform>;
@group(0) @binding(4) var depth: texture_depth_2d;
@group(0) @binding(5) var normal: texture_2d<f32>;
@group(0) @binding(6) var albedo: texture_2d<f32>;
@group(0) @binding(7) var shadow_atlas: texture_depth_2d;
@group(0) @binding(8) var shadow_comparison: sampler_comparison;
@group(0) @binding(9) var radiance_before: texture_2d<f32>;

// One bilinear comparison, that stays within the view's tile: beyond its border the map goes on as its last texels.
fn shadow_tap(shadow: ShadowViewUniform, uv: vec2f, reference: f32) -> f32 {
    let half_texel = 0.5 / shadow.texels;
    let inside = clamp(uv, vec2f(half_texel), vec2f(1.0 - half_texel));
    let at = shadow.tile_origin + shadow.tile_size * inside;
    return textureSampleCompareLevel(shadow_atlas, shadow_comparison, at, reference);
}

// Share of the light that arrives, or none outside the view. Whether a point is inside is asked where it is, before it is
// moved off its surface: points on the seam of two views belong to one of them, whatever their texels measure.
fn visible_share(shadow: ShadowViewUniform, own: vec4f, light: LightUniform, p: vec3f, n: vec3f) -> f32 {
    let m = shadow.clip_from_world;
    let row_x = vec3f(m[0].x, m[1].x, m[2].x);
    let texel_size = 2.0 * own.w / (length(row_x) * shadow.texels);
    // The filter of one of many samples is a single lookup, which reaches one texel.
    let single = is_area_sample(light);
    let clip = m * vec4f(p + select(1.6, 1.1, single) * texel_size * n, 1.0);
    if clip.w <= 0.0 {
        return 0.0;
    }
    // The scene ends before the far plane does.
    let ndc = vec3f(clip.xy / clip.w, saturate(clip.z / clip.w));
    let uv = uv_from_ndc(ndc.xy);
    if single {
        return shadow_tap(shadow, uv, ndc.z);
    }
    let texel = 1.0 / shadow.texels;
    var lit = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let offset = 0.5 * (vec2f(f32(i % 3u), f32(i / 3u)) - 1.0);
        lit += shadow_tap(shadow, uv + offset * texel, ndc.z);
    }
    return lit / 9.0;
}

// Irradiance that arrives through one view.
fn arriving(shadow: ShadowViewUniform, p: vec3f, n: vec3f) -> vec3f {
    let own = shadow.clip_from_world * vec4f(p, 1.0);
    let light = lights[shadow.light];
    let outside = own.w <= 0.0 || any(abs(own.xy) > vec2f(own.w)) || own.z < 0.0;
    if outside && !is_parallel(light) {
        return vec3f(0.0);
    }
    let irradiance = light_irradiance(light, p, n);
    if all(irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    return irradiance * select(visible_share(shadow, own, light, p, n), 1.0, outside);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let before = textureLoad(radiance_before, texel, 0);
    let pixel_depth = textureLoad(depth, texel, 0);
    if pixel_depth == view.far_depth {
        return before;
    }
    let n = normalize(textureLoad(normal, texel, 0).xyz);
    let p = world_from_texel(view, texel, pixel_depth);
    var irradiance = vec3f(0.0);
    // At most 64 views fill an atlas.
    for (var i = 0u; i < batch.view_count; i++) {
        irradiance += arriving(shadow_views[batch.first_view + i], p, n);
    }
    return before + vec4f(textureLoad(albedo, texel, 0).rgb / PI * irradiance, 0.0);
}
