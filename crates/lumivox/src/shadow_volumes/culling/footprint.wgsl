// Casting triangles into the texels that their casters have of their own: the range of distances in each.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(4) var<storage, read> facing: array<i32>;
@group(0) @binding(5) var<storage, read> rects: array<u32>;
// Of each texel the inverted bits of the nearest distance and the bits of the farthest, which are in order; 0 where nothing is.
@group(0) @binding(6) var<storage, read_write> footprints: array<atomic<u32>>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Boxed {
    let n = index / 6u;
    if facing[n] == 0 {
        return no_box();
    }
    return box_corner(points_in(map.clip_from_world, corners_of(triangles[n])), map.size, index, n);
}

@fragment
fn fragment_main(f: Boxed) {
    let texel = vec2u(f.position.xy);
    let triangle = triangles[f.number];
    let corners = corners_of(triangle);
    let points = points_in(map.clip_from_world, corners);
    let piece = piece_in(points, values_at(map.distance, corners), texel, map.size);
    let place = place_of(rect_of(triangle.w & 0x7fffffffu), texel);
    if piece.distance.x > piece.distance.y || place == NO_PLACE {
        return;
    }
    atomicMax(&footprints[2u * place], ~bitcast<u32>(max(piece.distance.x, 0.0)));
    atomicMax(&footprints[2u * place + 1u], bitcast<u32>(max(piece.distance.y, 0.0)));
}
