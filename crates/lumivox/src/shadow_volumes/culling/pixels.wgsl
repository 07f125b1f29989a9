// One pixel of the picture per invocation: the bit of its layer, in the texel in which the light would see it. Exactly the surfaces
// that are visible (the paper's pixel-based receiver culling).

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var receivers: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> slices: array<atomic<u32>>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= volume.size) || textureLoad(receivers, id.xy, 0).r < 0.0 {
        return;
    }
    let world = world_of_pixel(id.xy, textureLoad(depth, id.xy, 0).r);
    let clip = map.clip_from_world * vec4f(world, 1.0);
    if !is_inside(clip) {
        return;
    }
    let uv = vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5;
    let texel = min(vec2u(max(uv, vec2f(0.0)) * vec2f(map.size)), map.size - 1u);
    let layer = volume_layer(id.xy);
    atomicOr(&slices[column_of(map.size, texel) * volume.words + layer / 32u], 1u << (layer % 32u));
}
