// One triangle per invocation: whether it casts, and from which side it is seen by the light. Of a closed part the triangles that face the
// light are enough, since whatever leaves it has entered it; but not if the light may be inside.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
// Corners; the caster, and the highest bit if its part of the mesh is closed.
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
// Of each caster the sides of the light on which it has corners.
@group(0) @binding(3) var<storage, read> around: array<u32>;
// 1 and -1: casts, as it is or turned over; 0: does not cast.
@group(0) @binding(4) var<storage, read_write> facing: array<i32>;

const ALL_SIDES: u32 = 63u;

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
    let is_outside = around[triangle.w & 0x7fffffffu] != ALL_SIDES;
    facing[n] = select(select(-1, 0, is_closed && is_outside), 1, faces);
}
