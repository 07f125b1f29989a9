// A fragment: one column of a sweep, in which the triangle meets the line through the column's centre in one slice.

@fragment
fn fragment_main(p: LvPrimitive) {
    var t = lv_load_triangle(u32(p.drawn.x));
    if LV_EVERY_FACE {
        t = lv_refaced(t, u32(p.drawn.z));
    }
    let column = vec2i(p.position.xy) - t.origin.xy;
    let x = vec3f(t.a.x, t.b.x, t.c.x);
    let y = vec3f(t.a.y, t.b.y, t.c.y);
    let edges_x = vec3f(t.ab.x, t.bc.x, t.ca.x);
    let edges_y = vec3f(t.ab.y, t.bc.y, t.ca.y);
    if !lv_pass(lv_lines(x, y, edges_x, edges_y, t.normal.z), f32(column.x), f32(column.y)) {
        return;
    }
    var point = vec3f(vec2f(column) + 0.5, lv_height(t, vec2f(column)));
    if LV_EVERY_FACE {
        // On a triangle that the sweep sees edge-on, rounding moves the height by cells, but not the point out of the triangle.
        let weights = lv_barycentric(t, point);
        point = weights.x * t.a + weights.y * t.b + weights.z * t.c;
    }
    let slice = i32(clamp(floor(point.z), f32(t.reach_low.z), f32(t.reach_high.z)));
    if p.drawn.y != LV_ANY_SLICE && slice != p.drawn.y {
        return;
    }
    let local = vec3i(column, slice);
    let cell = lv_turned_back_i(local + t.origin, t.facing);
    if !cell_in_grid(grid, cell) {
        return;
    }
    if LV_EVERY_FACE {
        lv_sweep_fragment(t, local, cell_index(grid, vec3u(cell)), point);
    } else {
        lv_fragment(t, local);
    }
}

// As `lv_fragment`, for a triangle that is drawn in all three sweeps. A column of a sweep stands for 1 / n of its surface, with n the
// normal's part along the sweep; its three samples share the surface as n^2, which adds up to one.
fn lv_sweep_fragment(t: LvTriangle, local: vec3i, cell: u32, point: vec3f) {
    if !lv_in_window(cell) {
        return;
    }
    if LV_IS_BARE && LV_IS_PLAIN {
        lv_occupy(cell);
        return;
    }
    let piece = LvPiece(point, abs(t.normal.z) / max(length(t.normal), 1e-30));
    let s = lv_surface_point(t, piece, cell);
    if lv_is_hole(s) {
        return;
    }
    lv_occupy(cell);
    let from_center = point - (vec3f(local) + 0.5);
    lv_accumulate(s, piece.area, dot(from_center, from_center));
}

// The triangle as a sweep along another axis sees it.
fn lv_refaced(t: LvTriangle, axis: u32) -> LvTriangle {
    var r = t;
    r.facing = axis;
    r.a = lv_turned(lv_turned_back(t.a, t.facing), axis);
    r.b = lv_turned(lv_turned_back(t.b, t.facing), axis);
    r.c = lv_turned(lv_turned_back(t.c, t.facing), axis);
    r.ab = lv_turned(lv_turned_back(t.ab, t.facing), axis);
    r.bc = lv_turned(lv_turned_back(t.bc, t.facing), axis);
    r.ca = lv_turned(lv_turned_back(t.ca, t.facing), axis);
    r.normal = lv_turned(lv_turned_back(t.normal, t.facing), axis);
    r.ask = lv_turned_i(lv_turned_back_i(t.ask, t.facing), axis);
    r.extent = lv_turned_i(lv_turned_back_i(t.extent, t.facing), axis);
    r.reach_low = lv_turned_i(lv_turned_back_i(t.reach_low, t.facing), axis);
    r.reach_high = lv_turned_i(lv_turned_back_i(t.reach_high, t.facing), axis);
    r.origin = lv_turned_i(lv_turned_back_i(t.origin, t.facing), axis);
    return r;
}
