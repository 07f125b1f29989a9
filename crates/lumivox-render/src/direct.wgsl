// Direct light through a batch of shadow views, one pixel per invocation.

struct ShadowViewUniform {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
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
    is_colored: u32,
    reserved: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> batch: ShadowBatchUniform;
@group(0) @binding(2) var<storage, read> lights: array<LightUniform>;
@group(0) @binding(3) var<storage, read> shadow_views: array<ShadowViewUniform>;
@group(0) @binding(4) var depth: texture_depth_2d;
@group(0) @binding(5) var normal: texture_2d<f32>;
@group(0) @binding(6) var albedo: texture_2d<f32>;
@group(0) @binding(7) var emission: texture_2d<f32>;
@group(0) @binding(8) var shadow_atlas: texture_depth_2d;
@group(0) @binding(9) var radiance_before: texture_2d<f32>;
// What objects with visibility fields let through at each pixel, or leaves in colours, or one texel for all.
@group(0) @binding(10) var object_factor: texture_2d<f32>;

// How far the receiver's plane is moved along its normal, in texels.
const PLANE_OFFSET: f32 = 0.15;

struct Receiver {
    p: vec3f,
    // Interpolated normal and the triangle's own.
    n: vec3f,
    face: vec3f,
}

// 1 if a texel of the view's tile does not lie before the plane that is given in the view's clip space.
fn lit_at(shadow: ShadowViewUniform, plane: vec4f, texel: vec2f) -> f32 {
    // Beyond its border the map goes on as its last texels.
    let inside = clamp(texel, vec2f(0.0), vec2f(shadow.texels - 1.0));
    let ndc = ndc_from_uv((inside + 0.5) / shadow.texels);
    let reference = -(dot(plane.xy, ndc) + plane.w) / plane.z;
    let origin = shadow.tile_origin * shadow.texels / shadow.tile_size;
    let stored = textureLoad(shadow_atlas, vec2u(origin + inside + 0.5), 0);
    // Where nothing was drawn there is no shadow, even where the plane runs beyond the far plane.
    return select(0.0, 1.0, reference >= stored || stored == 0.0);
}

// Share of the light that arrives at a receiver whose clip position is `own`. A plane's depth is linear over the picture, in
// perspective too.
fn visible_share(shadow: ShadowViewUniform, own: vec4f, light: LightUniform, receiver: Receiver) -> f32 {
    let m = shadow.clip_from_world;
    let row_x = vec3f(m[0].x, m[1].x, m[2].x);
    let texel_size = 2.0 * own.w / (length(row_x) * shadow.texels);
    let lifted = receiver.p + PLANE_OFFSET * texel_size * receiver.face;
    let plane = vec4f(receiver.face, -dot(receiver.face, lifted)) * shadow.world_from_clip;
    let at = uv_from_ndc(own.xy / own.w) * shadow.texels;
    let nearest = floor(at);
    if is_area_sample(light) {
        return lit_at(shadow, plane, nearest);
    }
    let f = at - nearest - 0.5;
    var weights = array<vec2f, 3>(0.5 * (0.5 - f) * (0.5 - f), 0.75 - f * f, 0.5 * (0.5 + f) * (0.5 + f));
    var lit = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let column = i % 3u;
        let row = i / 3u;
        let texel = nearest + vec2f(f32(column), f32(row)) - 1.0;
        lit += weights[column].x * weights[row].y * lit_at(shadow, plane, texel);
    }
    return lit;
}

// Irradiance that arrives through one view. A point on the seam of two views belongs to one of them.
fn arriving(shadow: ShadowViewUniform, receiver: Receiver) -> vec3f {
    let own = shadow.clip_from_world * vec4f(receiver.p, 1.0);
    let light = lights[shadow.light];
    let outside = own.w <= 0.0 || any(abs(own.xy) > vec2f(own.w)) || own.z < 0.0;
    if outside && !is_parallel(light) {
        return vec3f(0.0);
    }
    let irradiance = light_irradiance(light, receiver.p, receiver.n);
    if all(irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    if outside {
        return irradiance;
    }
    return irradiance * visible_share(shadow, own, light, receiver);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let before = textureLoad(radiance_before, texel, 0);
    let pixel_depth = textureLoad(depth, texel, 0);
    if pixel_depth == view.far_depth {
        return before;
    }
    let seen_normal = textureLoad(normal, texel, 0);
    let face = direction_from_octahedron(vec2f(seen_normal.w, textureLoad(emission, texel, 0).w));
    let p = world_from_texel(view, texel, pixel_depth);
    let receiver = Receiver(p, normalize(seen_normal.xyz), face);
    var irradiance = vec3f(0.0);
    // At most 64 views fill an atlas.
    for (var i = 0u; i < batch.view_count; i++) {
        irradiance += arriving(shadow_views[batch.first_view + i], receiver);
    }
    let factor = textureLoad(object_factor, min(texel, textureDimensions(object_factor) - 1u), 0).rgb;
    let through = select(factor.rrr, factor, batch.is_colored != 0u);
    return before + vec4f(textureLoad(albedo, texel, 0).rgb / PI * (through * irradiance), 0.0);
}
