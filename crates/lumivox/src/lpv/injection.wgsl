// Injection of virtual point lights: one point of the view's injection grid per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var radiance: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> light_sums: array<atomic<i32>>;

override HALF_CELL: f32;
override LIGHT_STEPS: f32;

fn add(at: u32, values: vec4f) {
    let fixed = vec4i(round(values * (LIGHT_STEPS / view.radiance_max)));
    for (var i = 0u; i < 4u; i++) {
        atomicAdd(&light_sums[at + i], fixed[i]);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= view.points.x * view.points.y {
        return;
    }
    let point = surface_point(grid, view, depth, normal, index, -HALF_CELL);
    if !point.exists {
        return;
    }
    let leaving = within_range(view, textureLoad(radiance, point.texel, 0).rgb);
    let recorded = textureLoad(depth, point.texel, 0).r;
    let area = point_area(grid, view, point.texel, recorded, point.normal);
    // A Lambertian patch: intensity = radiance * area * cosine.
    let light = sh_scaled(area * leaving, sh_cosine_lobe(point.normal));
    let at = 12u * point.cell_index;
    add(at, light.r);
    add(at + 4u, light.g);
    add(at + 8u, light.b);
}
