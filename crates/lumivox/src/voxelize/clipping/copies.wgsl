// The triangle again for every slice that it meets; fragments outside the slice are dropped.

fn lv_primitives(t: LvTriangle) -> u32 {
    // The limit counts from the first slice on the grid, whatever the window.
    let end = min(u32(t.ask.z + t.extent.z), LV_OUTPUT_VERTICES / 3u);
    return max(end, u32(t.ask.z)) - u32(t.ask.z);
}

fn lv_corner(t: LvTriangle, nth: u32, corner: u32) -> LvPrimitive {
    return lv_primitive(t, t.ask.z + i32(nth), lv_outline(t, corner));
}
