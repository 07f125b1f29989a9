// The grid: the GPU's side of lumivox_core::Grid.

struct GridUniform {
    origin: vec3f,
    cell_size: f32,
    dims: vec3u,
    cell_count: u32,
}

const WORKGROUP: u32 = 64u;

// The running number of an invocation in a dispatch of many one-dimensional workgroups, laid out in two dimensions
// because one holds 65,535 at most.
fn linear_id(global_id: vec3u, workgroups: vec3u) -> u32 {
    return global_id.x + global_id.y * workgroups.x * WORKGROUP;
}

fn cell_index(grid: GridUniform, cell: vec3u) -> u32 {
    return cell.x + grid.dims.x * (cell.y + grid.dims.y * cell.z);
}

fn cell_from_index(grid: GridUniform, index: u32) -> vec3u {
    let rows = index / grid.dims.x;
    return vec3u(index % grid.dims.x, rows % grid.dims.y, rows / grid.dims.y);
}

fn cell_center(grid: GridUniform, cell: vec3u) -> vec3f {
    return grid.origin + grid.cell_size * (vec3f(cell) + 0.5);
}

fn grid_from_world(grid: GridUniform, world: vec3f) -> vec3f {
    return (world - grid.origin) / grid.cell_size;
}

// Cells are half-open, but the grid owns its upper faces.
fn inside_grid(grid: GridUniform, p: vec3f) -> bool {
    return all(p >= vec3f(0.0)) && all(p <= vec3f(grid.dims));
}

fn cell_from_grid(grid: GridUniform, p: vec3f) -> vec3u {
    return min(vec3u(floor(p)), grid.dims - 1u);
}

fn cell_in_grid(grid: GridUniform, cell: vec3i) -> bool {
    return all(cell >= vec3i(0)) && all(cell < vec3i(grid.dims));
}
