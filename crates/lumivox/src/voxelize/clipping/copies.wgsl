// The triangle again for every slice that it meets; fragments outside the slice are dropped.

fn lv_primitives(t: LvTriangle) -> u32 {
    return min(u32(t.extent.z), LV_OUTPUT_VERTICES / 3u);
}

fn lv_corner(t: LvTriangle, nth: u32, corner: u32) -> LvPrimitive {
    return lv_primitive(t, i32(nth), lv_outline(t, corner));
}
