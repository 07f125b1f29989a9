// Values of one channel of what stands still: a cell of these layers per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> bricks: BrickUniform;
@group(0) @binding(2) var<uniform> part: StaticUniform;
@group(0) @binding(3) var<storage, read> occupancy: array<u32>;
@group(0) @binding(4) var<storage, read> source: array<vec2u>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read_write> values: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> shown: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.dims.x * grid.dims.y * part.layers {
        return;
    }
    if (occupancy[index / 32u] >> (index % 32u) & 1u) == 0u {
        return;
    }
    let cell = cell_from_index(grid, index) + vec3u(0u, 0u, part.first_layer);
    let entry = table[table_index(bricks, cell / BRICK_SIDE)];
    if entry < FIRST_SLOT {
        return;
    }
    let at = BRICK_CELLS * (entry - FIRST_SLOT) + cell_in_brick(cell);
    values[part.channels * at + part.channel] = source[index];
    shown[at] = bricks.frame & ((1u << FRAME_BITS) - 1u);
}
