// One triangle per invocation: the volume's cap at the surface, and for a point light the one at infinity. Of parallel light that
// is a point.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(3) var<storage, read> facing: array<i32>;
@group(0) @binding(4) var<storage, read> kept: array<u32>;
@group(0) @binding(5) var<storage, read_write> lists: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> primitives: array<u32>;

// Whether a direction passes an edge of a cone on its inner side. Both triangles of an edge compute one and the same number, and exactly
// one of them holds what lies on the edge itself.
fn passes(a: u32, b: u32, along: vec3f) -> bool {
    let first = away_from_light(vertices[min(a, b)].xyz);
    let second = away_from_light(vertices[max(a, b)].xyz);
    return (dot(cross(first, second), along) < 0.0) == (a < b);
}

// All rays of a parallel view end in one point at infinity: whether a cap there holds it. The corners are those of a triangle that faces
// the light.
fn holds_view(corners: vec4u) -> bool {
    let along = volume.distance.xyz;
    return passes(corners.x, corners.y, along) && passes(corners.y, corners.z, along) && passes(corners.z, corners.x, along);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.triangles {
        return;
    }
    let side = facing[n];
    if side == 0 {
        return;
    }
    let triangle = triangles[n];
    let corners = vec4u(select(triangle.xzy, triangle.xyz, side > 0), 0u);
    let caster = triangle.w & 0x7fffffffu;
    put(caster, corners, 3u, false);
    if volume.light.w == 0.0 {
        return;
    }
    if volume.near > 0.0 {
        put(caster, corners.xzyw | vec4u(AT_INFINITY), 3u, false);
    } else if holds_view(corners) {
        put(caster, vec4u(SCREEN, SCREEN + 1u, SCREEN + 2u, 0u), 3u, false);
    }
}
