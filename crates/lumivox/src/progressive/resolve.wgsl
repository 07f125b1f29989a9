// Sums of attributes to means, one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> attribute_sums: array<i32>;
@group(0) @binding(2) var<storage, read_write> normal_out: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> albedo_out: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> emission_out: array<vec2u>;
@group(0) @binding(5) var<uniform> view: ViewUniform;

override ATTRIBUTE_SUM_WORDS: u32;

fn mean(at: u32, count: f32, steps: f32) -> vec3f {
    let sum = vec3i(attribute_sums[at], attribute_sums[at + 1u], attribute_sums[at + 2u]);
    return vec3f(sum) / (count * steps);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let at = ATTRIBUTE_SUM_WORDS * index;
    let count = f32(attribute_sums[at + 9u]);
    if count == 0.0 {
        return;
    }
    normal_out[index] = pack_half4(vec4f(mean(at, count, view.unit_steps), 1.0));
    albedo_out[index] = pack_half4(vec4f(mean(at + 3u, count, view.unit_steps), 0.0));
    emission_out[index] = pack_half4(vec4f(mean(at + 6u, count, emission_steps(view)), 0.0));
}
