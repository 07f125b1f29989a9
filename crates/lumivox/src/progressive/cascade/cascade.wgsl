// What a cascade holds at a point: of the finest level whose window contains it, or a blend without seams.

struct LumivoxCascade {
    // The lowest corner of each level's window in metres, and the side of its cells.
    corners: array<vec4f, 8>,
    // The number of its first brick along each axis.
    firsts: array<vec4i, 8>,
    // Cells of every window along each axis.
    dims: vec3u,
    levels: u32,
    // Words of a level's table and of its headers, and how many values it has.
    table_words: u32,
    header_words: u32,
    value_count: u32,
    channels: u32,
}

@group(0) @binding(0) var<uniform> lumivox_cascade: LumivoxCascade;
@group(0) @binding(1) var<storage, read> lumivox_cascade_table: array<u32>;
@group(0) @binding(2) var<storage, read> lumivox_cascade_headers: array<u32>;
@group(0) @binding(3) var<storage, read> lumivox_cascade_values: array<vec2u>;

// As in the volume of bricks: cells along a side of a brick, words of a header, where its bits stand, what a table's entry is more than a slot.
const LUMIVOX_BRICK_SIDE: u32 = 4u;
const LUMIVOX_BRICK_HEADER: u32 = 9u;
const LUMIVOX_BRICK_BITS: u32 = 3u;
const LUMIVOX_BRICK_FIRST_SLOT: u32 = 2u;
// Cells before a window's border over which its level fades into the next.
const LUMIVOX_CASCADE_BLEND: f32 = 4.0;

struct LumivoxCascadeCell {
    // The level; the number of levels where no window contains the point.
    level: u32,
    is_occupied: bool,
    // Where its values begin.
    at: u32,
}

struct LumivoxCascadeSample {
    // How much of what is around a point is occupied, 0 to 1.
    coverage: f32,
    // The channel, times that.
    value: vec4f,
}

fn lumivox_cascade_from_world(level: u32, point: vec3f) -> vec3f {
    let corner = lumivox_cascade.corners[level];
    return (point - corner.xyz) / corner.w;
}

// A cell of a level, by its place in the window.
fn lumivox_cascade_cell(level: u32, cell: vec3u) -> LumivoxCascadeCell {
    let bricks = vec3i(lumivox_cascade.dims / LUMIVOX_BRICK_SIDE);
    let number = lumivox_cascade.firsts[level].xyz + vec3i(cell / LUMIVOX_BRICK_SIDE);
    let wrapped = (number % bricks + bricks) % bricks;
    let place = u32(wrapped.x + bricks.x * (wrapped.y + bricks.y * wrapped.z));
    let entry = lumivox_cascade_table[level * lumivox_cascade.table_words + place];
    if entry < LUMIVOX_BRICK_FIRST_SLOT {
        return LumivoxCascadeCell(level, false, 0u);
    }
    let slot = entry - LUMIVOX_BRICK_FIRST_SLOT;
    let inner = cell % LUMIVOX_BRICK_SIDE;
    let n = inner.x + LUMIVOX_BRICK_SIDE * (inner.y + LUMIVOX_BRICK_SIDE * inner.z);
    let header = level * lumivox_cascade.header_words + LUMIVOX_BRICK_HEADER * slot;
    let bits = lumivox_cascade_headers[header + LUMIVOX_BRICK_BITS + n / 32u];
    let at = level * lumivox_cascade.value_count + lumivox_cascade.channels * (64u * slot + n);
    return LumivoxCascadeCell(level, (bits >> (n % 32u) & 1u) == 1u, at);
}

// The cell of the finest level whose window contains a point.
fn lumivox_cascade_find(point: vec3f) -> LumivoxCascadeCell {
    for (var level = 0u; level < lumivox_cascade.levels; level++) {
        let at = lumivox_cascade_from_world(level, point);
        if all(at >= vec3f(0.0)) && all(at < vec3f(lumivox_cascade.dims)) {
            return lumivox_cascade_cell(level, vec3u(at));
        }
    }
    return LumivoxCascadeCell(lumivox_cascade.levels, false, 0u);
}

// A channel of a cell that is occupied.
fn lumivox_cascade_value(cell: LumivoxCascadeCell, channel: u32) -> vec4f {
    let packed = lumivox_cascade_values[cell.at + channel];
    return vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
}

// A blend of the cells around a point, linear between their middles; each level fades into the next, and the last into nothing.
fn lumivox_cascade_smooth(point: vec3f, channel: u32) -> LumivoxCascadeSample {
    var sum = LumivoxCascadeSample(0.0, vec4f(0.0));
    var left = 1.0;
    for (var level = 0u; level < lumivox_cascade.levels && left > 0.0; level++) {
        let at = lumivox_cascade_from_world(level, point);
        let inward = min(at, vec3f(lumivox_cascade.dims) - at);
        let nearest = min(inward.x, min(inward.y, inward.z));
        let share = left * saturate((nearest - 0.5) / LUMIVOX_CASCADE_BLEND);
        left -= share;
        if share <= 0.0 {
            continue;
        }
        let low = floor(at - 0.5);
        let part = at - 0.5 - low;
        for (var corner = 0u; corner < 8u; corner++) {
            let side = vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u);
            let cell = lumivox_cascade_cell(level, vec3u(low) + side);
            if cell.is_occupied {
                let of_axes = select(1.0 - part, part, side == vec3u(1u));
                let weight = share * of_axes.x * of_axes.y * of_axes.z;
                sum.coverage += weight;
                sum.value += weight * lumivox_cascade_value(cell, channel);
            }
        }
    }
    return sum;
}
