// Gives the casters' rectangles places one after the other, as far as there is room.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read_write> rects: array<u32>;

const THREADS: u32 = 256u;

var<workgroup> sums: array<u32, 256>;

fn area(caster: u32) -> u32 {
    let first = 8u * caster;
    if rects[first + 2u] == 0u {
        return 0u;
    }
    let width = rects[first + 2u] + rects[first] - map.size.x;
    let height = rects[first + 3u] + rects[first + 1u] - map.size.y;
    return width * height;
}

// More is too much in any case, and more of them are no less.
fn limited(sum: u32) -> u32 {
    return min(sum, 0x7fffffffu - 1048576u);
}

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) lane: u32) {
    let share = (volume.casters + THREADS - 1u) / THREADS;
    let first = min(lane * share, volume.casters);
    let end = min(first + share, volume.casters);
    var sum = 0u;
    for (var caster = first; caster < end; caster++) {
        sum = limited(sum + area(caster));
    }
    sums[lane] = sum;
    workgroupBarrier();
    var place = 0u;
    for (var n = 0u; n < lane; n++) {
        place = limited(place + sums[n]);
    }
    for (var caster = first; caster < end; caster++) {
        let own = area(caster);
        let fits = place + own <= map.capacity;
        rects[8u * caster + 4u] = select(NO_PLACE, place, fits);
        rects[8u * caster + 5u] = own;
        place = limited(place + own);
    }
}
