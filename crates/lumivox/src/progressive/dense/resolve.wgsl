// The end of injection into a volume over all cells: one cell per invocation. `store_means` is made of the storage and the channels.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<storage, read> sums: array<i32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let at = SUM_WORDS * index;
    let count = f32(sums[at + SUM_WORDS - 1u]);
    if count > 0.0 {
        store_means(cell_from_index(grid, index), at, count);
    }
}
