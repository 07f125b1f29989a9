// A vertex of a pass over all triangles for one slice. The instance is the slice times four, plus the axis.

@vertex
fn vertex_main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> LvPrimitive {
    let number = batch.first + vertex / 3u;
    if number >= mesh.counts.y {
        return lv_no_primitive();
    }
    var t = lv_load_triangle(number);
    if !t.exists {
        return lv_no_primitive();
    }
    t = lv_refaced(t, instance % 4u);
    // The thin frustum of the slice.
    let slice = i32(instance / 4u) - t.origin.z;
    if t.normal.z == 0.0 || slice < t.ask.z || slice >= t.ask.z + t.extent.z {
        return lv_no_primitive();
    }
    return lv_primitive(t, slice, lv_outline(t, vertex % 3u));
}
