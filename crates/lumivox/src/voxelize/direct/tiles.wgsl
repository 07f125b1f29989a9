// A tile of a large triangle per workgroup, a column or a few per thread.

@group(3) @binding(0) var<storage, read> work: array<u32>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let tile = group.x + group.y * groups.x;
    if tile >= work[1] {
        return;
    }
    // The last triangle of the list whose first tile is not beyond this one.
    let first_tiles = LV_WORK_HEAD + LV_BATCH;
    var low = 0u;
    var high = work[2];
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if work[first_tiles + middle] <= tile {
            low = middle;
        } else {
            high = middle;
        }
    }
    let t = lv_load_triangle(work[LV_WORK_HEAD + low]);
    if !t.exists {
        return;
    }
    let tests = lv_tests(t);
    let nth = f32(tile - work[first_tiles + low]);
    let tiles_x = f32((u32(t.extent.x) + LV_TILE - 1u) / LV_TILE);
    let row = floor((nth + 0.5) / tiles_x);
    let corner = t.ask.xy + i32(LV_TILE) * vec2i(vec2f(nth - row * tiles_x, row));
    // Four columns at a time, eight cells of each: first all tests, then the surfaces of what is marked.
    for (var step = 0u; step < LV_TILE * LV_TILE; step += 256u) {
        var marked = 0u;
        for (var i = 0u; i < 4u; i++) {
            let column = corner + column_of(step + 64u * i + thread);
            let between = lv_column(t, tests, vec2f(column));
            if any(column >= t.ask.xy + t.extent.xy) || between.x > between.y {
                continue;
            }
            var k = between.x;
            loop {
                let bit = 1u << (8u * i + u32(min(k - between.x, 7)));
                marked |= select(0u, bit, lv_marks(t, tests, vec3f(vec3i(column, k))));
                k++;
                continuing {
                    break if k > between.y;
                }
            }
        }
        if marked == 0u {
            continue;
        }
        loop {
            let bit = firstTrailingBit(marked);
            marked &= marked - 1u;
            let column = corner + column_of(step + 64u * (bit / 8u) + thread);
            let between = lv_column(t, tests, vec2f(column));
            lv_fragment(t, vec3i(column, between.x + i32(bit % 8u)));
            continuing {
                break if marked == 0u;
            }
        }
    }
}

fn column_of(n: u32) -> vec2i {
    return vec2i(vec2u(n % LV_TILE, n / LV_TILE));
}
