// Surfaces: the vertex stage and the material, shared by G-buffers and reflective shadow maps.

struct MaterialUniform {
    base_color: vec4f,
    emission: vec3f,
    alpha_cutoff: f32,
    decodes_base_color: u32,
    decodes_emission: u32,
    reserved_0: u32,
    reserved_1: u32,
}

// Whether textures are looked up at a point, as a path tracer does, or filtered over the pixel.
override LOOKS_UP_POINTS: bool;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> instances: array<mat4x4f>;
@group(1) @binding(0) var<uniform> material: MaterialUniform;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var emission_texture: texture_2d<f32>;
@group(1) @binding(3) var material_sampler: sampler;

struct Varyings {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    // Relative to the eye, where differences between pixels keep their digits.
    @location(4) eye: vec3f,
}

// Vectors are brought to a largest component of one before they are multiplied: the squares of nanometres and of millions of
// kilometres are no numbers any more.
const SMALLEST: f32 = 1e-30;

fn largest_part(v: vec3f) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

fn brought_to_one(v: vec3f) -> vec3f {
    return v / max(largest_part(v), SMALLEST);
}

@vertex
fn vertex(
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
) -> Varyings {
    let world_from_local = instances[instance];
    let world = world_from_local * vec4f(position, 1.0);
    // The cofactor matrix turns normals right under any scale, mirrored ones too.
    let m = mat3x3f(world_from_local[0].xyz, world_from_local[1].xyz, world_from_local[2].xyz);
    let largest = max(largest_part(m[0]), max(largest_part(m[1]), largest_part(m[2])));
    let s = (1.0 / max(largest, SMALLEST)) * m;
    let cofactor = mat3x3f(cross(s[1], s[2]), cross(s[2], s[0]), cross(s[0], s[1]));
    let eye = (view.eye_from_world * world).xyz;
    return Varyings(view.clip_from_world * world, world.xyz, cofactor * normal, uv, color, eye);
}

struct Surface {
    albedo: vec4f,
    emission: vec3f,
    // Interpolated, on the side that the view sees.
    normal: vec3f,
    // The triangle's own, on the same side.
    face: vec3f,
    // Seen along its plane.
    edge_on: bool,
}

// Sine of the angle to the view below which a triangle is seen along its plane: what a 256th of a pixel, to which rasterizers round
// corners, may turn into a face. Their depths there are of anywhere on the plane, also right before the eye. A floor at eye
// height still reaches 50 km far.
const EDGE_ON: f32 = 3e-5;

// From a point in the axes of the eye towards the view.
fn toward_view(eye: vec3f) -> vec3f {
    let m = view.clip_from_world;
    let orthographic = m[0].w == 0.0 && m[1].w == 0.0 && m[2].w == 0.0;
    return select(-brought_to_one(eye), vec3f(0.0, 0.0, 1.0), orthographic);
}

// Normal to the triangle, of any length and on either side.
fn normal_to_face(eye: vec3f) -> vec3f {
    return cross(brought_to_one(dpdx(eye)), brought_to_one(dpdy(eye)));
}

fn is_edge_on(face: vec3f, toward_view: vec3f) -> bool {
    return dot(face, face) > 1e-20 && abs(dot(face, toward_view)) < EDGE_ON * length(face) * length(toward_view);
}

// The side of the triangle that the view sees.
fn visible_face(face: vec3f, toward_view: vec3f) -> vec3f {
    let facing = select(face, -face, dot(face, toward_view) < 0.0);
    // What is too far away to have a face has its front to the view.
    let turned = select(vec3f(0.0, 0.0, 1.0), facing, dot(face, face) > 1e-20);
    // Back to the world: the matrix is a rotation.
    return normalize(turned * mat3x3f(view.eye_from_world[0].xyz, view.eye_from_world[1].xyz, view.eye_from_world[2].xyz));
}

// An interpolated normal near a silhouette may look away while its face does not, so the face decides the side.
fn facing_normal(normal: vec3f, face: vec3f) -> vec3f {
    let length2 = dot(normal, normal);
    if length2 < 1e-20 {
        return face;
    }
    let n = normal * inverseSqrt(length2);
    return select(n, -n, dot(n, face) < 0.0);
}

// IEC 61966-2-1; opacity is not encoded.
fn linear_from_srgb(encoded: vec4f) -> vec4f {
    let c = encoded.rgb;
    let linear = select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
    return vec4f(linear, encoded.a);
}

// Bilinear: four texels are decoded and then blended. The sampler takes the nearest texel, here always in its middle, and
// wraps what lies outside.
fn texture_at_point(texture: texture_2d<f32>, uv: vec2f, decodes: bool) -> vec4f {
    let size = vec2f(textureDimensions(texture));
    let texels = uv * size - 0.5;
    let low = floor(texels);
    let share = texels - low;
    var rows: array<vec4f, 2>;
    for (var y = 0; y < 2; y++) {
        var row: array<vec4f, 2>;
        for (var x = 0; x < 2; x++) {
            let middle = low + vec2f(vec2i(x, y)) + 0.5;
            let texel = textureSampleLevel(texture, material_sampler, middle / size, 0.0);
            row[x] = select(texel, linear_from_srgb(texel), decodes);
        }
        rows[y] = mix(row[0], row[1], share.x);
    }
    return mix(rows[0], rows[1], share.y);
}

fn surface_at(in: Varyings) -> Surface {
    var base: vec4f;
    var glow: vec4f;
    if LOOKS_UP_POINTS {
        base = texture_at_point(base_color_texture, in.uv, material.decodes_base_color != 0u);
        glow = texture_at_point(emission_texture, in.uv, material.decodes_emission != 0u);
    } else {
        base = textureSample(base_color_texture, material_sampler, in.uv);
        glow = textureSample(emission_texture, material_sampler, in.uv);
    }
    let albedo = material.base_color * base * in.color;
    let plane_normal = normal_to_face(in.eye);
    let toward = toward_view(in.eye);
    let face = visible_face(plane_normal, toward);
    let normal = facing_normal(in.normal, face);
    return Surface(albedo, material.emission * glow.rgb, normal, face, is_edge_on(plane_normal, toward));
}
