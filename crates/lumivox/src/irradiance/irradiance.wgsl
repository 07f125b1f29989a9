// Light at any point of a volume. Plain WGSL for any stage.

struct LumivoxIrradianceUniform {
    origin: vec3f,
    spacing: f32,
    extent: vec3f,
    reserved: f32,
}

@group(0) @binding(0) var<uniform> lumivox_lattice: LumivoxIrradianceUniform;
@group(0) @binding(1) var lumivox_sampler: sampler;
@group(0) @binding(2) var lumivox_red: texture_3d<f32>;
@group(0) @binding(3) var lumivox_green: texture_3d<f32>;
@group(0) @binding(4) var lumivox_blue: texture_3d<f32>;

// Projections of the constant 1 / (4 pi), and of the clamped cosine, onto the two bands.
const LUMIVOX_MEAN: f32 = 0.2820948;
const LUMIVOX_COSINE_0: f32 = 0.8862269;
const LUMIVOX_COSINE_1: f32 = 1.0233267;

fn lumivox_blended(p: vec3f, weights: vec4f) -> vec3f {
    let at = (p - lumivox_lattice.origin) / lumivox_lattice.extent;
    let red = textureSampleLevel(lumivox_red, lumivox_sampler, at, 0.0);
    let green = textureSampleLevel(lumivox_green, lumivox_sampler, at, 0.0);
    let blue = textureSampleLevel(lumivox_blue, lumivox_sampler, at, 0.0);
    return max(vec3f(dot(red, weights), dot(green, weights), dot(blue, weights)), vec3f(0.0));
}

// Irradiance in W/m2 at a point in free space, on what faces unit vector n: particles, leaves, hair.
fn lumivox_irradiance_at(p: vec3f, n: vec3f) -> vec3f {
    return lumivox_blended(p, vec4f(LUMIVOX_COSINE_0, LUMIVOX_COSINE_1 * n));
}

// Irradiance in W/m2 on a surface at p with unit normal n. Nothing from behind the surface comes into it.
fn lumivox_irradiance(p: vec3f, n: vec3f) -> vec3f {
    return lumivox_irradiance_at(p + lumivox_lattice.spacing * n, n);
}

// Mean radiance in W/(m2 sr) that arrives at p from all around: what fog scatters.
fn lumivox_mean_radiance(p: vec3f) -> vec3f {
    return lumivox_blended(p, vec4f(LUMIVOX_MEAN, 0.0, 0.0, 0.0));
}
