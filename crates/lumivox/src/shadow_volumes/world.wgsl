// The welded vertices of one mesh, in the world.

struct PartUniform {
    first: u32,
    count: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<uniform> part: PartUniform;
@group(0) @binding(1) var<storage, read> sources: array<u32>;
// 0 at the end of what is no point.
@group(0) @binding(2) var<storage, read_write> vertices: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = id.x + id.y * groups.x * 64u;
    if n >= part.count {
        return;
    }
    let source = sources[part.first + n];
    var world = vec4f(0.0);
    if source < mesh.counts.x {
        let p = (mesh.world_from_local * vec4f(lv_local_position(source), 1.0)).xyz;
        // Not so of what is no number.
        if all(abs(p) < vec3f(1e18)) {
            world = vec4f(p, 1.0);
        }
    }
    vertices[part.first + n] = world;
}
