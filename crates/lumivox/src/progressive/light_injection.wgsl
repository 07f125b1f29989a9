// Injection of light: one point of the view's injection grid per invocation, added to the sums of its cell.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var radiance: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> light_sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;
override LIGHT_SUM_WORDS: u32;
// Whether samples add up by the surface that they stand for.
override BY_AREA: bool;
// Steps of such a sum per cell face of the largest radiance.
override LIGHT_STEPS: f32;

fn add(at: u32, values: vec4f, steps: f32) {
    let fixed = vec4i(round(values * steps));
    for (var i = 0u; i < 4u; i++) {
        atomicAdd(&light_sums[at + i], fixed[i]);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    let point = surface_point(grid, view, depth, normal, index, SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    var leaving = within_range(view, textureLoad(radiance, point.texel, 0).rgb);
    // The linear coefficients reach 1.03 times the radiance; the steps leave a factor of two of room.
    var steps = view.light_steps;
    if BY_AREA {
        let recorded = textureLoad(depth, point.texel, 0).r;
        leaving *= point_area(grid, view, point.texel, recorded, point.normal);
        steps = LIGHT_STEPS / view.radiance_max;
    }
    let light = sh_scaled(leaving, sh_cosine_lobe(point.normal));
    let at = LIGHT_SUM_WORDS * point.cell_index;
    add(at, light.r, steps);
    add(at + 4u, light.g, steps);
    add(at + 8u, light.b, steps);
    atomicAdd(&light_sums[at + 12u], 1);
}
