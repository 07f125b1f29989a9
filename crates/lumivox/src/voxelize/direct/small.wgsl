// A triangle per invocation: small ones are done here, the rest go into the list.

@group(3) @binding(0) var<storage, read_write> work: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= batch.count || batch.first + index >= mesh.counts.y {
        return;
    }
    let t = lv_load_triangle(batch.first + index);
    if !t.exists {
        return;
    }
    let largest = max(t.extent.x, max(t.extent.y, t.extent.z));
    if largest > 64 || t.extent.x * t.extent.y * t.extent.z > 64 {
        let slot = atomicAdd(&work[0], 1u);
        let tiles = (vec2u(t.extent.xy) + LV_TILE - 1u) / LV_TILE;
        atomicStore(&work[LV_WORK_HEAD + slot], batch.first + index);
        atomicStore(&work[LV_WORK_HEAD + LV_BATCH + slot], tiles.x * tiles.y);
        return;
    }
    // Where the tests are closed, one cell alone is touched for sure.
    if LV_COVERAGE == LV_EXACT && largest == 1 && all(t.reach_low == t.reach_high) {
        lv_fragment(t, vec3i(0));
        return;
    }
    let tests = lv_tests(t);
    var marked = vec2u(0u);
    var cell = vec3i(0);
    let count = u32(t.extent.x * t.extent.y * t.extent.z);
    for (var n = 0u; n < count; n++) {
        if lv_marks(t, tests, vec3f(cell)) {
            marked[n / 32u] |= 1u << (n % 32u);
        }
        cell.x++;
        if cell.x == t.extent.x {
            cell.x = 0;
            cell.y++;
            if cell.y == t.extent.y {
                cell.y = 0;
                cell.z++;
            }
        }
    }
    while any(marked != vec2u(0u)) {
        let half = select(0u, 1u, marked.x == 0u);
        let n = i32(firstTrailingBit(marked[half]) + 32u * half);
        marked[half] &= marked[half] - 1u;
        let row = n / t.extent.x;
        lv_fragment(t, vec3i(n % t.extent.x, row % t.extent.y, row / t.extent.y));
    }
}
