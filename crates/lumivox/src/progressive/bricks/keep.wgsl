// The begin of a frame: a brick of the last frame's list per invocation. Cells that no view has shown for long die, bricks without
// cells and those that the window has left behind give their slots back, and the others make up this frame's list.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> bricks: BrickUniform;
@group(0) @binding(2) var<storage, read_write> table: array<u32>;
@group(0) @binding(3) var<storage, read_write> headers: array<u32>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read> shown: array<u32>;
@group(0) @binding(7) var<storage, read> boxes: array<vec4f>;


// The bits of the cells of one half of a brick that have not been shown for too long.
fn too_old(slot: u32, half: u32, bits: u32) -> u32 {
    var dead = 0u;
    var left = bits;
    for (var n = countOneBits(bits); n > 0u; n--) {
        let number = firstTrailingBit(left);
        left &= left - 1u;
        let word = shown[BRICK_CELLS * slot + 32u * half + number];
        let age = (bricks.frame - word) & ((1u << FRAME_BITS) - 1u);
        if age > bricks.max_age && (word >> FRAME_BITS) < bricks.confident {
            dead |= 1u << number;
        }
    }
    return dead;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let n = linear_id(id, workgroups);
    if n >= atomicLoad(&counters[LISTED + 1u - bricks.side]) {
        return;
    }
    let slot = lists[list_start(bricks, 1u - bricks.side) + n];
    let header = HEADER * slot;
    let number = vec3i(bitcast<i32>(headers[header]), bitcast<i32>(headers[header + 1u]), bitcast<i32>(headers[header + 2u]));
    let within = number - bricks.first;
    let is_inside = all(within >= vec3i(0)) && all(within < vec3i(bricks.dims));
    var bits = vec2u(headers[header + AT_BITS], headers[header + AT_BITS + 1u]);
    let pinned = vec2u(headers[header + AT_PINNED], headers[header + AT_PINNED + 1u]);
    let side = f32(BRICK_SIDE) * grid.cell_size;
    if is_inside && bricks.max_age > 0u && may_change(grid.origin + side * vec3f(within), side) {
        let mortal = bits & ~pinned;
        let dead = vec2u(too_old(slot, 0u, mortal.x), too_old(slot, 1u, mortal.y));
        bits &= ~dead;
        headers[header + AT_BITS] = bits.x;
        headers[header + AT_BITS + 1u] = bits.y;
        atomicAdd(&counters[DIED], countOneBits(dead.x) + countOneBits(dead.y));
    }
    let occupied = countOneBits(bits.x) + countOneBits(bits.y);
    if is_inside && occupied > 0u {
        atomicAdd(&counters[OCCUPIED], occupied);
        atomicAdd(&counters[PINNED], countOneBits(pinned.x) + countOneBits(pinned.y));
        lists[list_start(bricks, bricks.side) + atomicAdd(&counters[LISTED + bricks.side], 1u)] = slot;
        return;
    }
    headers[header + AT_BITS] = 0u;
    headers[header + AT_BITS + 1u] = 0u;
    headers[header + AT_PINNED] = 0u;
    headers[header + AT_PINNED + 1u] = 0u;
    let at = wrapped(number, bricks.dims);
    table[at.x + bricks.dims.x * (at.y + bricks.dims.y * at.z)] = NO_BRICK;
    lists[free_start(bricks) + atomicAdd(&counters[FREE], 1u)] = slot;
    atomicAdd(&counters[LEFT], 1u);
}
