// One triangle per invocation: on which sides of a lamp its caster has corners of closed parts, a bit for each way along each axis. With all
// six the lamp may be inside.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> around: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.triangles || volume.light.w == 0.0 {
        return;
    }
    let triangle = triangles[n];
    if (triangle.w & 0x80000000u) == 0u {
        return;
    }
    var sides = 0u;
    for (var k = 0u; k < 3u; k++) {
        let way = vertices[triangle[k]].xyz - volume.light.xyz;
        sides |= dot(vec3u(way >= vec3f(0.0)), vec3u(1u, 2u, 4u)) | dot(vec3u(way <= vec3f(0.0)), vec3u(8u, 16u, 32u));
    }
    let caster = triangle.w & 0x7fffffffu;
    // Most triangles add nothing, and need not wait for each other.
    if (sides & ~atomicLoad(&around[caster])) != 0u {
        atomicOr(&around[caster], sides);
    }
}
