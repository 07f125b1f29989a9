// One edge per invocation: how many casting triangles run along it forwards more than backwards. Where it is not 0 the volume has as
// many sides: what is left of the borders of all triangles is the border of their sum, whatever they are.

struct EdgeRecord {
    vertices: vec2u,
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> edges: array<EdgeRecord>;
@group(0) @binding(2) var<storage, read> incidences: array<u32>;
@group(0) @binding(3) var<storage, read> facing: array<i32>;
@group(0) @binding(4) var<storage, read_write> nets: array<i32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.edges {
        return;
    }
    let edge = edges[n];
    var net = 0;
    for (var i = 0u; i < edge.count; i++) {
        let incidence = incidences[edge.first + i];
        net += facing[incidence >> 1u] * select(1, -1, (incidence & 1u) != 0u);
    }
    nets[n] = net;
}
