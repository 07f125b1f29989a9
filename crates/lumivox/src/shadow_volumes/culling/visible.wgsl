// All triangles into the picture, and all pixels that they touch: which meshes are visible there.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(3) var receivers: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> visible: array<atomic<u32>>;

// Of the distance, and of the bias: what a depth image may be off.
const TOLERANCE: f32 = 1e-3;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Boxed {
    let n = index / 6u;
    return box_corner(points_in(volume.clip_from_world, corners_of(triangles[n])), volume.size, index, n);
}

@fragment
fn fragment_main(f: Boxed) {
    let pixel = vec2u(f.position.xy);
    let surface = textureLoad(receivers, pixel, 0).r;
    let triangle = triangles[f.number];
    let corners = corners_of(triangle);
    let points = points_in(volume.clip_from_world, corners);
    let range = piece_in(points, values_at(volume.distance, corners), pixel, volume.size).distance;
    let room = TOLERANCE * surface + volume.bias;
    if surface >= 0.0 && range.x <= range.y && surface >= range.x - room && surface <= range.y + room {
        atomicOr(&visible[triangle.w & 0x7fffffffu], 1u);
    }
}
