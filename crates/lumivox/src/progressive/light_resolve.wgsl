// Sums of one light's samples, or their mean, added to or in place of what the cell holds. `keeps_light` is made of the rule.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<storage, read> light_sums: array<i32>;
@group(0) @binding(3) var<storage, read_write> light: array<vec2u>;

// Adds to the light of the cell or replaces it.
override ADDS: bool;
override LIGHT_SUM_WORDS: u32;
// Whether samples add up by the surface that they stand for; else their mean is taken.
override BY_AREA: bool;
override LIGHT_STEPS: f32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let at = LIGHT_SUM_WORDS * index;
    let count = f32(light_sums[at + 12u]);
    if count == 0.0 {
        return;
    }
    var whole = count * view.light_steps;
    if BY_AREA {
        whole = LIGHT_STEPS / view.radiance_max;
    }
    let keeps = keeps_light(index, ADDS);
    for (var band = 0u; band < 3u; band++) {
        let first = at + 4u * band;
        let sum = vec4i(light_sums[first], light_sums[first + 1u], light_sums[first + 2u], light_sums[first + 3u]);
        let before = select(vec4f(0.0), unpack_half4(light[3u * index + band]), keeps);
        light[3u * index + band] = pack_half4(before + vec4f(sum) / whole);
    }
}
