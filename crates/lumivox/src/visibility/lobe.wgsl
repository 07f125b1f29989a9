// The lobe that a polished surface mirrors; after the part for views. The shader that uses this binds `view`.

// Surfaces at least as rough are not polished.
const MATT: f32 = 1.0;
// The part of GGX's microfacets that rays are sent by: the steepest twentieth would stray over the whole hemisphere, and no
// object could be culled for it.
const LOBE_SHARE: f32 = 0.95;

// Of a texture; no number is a mirror.
fn roughness_of(stored: f32) -> f32 {
    return clamp(stored, 0.0, MATT);
}

// How far the lobe of a roughness strays from the mirrored way, radians: a ray turns by twice its microfacet's angle.
fn lobe_stray(roughness: f32) -> f32 {
    return 2.0 * atan(roughness * roughness * sqrt(LOBE_SHARE / (1.0 - LOBE_SHARE)));
}

// The way that the eye looks at a texel's point, unit length.
fn way_from_eye(texel: vec2u, depth: f32, p: vec3f) -> vec3f {
    return normalize(p - world_from_texel(view, texel, mix(depth, 1.0 - view.far_depth, 0.5)));
}

// A ray of a lobe, and what it counts beside the others.
struct LobeRay {
    direction: vec3f,
    weight: f32,
}

// Smith's masking of one side, by the cosine with the normal.
fn masking(alpha: f32, cosine: f32) -> f32 {
    let square = alpha * alpha;
    return 2.0 * cosine / (cosine + sqrt(square + (1.0 - square) * cosine * cosine));
}

// A ray by a microfacet of GGX's distribution about the normal, from a point of the unit square. `toward` looks to the eye.
fn lobe_ray(n: vec3f, toward: vec3f, roughness: f32, unit: vec2f) -> LobeRay {
    let alpha = roughness * roughness;
    let share = LOBE_SHARE * unit.x;
    let tangent = alpha * sqrt(share / (1.0 - share));
    let cosine = inverseSqrt(1.0 + tangent * tangent);
    let turn = 6.2831853 * unit.y;
    let facet = cosine * (n + tangents(n) * (tangent * vec2f(cos(turn), sin(turn))));
    let seen = dot(toward, facet);
    let direction = 2.0 * seen * facet - toward;
    let up = dot(n, direction);
    let weight = masking(alpha, max(up, 1e-6)) * seen / cosine;
    return LobeRay(direction, select(0.0, weight, up > 0.0 && seen > 0.0));
}
