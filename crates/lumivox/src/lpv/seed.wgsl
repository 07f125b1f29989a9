// Sums of virtual point lights to the first state of one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<storage, read> light_sums: array<vec4i>;
@group(0) @binding(3) var<storage, read_write> state: array<vec2u>;

override LIGHT_STEPS: f32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    for (var band = 0u; band < 3u; band++) {
        let sum = vec4f(light_sums[3u * index + band]);
        state[3u * index + band] = pack_half4(sum * (view.radiance_max / LIGHT_STEPS));
    }
}
