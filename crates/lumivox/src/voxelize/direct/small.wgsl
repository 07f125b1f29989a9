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
    var low_half = 0u;
    var high_half = 0u;
    if LV_COVERAGE == LV_EXACT && all(t.reach_low == t.reach_high) {
        // Where the tests are closed, one cell alone is touched for sure.
        low_half = 1u;
    } else {
        let tests = lv_tests(t);
        let first = vec3f(t.ask);
        let last = vec3f(t.ask + t.extent - 1);
        var cell = first;
        let count = u32(t.extent.x * t.extent.y * t.extent.z);
        var n = 0u;
        loop {
            let bit = select(0u, 1u << (n & 31u), lv_marks(t, tests, cell));
            low_half |= select(bit, 0u, n >= 32u);
            high_half |= select(0u, bit, n >= 32u);
            let next_row = cell.x == last.x;
            let next_layer = next_row && cell.y == last.y;
            cell.x = select(cell.x + 1.0, first.x, next_row);
            cell.y = select(select(cell.y, cell.y + 1.0, next_row), first.y, next_layer);
            cell.z = select(cell.z, cell.z + 1.0, next_layer);
            n++;
            // Loops that end at their foot: software drivers go once through what is skipped at the head.
            continuing {
                break if n >= count;
            }
        }
    }
    if (low_half | high_half) == 0u {
        return;
    }
    loop {
        let in_low = low_half != 0u;
        let n = select(32u + firstTrailingBit(high_half), firstTrailingBit(low_half), in_low);
        high_half = select(high_half & (high_half - 1u), high_half, in_low);
        low_half = select(low_half, low_half & (low_half - 1u), in_low);
        // In floats, which know these quotients: integers are divided one lane after another by software drivers.
        let size = vec3f(t.extent);
        let row = floor((f32(n) + 0.5) / size.x);
        let layer = floor((row + 0.5) / size.y);
        lv_fragment(t, t.ask + vec3i(vec3f(f32(n) - row * size.x, row - layer * size.y, layer)));
        continuing {
            break if (low_half | high_half) == 0u;
        }
    }
}
