// One triangle per invocation: whether it casts, and from which side it is seen by the light.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
// Corners; the caster, and the highest bit if its part of the mesh is closed.
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
// 1 and -1: casts, as it is or turned over; 0: does not cast.
@group(0) @binding(3) var<storage, read_write> facing: array<i32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.triangles {
        return;
    }
    let triangle = triangles[n];
    let a = vertices[triangle.x];
    let b = vertices[triangle.y];
    let c = vertices[triangle.z];
    if a.w * b.w * c.w == 0.0 {
        facing[n] = 0;
        return;
    }
    let towards = select(volume.light.xyz - a.xyz, -volume.light.xyz, volume.light.w == 0.0);
    let faces = dot(cross(b.xyz - a.xyz, c.xyz - a.xyz), towards) > 0.0;
    let is_closed = (triangle.w & 0x80000000u) != 0u;
    facing[n] = select(select(-1, 0, is_closed), 1, faces);
}
