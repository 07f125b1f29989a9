// How many workgroups passes over surfels need, and those over their rays: of all places that have been given out, or of the surfels that
// are due.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
// Three numbers each: all surfels, those that are due, and the rays of these.
@group(0) @binding(2) var<storage, read_write> workgroups: array<u32>;

// Which of the counts it is.
override COUNT: u32;
// Whether it is that of the surfels that are due.
override OF_DUE: bool;

// The same as `linear_groups` in Rust.
const MAX_COLUMNS: u32 = 32768u;

fn write_groups(at: u32, invocations: u32) {
    let groups = (invocations + 63u) / 64u;
    let columns = clamp(groups, 1u, MAX_COLUMNS);
    workgroups[at] = columns;
    workgroups[at + 1u] = max((groups + columns - 1u) / columns, 1u);
    workgroups[at + 2u] = 1u;
}

@compute @workgroup_size(1)
fn main() {
    let surfels = min(counts[COUNT], settings.capacity);
    if OF_DUE {
        write_groups(3u, surfels);
        write_groups(6u, surfels * settings.rays);
    } else {
        write_groups(0u, surfels);
    }
}
