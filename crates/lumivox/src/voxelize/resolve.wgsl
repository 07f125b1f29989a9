// From sums to values.

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
@group(0) @binding(1) var<storage, read> occupancy: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<u32>;

fn lv_wide(at: u32) -> f32 {
    return f32(sums[at + 1u]) * 4294967296.0 + f32(sums[at]);
}

fn lv_signed_wide(at: u32) -> f32 {
    let high = bitcast<i32>(sums[at + 1u]);
    if high < 0 {
        // Of the complement, so that small negative sums keep their digits.
        let low = ~sums[at] + 1u;
        let carried = ~bitcast<u32>(high) + select(0u, 1u, low == 0u);
        return -(f32(carried) * 4294967296.0 + f32(low));
    }
    return f32(high) * 4294967296.0 + f32(sums[at]);
}

fn lv_from_ordered(key: u32) -> f32 {
    if key == 0u {
        return 0.0;
    }
    return bitcast<f32>(select(~key, key & 0x7fffffffu, (key >> 31u) == 1u));
}

// What no finite number is becomes 0.
fn lv_finite(v: vec4f) -> vec4f {
    let bits = bitcast<vec4u>(v) & vec4u(0x7f800000u);
    return select(v, vec4f(0.0), bits == vec4u(0x7f800000u));
}

fn lv_to_unit(v: vec4f) -> vec4f {
    let length = length(v.xyz);
    return vec4f(select(vec3f(0.0), v.xyz / length, length > 1e-20), v.w);
}

fn lv_bytes(v: vec4f, low: f32, width: f32) -> u32 {
    return pack4x8unorm(clamp((v - low) / width, vec4f(0.0), vec4f(1.0)));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    // A window begins at a whole word. Words after the grid's last cell do not exist.
    let index = id.x + id.y * workgroups.x * 64u;
    if index >= (window.count + 31u) / 32u {
        return;
    }
    let word = window.first / 32u + index;
    var bits = occupancy[word];
    while bits != 0u {
        let cell = 32u * word + firstTrailingBit(bits);
        lv_resolve(cell, (cell - window.first) * LV_SUM_WORDS);
        bits &= bits - 1u;
    }
}
