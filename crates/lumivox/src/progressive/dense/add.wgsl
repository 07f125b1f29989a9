// Injection into a volume over all cells: a point of the view's injection grid per invocation, added to the sums of its cell.
// `add_attributes` is made of the channels.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let point = surface_point(grid, view, depth, normal, linear_id(id, workgroups), SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let at = SUM_WORDS * point.cell_index;
    add_attributes(at, point.texel, point.normal);
    atomicAdd(&sums[at + SUM_WORDS - 1u], 1);
}
