// Group 0: a bit per cell, and sums of 32-bit integers that do not depend on the order of additions.

struct WindowUniform {
    // Cells whose sums there is room for: the first, counted from `base`, and how many.
    first: u32,
    count: u32,
    // Only triangles that face this axis most; 3 for all.
    axis: u32,
    // The layers of cells that it reaches.
    first_layer: u32,
    last_layer: u32,
    // The first cell that occupancy and volume hold. (Larger grids than 32 bits can count wrap, and differences do not.)
    base: u32,
}

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> window: WindowUniform;
@group(0) @binding(2) var<storage, read_write> occupancy: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;

fn lv_in_window(cell: u32) -> bool {
    return cell - window.base - window.first < window.count;
}

fn lv_occupy(cell_of_grid: u32) {
    let cell = cell_of_grid - window.base;
    let bit = 1u << (cell % 32u);
    // Most cells are marked more than once, and reading is cheaper.
    if (atomicLoad(&occupancy[cell / 32u]) & bit) == 0u {
        atomicOr(&occupancy[cell / 32u], bit);
    }
}

// Adds a 64-bit number to two words, the low one first. What is carried over does not depend on the order either.
fn lv_add_wide(at: u32, low: u32, high: u32) {
    let before = atomicAdd(&sums[at], low);
    let carried = high + select(0u, 1u, low > 0xffffffffu - before);
    if carried != 0u {
        atomicAdd(&sums[at + 1u], carried);
    }
}

// A share of a mean: `x` is a weight in cell faces times a value between 0 and 1. It counts in steps of 2^-36; what is less than
// 1/16 fits into the low word, so that small triangles touch one word for each number.
fn lv_add_share(at: u32, x: f32) {
    let high = floor(x * 16.0);
    lv_add_wide(at, u32((x - high / 16.0) * 68719476736.0), u32(high));
}

// Values between -1 and 1 in steps of 2^-28; two's complement.
fn lv_add_value(at: u32, x: f32) {
    let steps = i32(round(clamp(x, -1.0, 1.0) * 268435456.0));
    lv_add_wide(at, bitcast<u32>(steps), bitcast<u32>(steps >> 31u));
}

// Integers in the order of floats, none of which is 0: that stands for nothing. NaN is nothing.
fn lv_ordered(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    if (bits & 0x7fffffffu) > 0x7f800000u {
        return 0u;
    }
    if x == 0.0 {
        return 0x80000000u;
    }
    return select(~bits, bits | 0x80000000u, (bits >> 31u) == 0u);
}

// Where a value lies in a range, 0 to 1; NaN counts as 0.
fn lv_in_range(x: f32, low: f32, width: f32) -> f32 {
    let value = select(x, 0.0, (bitcast<u32>(x) & 0x7fffffffu) > 0x7f800000u);
    return clamp((value - low) / width, 0.0, 1.0);
}

// Nearer is larger.
fn lv_nearness(square_distance: f32) -> u32 {
    return 0xffffffffu - bitcast<u32>(max(square_distance, 0.0));
}
