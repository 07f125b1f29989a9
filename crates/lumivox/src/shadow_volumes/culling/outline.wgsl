// Edges with sides into the texels of their casters: these are not covered all over.

struct EdgeRecord {
    vertices: vec2u,
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> edges: array<EdgeRecord>;
@group(0) @binding(4) var<storage, read> edge_casters: array<u32>;
@group(0) @binding(5) var<storage, read> nets: array<i32>;
@group(0) @binding(6) var<storage, read> rects: array<u32>;
@group(0) @binding(7) var<storage, read_write> footprints: array<atomic<u32>>;

fn edge_corners(n: u32) -> array<vec3f, 3> {
    let ends = edges[n].vertices;
    return array<vec3f, 3>(vertices[ends.x].xyz, vertices[ends.y].xyz, vertices[ends.y].xyz);
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Boxed {
    let n = index / 6u;
    if nets[n] == 0 {
        return no_box();
    }
    return box_corner(points_in(map.clip_from_world, edge_corners(n)), map.size, index, n);
}

@fragment
fn fragment_main(f: Boxed) {
    let texel = vec2u(f.position.xy);
    let corners = edge_corners(f.number);
    let points = points_in(map.clip_from_world, corners);
    let piece = piece_in(points, values_at(map.distance, corners), texel, map.size);
    let place = place_of(rect_of(edge_casters[f.number]), texel);
    if piece.distance.x <= piece.distance.y && place != NO_PLACE {
        atomicMax(&footprints[2u * place + 1u], 0xffffffffu);
    }
}
