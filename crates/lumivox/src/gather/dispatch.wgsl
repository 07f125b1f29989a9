// How many workgroups the passes over surfels and over their rays need: as far as places have been given out.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
// For passes over surfels, and for those over their rays: three numbers each.
@group(0) @binding(2) var<storage, read_write> workgroups: array<u32>;

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
    let places = min(counts[2], settings.capacity);
    write_groups(0u, places);
    write_groups(3u, places * settings.rays);
}
