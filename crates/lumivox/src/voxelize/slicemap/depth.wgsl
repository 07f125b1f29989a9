// A vertex of the one pass along an axis, which is the instance. The depth of each fragment tells its bit.

@vertex
fn vertex_main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) axis: u32) -> LvPrimitive {
    let number = batch.first + vertex / 3u;
    if number >= mesh.counts.y {
        return lv_no_primitive();
    }
    var t = lv_load_triangle(number);
    if !t.exists {
        return lv_no_primitive();
    }
    t = lv_refaced(t, axis);
    if t.normal.z == 0.0 {
        return lv_no_primitive();
    }
    return lv_primitive(t, LV_ANY_SLICE, lv_outline(t, vertex % 3u));
}
