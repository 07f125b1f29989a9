// The bricks that a view's points fall into: a point of the view's injection grid per invocation. A brick that is not there yet
// gets a slot, and one that no other point has touched in this frame gets a place for its sums.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> bricks: BrickUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> table: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> headers: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> lists: array<u32>;
@group(0) @binding(8) var<storage, read_write> counters: array<atomic<u32>>;

override SURFACE_SHIFT: f32;

// A slot for a brick that has none; NO_BRICK where there is no room.
fn new_slot(brick: vec3u) -> u32 {
    let left = bitcast<i32>(atomicSub(&counters[FREE], 1u));
    if left <= 0 {
        atomicAdd(&counters[FREE], 1u);
        return NO_BRICK;
    }
    let slot = lists[free_start(bricks) + u32(left) - 1u];
    let header = HEADER * slot;
    let number = bricks.first + vec3i(brick);
    for (var axis = 0u; axis < 3u; axis++) {
        atomicStore(&headers[header + axis], bitcast<u32>(number[axis]));
    }
    lists[list_start(bricks, bricks.side) + atomicAdd(&counters[LISTED + bricks.side], 1u)] = slot;
    atomicAdd(&counters[ENTERED], 1u);
    return slot + FIRST_SLOT;
}

fn touch(slot: u32) {
    let header = HEADER * slot;
    if atomicMax(&headers[header + AT_TOUCHED], bricks.frame) == bricks.frame {
        return;
    }
    let place = atomicAdd(&counters[TOUCHED], 1u);
    let has_room = place < bricks.seen_capacity;
    atomicStore(&headers[header + AT_SUMS], select(NO_SUMS, place, has_room));
    if has_room {
        lists[touched_start(bricks) + place] = slot;
    } else {
        atomicAdd(&counters[REFUSED], 1u);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let point = surface_point(grid, view, depth, normal, linear_id(id, workgroups), SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let brick = cell_from_index(grid, point.cell_index) / BRICK_SIDE;
    let at = table_index(bricks, brick);
    var entry = atomicLoad(&table[at]);
    if entry == NO_BRICK {
        entry = atomicMax(&table[at], PENDING);
        if entry == NO_BRICK {
            entry = new_slot(brick);
            atomicStore(&table[at], entry);
            if entry == NO_BRICK {
                atomicAdd(&counters[REFUSED], 1u);
            }
        }
    }
    // Of a brick that is being made, its maker does that.
    if entry >= FIRST_SLOT {
        touch(entry - FIRST_SLOT);
    }
}
