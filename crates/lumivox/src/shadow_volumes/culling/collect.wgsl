// One caster of a set of queries per invocation: their answers as bits.

struct QueriedUniform {
    first: u32,
    count: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> queried: QueriedUniform;
// 64 bits each.
@group(0) @binding(2) var<storage, read> answers: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> kept: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= queried.count {
        return;
    }
    let first = (queried.first + id.x) * (volume.words + 1u);
    let answer = id.x * (volume.layers + 1u);
    for (var layer = 0u; layer < volume.layers; layer++) {
        if any(answers[answer + layer] != vec2u(0u)) {
            kept[first + 1u + layer / 32u] |= 1u << (layer % 32u);
        }
    }
    if any(answers[answer + volume.layers] != vec2u(0u)) {
        kept[first] = 1u;
    }
}
