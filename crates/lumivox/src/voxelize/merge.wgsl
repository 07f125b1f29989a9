// Adds one layer's sums to another's.

struct WindowUniform {
    first: u32,
    count: u32,
    axis: u32,
    // The layers of cells that it reaches.
    first_layer: u32,
    last_layer: u32,
    base: u32,
}

@group(0) @binding(0) var<uniform> window: WindowUniform;
@group(0) @binding(1) var<storage, read> occupancy_in: array<u32>;
@group(0) @binding(2) var<storage, read> sums_in: array<u32>;
@group(0) @binding(3) var<storage, read_write> occupancy: array<u32>;
@group(0) @binding(4) var<storage, read_write> sums: array<u32>;

fn lv_merge_wide(at: u32) {
    let before = sums[at];
    sums[at] = before + sums_in[at];
    sums[at + 1u] += sums_in[at + 1u] + select(0u, 1u, sums_in[at] > 0xffffffffu - before);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = id.x + id.y * workgroups.x * 64u;
    if index >= (window.count + 31u) / 32u {
        return;
    }
    let word = window.first / 32u + index;
    var bits = occupancy_in[word];
    occupancy[word] |= bits;
    while bits != 0u {
        let cell = 32u * word + firstTrailingBit(bits);
        lv_merge((cell - window.first) * LV_SUM_WORDS);
        bits &= bits - 1u;
    }
}
