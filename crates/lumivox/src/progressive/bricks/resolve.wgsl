// The end of injection into bricks: a touched brick per workgroup, a cell per invocation. Sums become means and are zero again.

@group(0) @binding(0) var<uniform> bricks: BrickUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<storage, read_write> headers: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read> lists: array<u32>;
@group(0) @binding(4) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> sums: array<i32>;
@group(0) @binding(6) var<storage, read_write> values: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> shown: array<u32>;

const MOST_FRAMES: u32 = 255u;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) number: u32) {
    let place = group.x + groups.x * group.y;
    if place >= min(atomicLoad(&counters[TOUCHED]), bricks.seen_capacity) {
        return;
    }
    let at = SUM_WORDS * (BRICK_CELLS * place + number);
    let points = sums[at + SUM_WORDS - 1u];
    if points == 0 {
        return;
    }
    let count = f32(points);
    let slot = lists[touched_start(bricks) + place];
    let cell = BRICK_CELLS * slot + number;
    for (var channel = 0u; channel < CHANNELS; channel++) {
        values[CHANNELS * cell + channel] = pack_half4(mean(at + 4u * channel, count, channel_largest(channel)));
    }
    for (var word = 0u; word < SUM_WORDS; word++) {
        sums[at + word] = 0;
    }
    let bit = 1u << (number % 32u);
    let before = atomicOr(&headers[HEADER * slot + AT_BITS + number / 32u], bit);
    let is_new = (before & bit) == 0u;
    let frames = select(min((shown[cell] >> FRAME_BITS) + 1u, MOST_FRAMES), 1u, is_new);
    shown[cell] = frames << FRAME_BITS | (bricks.frame & ((1u << FRAME_BITS) - 1u));
    atomicAdd(&counters[INJECTED], 1u);
    atomicAdd(&counters[POINTS], u32(points));
    if is_new {
        atomicAdd(&counters[NEW_CELLS], 1u);
    }
}
