// Surfaces: the vertex stage and the material, shared by G-buffers and reflective shadow maps.

struct MaterialUniform {
    base_color: vec4f,
    emission: vec3f,
    alpha_cutoff: f32,
}

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
}

// The side of the triangle that the view sees.
fn visible_face(eye: vec3f) -> vec3f {
    let face = cross(brought_to_one(dpdx(eye)), brought_to_one(dpdy(eye)));
    let m = view.clip_from_world;
    let orthographic = m[0].w == 0.0 && m[1].w == 0.0 && m[2].w == 0.0;
    let toward_view = select(-brought_to_one(eye), vec3f(0.0, 0.0, 1.0), orthographic);
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

fn surface_at(in: Varyings) -> Surface {
    let base = textureSample(base_color_texture, material_sampler, in.uv);
    let glow = textureSample(emission_texture, material_sampler, in.uv).rgb;
    let albedo = material.base_color * base * in.color;
    let face = visible_face(in.eye);
    return Surface(albedo, material.emission * glow, facing_normal(in.normal, face), face);
}
