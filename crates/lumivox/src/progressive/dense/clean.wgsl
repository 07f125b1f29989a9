// Cleanup of a volume over all cells: one cell per invocation. `is_occupied` and `finish`, which clears the cell or keeps it, are made of
// the storage; `proven_empty` is the rule.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let cell = cell_from_index(grid, index);
    finish(cell, is_occupied(cell) && proven_empty(cell));
}
