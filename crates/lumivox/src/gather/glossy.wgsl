// What a rough mirror at one pixel per invocation shows.

struct GlossyUniform {
    alpha: f32,
    rays: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> glossy: GlossyUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(7) var<storage, read> shown: array<vec4u>;
@group(0) @binding(8) var<storage, read> mask: array<vec2u>;
@group(0) @binding(9) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(10) var<storage, read> sky: array<vec4f>;

// How far a ray's own surface may reach before it, in sub-cells.
const OWN_SURFACE: f32 = 3.0;

// Half vector number `ray` about n, as dense as GGX has it.
fn half_vector(n: vec3f, ray: u32, turn: f32) -> vec3f {
    let u = (f32(ray) + 0.5) / f32(glossy.rays);
    let cos2 = (1.0 - u) / (1.0 + (glossy.alpha * glossy.alpha - 1.0) * u);
    let angle = 6.2831853 * fract(f32(ray) * 0.61803399 + turn);
    let side = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    let a = normalize(cross(side, n));
    let b = cross(n, a);
    return sqrt(max(1.0 - cos2, 0.0)) * (cos(angle) * a + sin(angle) * b) + sqrt(cos2) * n;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let stored = textureLoad(normal, texel, 0).xyz;
    if pixel_depth == view.far_depth || dot(stored, stored) < 0.25 {
        return vec4f(0.0);
    }
    let n = normalize(stored);
    let world = world_from_texel(view, texel, pixel_depth);
    let nearer = world_from_texel(view, texel, mix(pixel_depth, 1.0 - view.far_depth, 0.5));
    let towards_eye = normalize(nearer - world);
    let start = free_point(grid_from_world(grid, world), n, towards_eye);
    // 4 x 4 pixels have different rays.
    let turn = hashed((texel.x & 3u) + 4u * (texel.y & 3u), 7u);
    var sum = vec4f(0.0);
    for (var ray = 0u; ray < glossy.rays; ray++) {
        let direction = reflect(-towards_eye, half_vector(n, ray, turn));
        let cosine = dot(direction, n);
        if cosine > 0.0 {
            // A ray at a grazing angle may meet the inside of its own surface: then from a little farther on, and what is not known
            // there leaves the rest to the other rays.
            var seen = vec4f(0.0);
            for (var again = 0; again < 2 && seen.w == 0.0; again++) {
                seen = known_along(start + f32(again) * OWN_SURFACE * direction, direction);
            }
            sum += cosine * seen;
        }
    }
    return vec4f(min(sum.rgb / max(sum.w, 1e-6), vec3f(HALF_MAX)), 1.0);
}
