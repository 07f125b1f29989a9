// The geometry volume: its cells are those of the grid moved by half a cell, so that their centres are the grid's corners.

fn corner_dims(grid: GridUniform) -> vec3u {
    return grid.dims + 1u;
}

fn corner_count(grid: GridUniform) -> u32 {
    let dims = corner_dims(grid);
    return dims.x * dims.y * dims.z;
}

fn corner_index(grid: GridUniform, corner: vec3u) -> u32 {
    let dims = corner_dims(grid);
    return corner.x + dims.x * (corner.y + dims.y * corner.z);
}
