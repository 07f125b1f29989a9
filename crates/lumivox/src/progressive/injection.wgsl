// Injection of attributes: one point of the view's injection grid per invocation, added to the sums of its cell.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var emission: texture_2d<f32>;
@group(0) @binding(6) var<storage, read_write> attribute_sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;
override ATTRIBUTE_SUM_WORDS: u32;

fn add(at: u32, values: vec3f, steps: f32) {
    let fixed = vec3i(round(values * steps));
    for (var i = 0u; i < 3u; i++) {
        atomicAdd(&attribute_sums[at + i], fixed[i]);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    let point = surface_point(grid, view, depth, normal, index, SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let at = ATTRIBUTE_SUM_WORDS * point.cell_index;
    let emitted = within_range(view, textureLoad(emission, point.texel, 0).rgb);
    add(at, point.normal, view.unit_steps);
    add(at + 3u, saturate(textureLoad(albedo, point.texel, 0).rgb), view.unit_steps);
    add(at + 6u, emitted, emission_steps(view));
    atomicAdd(&attribute_sums[at + 9u], 1);
}
