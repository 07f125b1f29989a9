// A slot for a brick that has none. Goes with a shader that declares `bricks`, `headers`, `lists` and `counters`.

// Puts it into the list of this side; NO_BRICK where there is no room.
fn new_slot(brick: vec3u, side: u32) -> u32 {
    let left = bitcast<i32>(atomicSub(&counters[FREE], 1u));
    if left <= 0 {
        atomicAdd(&counters[FREE], 1u);
        return NO_BRICK;
    }
    let slot = lists[free_start(bricks) + u32(left) - 1u];
    let header = HEADER * slot;
    let number = bricks.first + vec3i(brick);
    for (var axis = 0u; axis < 3u; axis++) {
        atomicStore(&headers[header + axis], bitcast<u32>(number[axis]));
    }
    lists[list_start(bricks, side) + atomicAdd(&counters[LISTED + side], 1u)] = slot;
    atomicAdd(&counters[ENTERED], 1u);
    return slot + FIRST_SLOT;
}
