// One edge per invocation: its sides, from the edge to infinity.

struct EdgeRecord {
    vertices: vec2u,
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> edges: array<EdgeRecord>;
@group(0) @binding(3) var<storage, read> edge_casters: array<u32>;
@group(0) @binding(4) var<storage, read> nets: array<i32>;
@group(0) @binding(5) var<storage, read> kept: array<u32>;
@group(0) @binding(6) var<storage, read_write> lists: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> primitives: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.edges {
        return;
    }
    let net = nets[n];
    // The side runs along the edge the other way than the caps do.
    let ends = select(edges[n].vertices, edges[n].vertices.yx, net > 0);
    let corners = vec4u(ends, ends.yx | vec2u(AT_INFINITY));
    // All lines of parallel light meet in one point.
    let count = select(4u, 3u, volume.light.w == 0.0);
    for (var side = 0; side < abs(net); side++) {
        put(edge_casters[n], corners, count, true);
    }
}
