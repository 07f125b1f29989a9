// Gives each list its place, and says how much of it is drawn.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read_write> lists: array<u32>;
@group(0) @binding(2) var<storage, read_write> draws: array<vec4u>;

const CURSORS: u32 = 256u;
const WHOLE: u32 = 512u;
const TOO_LONG: u32 = 515u;

@compute @workgroup_size(1)
fn main() {
    var total = 0u;
    for (var list = 1u; list < 2u * volume.leaves; list++) {
        total += lists[list];
    }
    let is_too_long = total > volume.capacity;
    lists[TOO_LONG] = u32(is_too_long);
    var first = 0u;
    for (var list = 1u; list < 2u * volume.leaves; list++) {
        var count = lists[list];
        if is_too_long {
            count = select(0u, lists[WHOLE], list == 1u);
            lists[list] = count;
        }
        draws[list] = vec4u(3u * count, 1u, 3u * first, 0u);
        lists[CURSORS + list] = first;
        first += count;
    }
}
