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
    let nth = tile - work[first_tiles + low];
    let tiles_x = (u32(t.extent.x) + LV_TILE - 1u) / LV_TILE;
    let corner = vec2i(LV_TILE * vec2u(nth % tiles_x, nth / tiles_x));
    for (var n = thread; n < LV_TILE * LV_TILE; n += 64u) {
        let column = corner + vec2i(vec2u(n % LV_TILE, n / LV_TILE));
        if any(column >= t.extent.xy) || !lv_pass(tests.xy, f32(column.x), f32(column.y)) {
            continue;
        }
        let between = lv_column(t, tests, vec2f(column));
        for (var k = between.x; k <= between.y; k++) {
            let cell = vec3i(column, k);
            if lv_marks(t, tests, vec3f(cell)) {
                lv_fragment(t, cell);
            }
        }
    }
}
