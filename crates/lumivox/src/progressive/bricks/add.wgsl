// Injection into bricks: a point of the view's injection grid per invocation, added to the sums of its cell. `add_attributes`
// is made of the channels.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> bricks: BrickUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read> headers: array<u32>;
@group(0) @binding(7) var<storage, read_write> sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let point = surface_point(grid, view, depth, normal, linear_id(id, workgroups), SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let cell = cell_from_index(grid, point.cell_index);
    let entry = table[table_index(bricks, cell / BRICK_SIDE)];
    if entry < FIRST_SLOT {
        return;
    }
    let header = HEADER * (entry - FIRST_SLOT);
    let number = cell_in_brick(cell);
    if (headers[header + AT_PINNED + number / 32u] >> (number % 32u) & 1u) == 1u {
        return;
    }
    let place = headers[header + AT_SUMS];
    if place == NO_SUMS {
        return;
    }
    let at = SUM_WORDS * (BRICK_CELLS * place + number);
    add_attributes(at, point.texel, point.normal);
    atomicAdd(&sums[at + SUM_WORDS - 1u], 1);
}
