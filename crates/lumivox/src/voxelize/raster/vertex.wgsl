// A vertex of the batch's draw: whose primitive it belongs to is found by bisection.

@group(3) @binding(0) var<storage, read> work: array<u32>;

@vertex
fn vertex_main(@builtin(vertex_index) vertex: u32) -> LvPrimitive {
    let nth = vertex / 3u;
    // The last triangle whose first primitive is not beyond this one.
    var low = 0u;
    var high = work[0];
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if work[LV_WORK_HEAD + middle] <= nth {
            low = middle;
        } else {
            high = middle;
        }
    }
    let t = lv_load_triangle(batch.first + low);
    if !t.exists {
        return lv_no_primitive();
    }
    return lv_corner(t, nth - work[LV_WORK_HEAD + low], vertex % 3u);
}
