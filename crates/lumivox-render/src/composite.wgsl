// The picture, one pixel per invocation, in linear radiance.

struct CompositeUniform {
    sky: vec3f,
    layer: u32,
    reflectance: f32,
    roughness: f32,
    mirrors_sky: u32,
    mirrors: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> composite: CompositeUniform;
@group(0) @binding(2) var depth: texture_depth_2d;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var emission: texture_2d<f32>;
@group(0) @binding(6) var radiance: texture_2d<f32>;
@group(0) @binding(7) var irradiance: texture_2d<f32>;
@group(0) @binding(8) var sky_map: texture_2d<f32>;
// For each pixel, or one texel for all.
@group(0) @binding(9) var occlusion: texture_2d<f32>;
// What is mirrored of objects, with the part that they take in alpha, and of gathered light; likewise.
@group(0) @binding(10) var reflection: texture_2d<f32>;
@group(0) @binding(11) var mirrored: texture_2d<f32>;

const PI: f32 = 3.1415927;

// Blue for none, through green and yellow to red for all.
fn heat(share: f32) -> vec3f {
    let s = saturate(share);
    return saturate(vec3f(2.0 * s - 0.5, 1.0 - abs(2.0 * s - 1.0), 0.6 - 2.0 * s)) + 0.02;
}

fn sky_texel(x: i32, y: i32) -> vec3f {
    let size = vec2i(textureDimensions(sky_map));
    return textureLoad(sky_map, vec2i((x + size.x) % size.x, clamp(y, 0, size.y - 1)), 0).rgb;
}

// The way that a pixel looks.
fn way_of(texel: vec2u) -> vec3f {
    let far = world_from_texel(view, texel, mix(view.far_depth, 1.0 - view.far_depth, 0.25));
    let near = world_from_texel(view, texel, mix(view.far_depth, 1.0 - view.far_depth, 0.5));
    return normalize(far - near);
}

// The sky along a way: the constant one and its map, which is closed all round.
fn sky_along(d: vec3f) -> vec3f {
    let place = vec2f(0.5 + atan2(d.x, -d.z) / (2.0 * PI), 0.5 - asin(clamp(d.y, -1.0, 1.0)) / PI);
    let at = place * vec2f(textureDimensions(sky_map)) - 0.5;
    let low = vec2i(floor(at));
    let f = at - floor(at);
    let upper = mix(sky_texel(low.x, low.y), sky_texel(low.x + 1, low.y), f.x);
    let lower = mix(sky_texel(low.x, low.y + 1), sky_texel(low.x + 1, low.y + 1), f.x);
    return min(composite.sky + mix(upper, lower, f.y), vec3f(HALF_MAX));
}

fn at_pixel(texture: texture_2d<f32>, texel: vec2u) -> vec4f {
    return textureLoad(texture, min(texel, textureDimensions(texture) - 1u), 0);
}

// What a polished surface mirrors, and in alpha which part of light it mirrors.
fn polish(texel: vec2u) -> vec4f {
    let n = normalize(textureLoad(normal, texel, 0).xyz);
    let way = way_of(texel);
    let objects = at_pixel(reflection, texel);
    let sky = sky_along(reflect(way, n));
    let around = select(at_pixel(mirrored, texel).rgb, sky, composite.mirrors_sky != 0u);
    // Schlick; microfacets of rough surfaces are seen less at grazing angles.
    let most = max(1.0 - composite.roughness, composite.reflectance);
    let share = mix(composite.reflectance, most, pow(1.0 - saturate(-dot(way, n)), 5.0));
    return vec4f(objects.rgb + (1.0 - objects.a) * around, share);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0);
    if pixel_depth == view.far_depth {
        if composite.layer == 0u {
            return vec4f(sky_along(way_of(texel)), 0.0);
        }
        return vec4f(0.0);
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
        case 7u: { shown = textureLoad(irradiance, texel, 0).rgb; }
        case 6u: { shown = heat(textureLoad(irradiance, texel, 0).r); }
        case 8u: { shown = at_pixel(occlusion, texel).rrr; }
        case 9u: { shown = select(vec3f(0.0), polish(texel).rgb, composite.mirrors != 0u); }
        default: {
            shown = direct + indirect;
            if composite.mirrors != 0u {
                let coat = polish(texel);
                shown = mix(shown, coat.rgb, coat.a);
            }
            shown += textureLoad(emission, texel, 0).rgb;
        }
    }
    return vec4f(min(shown, vec3f(HALF_MAX)), 1.0);
}
