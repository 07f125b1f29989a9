// Bricks of 4 x 4 x 4 cells: how the table, the headers and the lists lie in memory.

struct BrickUniform {
    // The number of the window's first brick along each axis, counted from the origin of all bricks.
    first: vec3i,
    frame: u32,
    // Bricks of the window along each axis: the sides of the table too.
    dims: vec3u,
    // Bricks that there is room for.
    capacity: u32,
    // Bricks whose sums there is room for in a frame.
    seen_capacity: u32,
    // Which of the two lists is this frame's; the other is that of the frame before.
    side: u32,
    // Boxes that cleanup is restricted to; none, and it goes everywhere.
    box_count: u32,
    // Cells that no view has shown for more frames than this die, if so few frames have shown them; 0 for never.
    max_age: u32,
    confident: u32,
    // Where this frame's turn of cleanup begins on a circle of length 1 that bricks lie on, and how much of it it takes.
    turn_from: f32,
    turn_share: f32,
    spare: u32,
}

const BRICK_SIDE: u32 = 4u;
const BRICK_CELLS: u32 = 64u;

// Words of a header.
const HEADER: u32 = 9u;
// The brick's number along each axis, as signed numbers. Bits are zero while a slot is free.
const AT_BRICK: u32 = 0u;
// A bit for each of its cells.
const AT_BITS: u32 = 3u;
// The last frame that a point fell into it, and the place of its sums in that frame.
const AT_TOUCHED: u32 = 5u;
const AT_SUMS: u32 = 6u;
// A bit for each cell of what stands still.
const AT_PINNED: u32 = 7u;
const NO_SUMS: u32 = 0xffffffffu;

// Entries of the table: nothing, being made, or 2 more than a slot.
const NO_BRICK: u32 = 0u;
const PENDING: u32 = 1u;
const FIRST_SLOT: u32 = 2u;

// Counters.
const LISTED: u32 = 0u;
const FREE: u32 = 2u;
const TOUCHED: u32 = 3u;
const OCCUPIED: u32 = 4u;
const INJECTED: u32 = 5u;
const NEW_CELLS: u32 = 6u;
const CLEANED: u32 = 7u;
const DIED: u32 = 8u;
const ENTERED: u32 = 9u;
const LEFT: u32 = 10u;
const REFUSED: u32 = 11u;
const PINNED: u32 = 12u;
const POINTS: u32 = 13u;

// Of a cell: when a view last showed it, and above these bits in how many frames some did.
const FRAME_BITS: u32 = 24u;

// The lists: two of occupied bricks, that of free slots, that of this frame's touched bricks.
fn list_start(bricks: BrickUniform, side: u32) -> u32 {
    return side * bricks.capacity;
}

fn free_start(bricks: BrickUniform) -> u32 {
    return 2u * bricks.capacity;
}

fn touched_start(bricks: BrickUniform) -> u32 {
    return 3u * bricks.capacity;
}

// Remainders are never negative.
fn wrapped(number: vec3i, dims: vec3u) -> vec3u {
    let sides = vec3i(dims);
    return vec3u((number % sides + sides) % sides);
}

// The entry of the table for a brick of the window, counted from the window's first.
fn table_index(bricks: BrickUniform, brick: vec3u) -> u32 {
    let at = wrapped(bricks.first + vec3i(brick), bricks.dims);
    return at.x + bricks.dims.x * (at.y + bricks.dims.y * at.z);
}

fn cell_in_brick(cell: vec3u) -> u32 {
    let place = cell % BRICK_SIDE;
    return place.x + BRICK_SIDE * (place.y + BRICK_SIDE * place.z);
}

fn place_in_brick(number: u32) -> vec3u {
    return vec3u(number, number / BRICK_SIDE, number / (BRICK_SIDE * BRICK_SIDE)) % BRICK_SIDE;
}
