// Injection of blockers: one point of the view's injection grid per invocation, added to the sums of its corner.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> geometry_sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;
override AREA_STEPS: f32;
override GEOMETRY_SUM_WORDS: u32;

fn add(at: u32, value: f32) {
    atomicAdd(&geometry_sums[at], i32(round(value * AREA_STEPS)));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= view.points.x * view.points.y {
        return;
    }
    let point = surface_point(grid, view, depth, normal, index, SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let recorded = textureLoad(depth, point.texel, 0).r;
    let area = point_area(grid, view, point.texel, recorded, point.normal);
    let p = grid_from_world(grid, world_from_texel(view, point.texel, recorded)) - SURFACE_SHIFT * point.normal;
    let corner = min(vec3u(round(max(p, vec3f(0.0)))), grid.dims);
    let reflectance = saturate(textureLoad(albedo, point.texel, 0).rgb);
    let at = GEOMETRY_SUM_WORDS * corner_index(grid, corner);
    add(at, area);
    for (var i = 0u; i < 3u; i++) {
        add(at + 1u + i, area * point.normal[i]);
        add(at + 4u + i, area * reflectance[i]);
    }
}
