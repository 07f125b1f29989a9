// The sizes of dispatches over bricks, by what has been listed so far: at the beginning of a frame, where its counts begin anew, after
// bricks have been kept, and after they have been marked.

@group(0) @binding(0) var<uniform> bricks: BrickUniform;
@group(0) @binding(1) var<storage, read_write> counters: array<u32>;
// For an invocation per brick of the last frame's list, a workgroup per brick of this one's, and one per touched brick.
@group(0) @binding(2) var<storage, read_write> groups: array<u32>;

override BEGINS: bool;

// The same as `linear_groups` in Rust.
const MAX_COLUMNS: u32 = 32768u;
const COUNTERS: u32 = 16u;

fn write_groups(at: u32, count: u32) {
    let columns = clamp(count, 1u, MAX_COLUMNS);
    groups[at] = columns;
    groups[at + 1u] = max((count + columns - 1u) / columns, 1u);
    groups[at + 2u] = 1u;
}

@compute @workgroup_size(1)
fn main() {
    if BEGINS {
        counters[LISTED + bricks.side] = 0u;
        for (var n = TOUCHED; n < COUNTERS; n++) {
            counters[n] = 0u;
        }
    }
    write_groups(0u, (counters[LISTED + 1u - bricks.side] + 63u) / 64u);
    write_groups(3u, counters[LISTED + bricks.side]);
    write_groups(6u, min(counters[TOUCHED], bricks.seen_capacity));
}
