// Cells of what stands still: a brick of the window per workgroup, a cell per invocation. Between two frames, so that what is made joins
// the list of the last one.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> bricks: BrickUniform;
@group(0) @binding(2) var<uniform> part: StaticUniform;
// A bit for each cell of these layers.
@group(0) @binding(3) var<storage, read> occupancy: array<u32>;
@group(0) @binding(4) var<storage, read_write> table: array<u32>;
@group(0) @binding(5) var<storage, read_write> headers: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> lists: array<u32>;
@group(0) @binding(7) var<storage, read_write> counters: array<atomic<u32>>;

// The brick's cells in these layers, and those of them that are marked.
var<workgroup> within: array<atomic<u32>, 2>;
var<workgroup> marked: array<atomic<u32>, 2>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) number: u32) {
    let n = group.x + groups.x * group.y;
    if n >= bricks.dims.x * bricks.dims.y * bricks.dims.z {
        return;
    }
    let rows = n / bricks.dims.x;
    let brick = vec3u(n % bricks.dims.x, rows % bricks.dims.y, rows / bricks.dims.y);
    let cell = BRICK_SIDE * brick + place_in_brick(number);
    if all(cell < grid.dims) && cell.z >= part.first_layer && cell.z - part.first_layer < part.layers {
        let bit = 1u << (number % 32u);
        atomicOr(&within[number / 32u], bit);
        let index = cell_index(grid, cell - vec3u(0u, 0u, part.first_layer));
        if (occupancy[index / 32u] >> (index % 32u) & 1u) == 1u {
            atomicOr(&marked[number / 32u], bit);
        }
    }
    workgroupBarrier();
    if number != 0u {
        return;
    }
    let bits = vec2u(atomicLoad(&marked[0]), atomicLoad(&marked[1]));
    let at = table_index(bricks, brick);
    var entry = table[at];
    if entry == NO_BRICK {
        if all(bits == vec2u(0u)) {
            return;
        }
        entry = new_slot(brick, 1u - bricks.side);
        if entry == NO_BRICK {
            return;
        }
        table[at] = entry;
    }
    let header = HEADER * (entry - FIRST_SLOT);
    for (var half = 0u; half < 2u; half++) {
        let others = atomicLoad(&headers[header + AT_PINNED + half]) & ~atomicLoad(&within[half]);
        atomicStore(&headers[header + AT_PINNED + half], others | bits[half]);
        atomicOr(&headers[header + AT_BITS + half], bits[half]);
    }
}
