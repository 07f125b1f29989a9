// Spherical harmonics of bands 0 and 1, coefficients in the order constant, x, y, z (lumivox_core::sh).

const SH_Y0: f32 = 0.2820948;
const SH_Y1: f32 = 0.4886025;
const SH_COS0: f32 = 0.8862269;
const SH_COS1: f32 = 1.0233267;
// Integral over the sphere of a function with constant coefficient 1: sqrt(4 pi).
const SH_INTEGRAL: f32 = 3.5449077;

// Projection of the clamped cosine about n.
fn sh_cosine_lobe(n: vec3f) -> vec4f {
    return vec4f(SH_COS0, SH_COS1 * n);
}

// Three colour bands.
struct ShRgb {
    r: vec4f,
    g: vec4f,
    b: vec4f,
}

fn sh_zero() -> ShRgb {
    return ShRgb(vec4f(0.0), vec4f(0.0), vec4f(0.0));
}

fn sh_scaled(color: vec3f, lobe: vec4f) -> ShRgb {
    return ShRgb(color.r * lobe, color.g * lobe, color.b * lobe);
}

fn sh_add(a: ShRgb, b: ShRgb) -> ShRgb {
    return ShRgb(a.r + b.r, a.g + b.g, a.b + b.b);
}

fn sh_times(a: ShRgb, k: f32) -> ShRgb {
    return ShRgb(k * a.r, k * a.g, k * a.b);
}

// Irradiance on a surface with normal n: equations 7, 14 and 15 of the dissertation.
fn sh_irradiance(sh: ShRgb, n: vec3f) -> vec3f {
    let lobe = sh_cosine_lobe(n);
    return vec3f(dot(sh.r, lobe), dot(sh.g, lobe), dot(sh.b, lobe));
}
