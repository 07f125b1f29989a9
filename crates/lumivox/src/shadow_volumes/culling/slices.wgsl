// Triangles of visible meshes into the bits of the layers that they touch: a slicemap whose slices follow the picture's layers.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(4) var<storage, read> visible: array<u32>;
@group(0) @binding(5) var<storage, read_write> slices: array<atomic<u32>>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Boxed {
    let n = index / 6u;
    let triangle = triangles[n];
    if visible[triangle.w & 0x7fffffffu] == 0u {
        return no_box();
    }
    return box_corner(points_in(map.clip_from_world, corners_of(triangle)), map.size, index, n);
}

@fragment
fn fragment_main(f: Boxed) {
    let texel = vec2u(f.position.xy);
    let corners = corners_of(triangles[f.number]);
    let points = points_in(map.clip_from_world, corners);
    let piece = piece_in(points, values_at(map.distance, corners), texel, map.size);
    if piece.distance.x > piece.distance.y {
        return;
    }
    // A pixel more on each side.
    let pixels = f32(volume.size[volume.axis]);
    let ends = (0.5 * piece.place + 0.5) * pixels + vec2f(-1.0, 1.0);
    if ends.y < 0.0 || ends.x >= pixels {
        return;
    }
    let layers = vec2u(clamp(ends, vec2f(0.0), vec2f(pixels - 1.0))) * volume.layers / u32(pixels);
    let column = column_of(map.size, texel);
    for (var layer = layers.x; layer <= layers.y; layer++) {
        atomicOr(&slices[column * volume.words + layer / 32u], 1u << (layer % 32u));
    }
}
