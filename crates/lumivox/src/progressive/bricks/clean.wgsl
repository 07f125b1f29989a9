// Cleanup of bricks: a brick of this frame's list per workgroup, a cell per invocation, in place. The rule stands in a part of
// its own.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> bricks: BrickUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> headers: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read> lists: array<u32>;
@group(0) @binding(6) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> boxes: array<vec4f>;

// Bricks lie on the circle by multiples of the golden section, so that any part of it has its share of them.
fn has_turn(slot: u32) -> bool {
    // 0.618.. of 2^32: the product wraps as the circle does.
    let place = f32((slot * 2654435769u) >> 8u) / 16777216.0;
    return fract(place - bricks.turn_from + 1.0) < bricks.turn_share;
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) number: u32) {
    let n = group.x + groups.x * group.y;
    if n >= atomicLoad(&counters[LISTED + bricks.side]) {
        return;
    }
    let slot = lists[list_start(bricks, bricks.side) + n];
    if !has_turn(slot) {
        return;
    }
    let header = HEADER * slot;
    let bit = 1u << (number % 32u);
    let word = header + AT_BITS + number / 32u;
    let pinned = atomicLoad(&headers[header + AT_PINNED + number / 32u]);
    if (atomicLoad(&headers[word]) & ~pinned & bit) == 0u {
        return;
    }
    let brick = vec3i(
        bitcast<i32>(atomicLoad(&headers[header])),
        bitcast<i32>(atomicLoad(&headers[header + 1u])),
        bitcast<i32>(atomicLoad(&headers[header + 2u])),
    );
    let cell = BRICK_SIDE * vec3u(brick - bricks.first) + place_in_brick(number);
    if !may_change(cell_center(grid, cell) - 0.5 * grid.cell_size, grid.cell_size) {
        return;
    }
    if proven_empty(cell) {
        atomicAnd(&headers[word], ~bit);
        atomicAdd(&counters[CLEANED], 1u);
    }
}
