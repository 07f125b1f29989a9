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

fn is_pinned(slot: u32, number: u32) -> bool {
    let word = atomicLoad(&headers[HEADER * slot + AT_PINNED + number / 32u]);
    return (word >> (number % 32u) & 1u) == 1u;
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
    let cell = cell_from_index(grid, point.cell_index);
    let brick = cell / BRICK_SIDE;
    let at = table_index(bricks, brick);
    var entry = atomicLoad(&table[at]);
    if entry == NO_BRICK {
        entry = atomicMax(&table[at], PENDING);
        if entry == NO_BRICK {
            entry = new_slot(brick, bricks.side);
            atomicStore(&table[at], entry);
            if entry == NO_BRICK {
                atomicAdd(&counters[REFUSED], 1u);
            }
        }
    }
    // Of a brick that is being made, its maker does that.
    if entry >= FIRST_SLOT && !is_pinned(entry - FIRST_SLOT, cell_in_brick(cell)) {
        touch(entry - FIRST_SLOT);
    }
}
