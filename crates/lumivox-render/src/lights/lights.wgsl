// What a light sends to a surface.

struct LightUniform {
    position: vec3f,
    kind: u32,
    direction: vec3f,
    beam: f32,
    intensity: vec3f,
    cutoff: f32,
}

const LIGHT_DIRECTIONAL: u32 = 0u;
const LIGHT_POINT: u32 = 1u;
const LIGHT_SPOT: u32 = 2u;
const LIGHT_SPOT_GLTF: u32 = 3u;
const LIGHT_SKY: u32 = 4u;
const LIGHT_RECT: u32 = 5u;
const PI: f32 = 3.1415927;
// More than any picture holds, and small enough that sums and products of it are numbers.
const IRRADIANCE_MAX: f32 = 1e30;

fn spot_factor(light: LightUniform, toward_surface: vec3f) -> f32 {
    let cosine = clamp(dot(toward_surface, light.direction), -1.0, 1.0);
    if light.kind == LIGHT_SPOT {
        // Falls linearly with the angle.
        return saturate((light.cutoff - acos(cosine)) / max(light.cutoff - light.beam, 1e-4));
    }
    let edge = cos(light.cutoff);
    let ramp = saturate((cosine - edge) / max(cos(light.beam) - edge, 1e-4));
    return ramp * ramp;
}

fn is_parallel(light: LightUniform) -> bool {
    return light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_SKY;
}

// One of many samples of an area light.
fn is_area_sample(light: LightUniform) -> bool {
    return light.kind == LIGHT_SKY || light.kind == LIGHT_RECT;
}

// Unshadowed irradiance in W/m2 on a surface at p whose visible side faces n.
fn light_irradiance(light: LightUniform, p: vec3f, n: vec3f) -> vec3f {
    if is_parallel(light) {
        return min(light.intensity * max(dot(n, -light.direction), 0.0), vec3f(IRRADIANCE_MAX));
    }
    let away = p - light.position;
    let distance2 = max(dot(away, away), 1e-30);
    let toward_surface = away * inverseSqrt(distance2);
    var factor = max(dot(n, -toward_surface), 0.0) / distance2;
    if light.kind == LIGHT_RECT {
        // The light's own face is Lambertian, too.
        factor *= max(dot(light.direction, toward_surface), 0.0);
    } else if light.kind != LIGHT_POINT {
        factor *= spot_factor(light, toward_surface);
    }
    return min(factor * light.intensity, vec3f(IRRADIANCE_MAX));
}
