// The strips that slices cut out of a triangle, by the six cases of Algorithm 1. Corners are sorted along the sweep: v1, v2, v3.
//
//   A  all in one slice: the triangle
//   tip of v1 (before the loop): a triangle, or with v2 in the first slice too a quad
//   B  v2 lies higher: a quad between the edges v1 v2 and v1 v3
//   E  v2 lies lower: a quad between the edges v2 v3 and v1 v3
//   F  v2 lies within: two quads, which meet at its height
//   C  the last slice, v2 in it too: a quad
//   D  the last slice: a triangle
//
// Strips are drawn wider by LV_MARGIN on all sides, as outlines are, so that no column's centre falls between two of them.

struct LvSorted {
    v1: vec3f,
    v2: vec3f,
    v3: vec3f,
    // The slice of v2.
    middle: i32,
}

fn lv_sorted(t: LvTriangle) -> LvSorted {
    let ab = t.b.z < t.a.z;
    let low = select(t.a, t.b, ab);
    let high = select(t.b, t.a, ab);
    let is_lowest = t.c.z < low.z;
    let is_highest = t.c.z >= high.z;
    let v1 = select(low, t.c, is_lowest);
    let v2 = select(select(t.c, low, is_lowest), high, is_highest);
    let v3 = select(high, t.c, is_highest);
    let middle = clamp(floor(v2.z), f32(t.reach_low.z), f32(t.reach_high.z));
    return LvSorted(v1, v2, v3, i32(middle));
}

// Triangles and vertices that a slice takes. A quad is a strip of four.
fn lv_pieces(t: LvTriangle, middle: i32, slice: i32) -> vec2u {
    let is_first = slice == t.reach_low.z;
    let is_last = slice == t.reach_high.z;
    if is_first && is_last {
        return vec2u(1u, 3u);
    }
    if is_first || is_last {
        return select(vec2u(1u, 3u), vec2u(2u, 4u), slice == middle);
    }
    return select(vec2u(2u, 4u), vec2u(4u, 8u), slice == middle);
}

// Triangles of the slices before one, from the first on the grid: two each, but for the ends of the triangle and the slice of v2.
fn lv_before(t: LvTriangle, middle: i32, slice: i32) -> u32 {
    if slice == 0 {
        return 0u;
    }
    var total = 2u * u32(slice - 1) + lv_pieces(t, middle, 0).x;
    if slice > 1 {
        total += lv_pieces(t, middle, slice - 1).x - 2u;
    }
    if middle > 0 && middle < slice - 1 {
        total += 2u;
    }
    return total;
}

fn lv_primitives(t: LvTriangle) -> u32 {
    let middle = lv_sorted(t).middle;
    let begin = lv_before(t, middle, t.ask.z);
    let end = t.ask.z + t.extent.z;
    let budget = LV_OUTPUT_VERTICES;
    if budget == 0xffffffffu {
        return lv_before(t, middle, end) - begin;
    }
    // The limit counts from the first slice on the grid, whatever the window.
    var total = vec2u(0u);
    for (var slice = 0; slice < end; slice++) {
        let pieces = lv_pieces(t, middle, slice);
        if total.y + pieces.y > budget {
            // The lower strip of case F.
            if pieces.y == 8u && total.y + 4u <= budget {
                total.x += 2u;
            }
            break;
        }
        total += pieces;
    }
    return max(total.x, begin) - begin;
}

// Where an edge, moved away from the triangle's third corner, has a height; beyond its ends too.
fn lv_edge_at(t: LvTriangle, low: vec3f, high: vec3f, third: vec3f, height: f32) -> vec2f {
    let edge = high - low;
    let across = vec2f(edge.y, -edge.x) / max(length(edge.xy), 1e-30);
    let shift = LV_MARGIN * select(across, -across, dot(across, third.xy - low.xy) > 0.0);
    let start = low.z - dot(t.normal.xy, shift) / t.normal.z;
    return low.xy + shift + edge.xy * ((height - start) / edge.z);
}

fn lv_is_far(at: vec2f) -> bool {
    return !lv_is_finite(at.xyy) || max(abs(at.x), abs(at.y)) > 16384.0;
}

// A corner of the strip in a slice, of four; in case F the lower or the upper strip. A triangle has its last corner twice.
fn lv_strip(t: LvTriangle, s: LvSorted, slice: i32, is_upper: bool, corner: u32) -> vec2f {
    let is_first = slice == t.reach_low.z;
    let is_last = slice == t.reach_high.z;
    let is_middle = slice == s.middle;
    let scale = max(t.scale, 1e-30);
    let w1 = lv_moved_out(s.v1, s.v2, s.v3, scale, t.normal.z);
    let w2 = lv_moved_out(s.v2, s.v3, s.v1, scale, t.normal.z);
    let w3 = lv_moved_out(s.v3, s.v1, s.v2, scale, t.normal.z);
    // Heights at which the plane is LV_MARGIN outside the slice, and a little more for planes across the sweep.
    let slope = -t.normal.xy / t.normal.z;
    let spread = LV_MARGIN * length(slope) + 1e-3;
    let low = f32(slice) - spread;
    let high = f32(slice) + 1.0 + spread;
    let height = s.v2.z + dot(slope, w2 - s.v2.xy);
    // Cuts of the edges by way of v2, and of the long edge.
    let below = slice <= s.middle;
    let above = slice >= s.middle;
    let cut_low =
        lv_edge_at(t, select(s.v2, s.v1, below), select(s.v3, s.v2, below), select(s.v1, s.v3, below), low);
    let cut_high =
        lv_edge_at(t, select(s.v1, s.v2, above), select(s.v2, s.v3, above), select(s.v3, s.v1, above), high);
    let long_low = lv_edge_at(t, s.v1, s.v3, s.v2, low);
    let long_high = lv_edge_at(t, s.v1, s.v3, s.v2, high);
    var p0 = cut_low;
    var p1 = long_low;
    var p2 = long_high;
    var p3 = cut_high;
    // Needles: cuts cross each other, or lie too far away for a rasterizer. The whole triangle covers the strip as well.
    var is_whole = is_first && is_last;
    if is_first {
        p0 = w1;
        p1 = select(cut_high, w2, is_middle);
        p2 = select(long_high, cut_high, is_middle);
        p3 = long_high;
        is_whole = is_whole || (is_middle && height > high);
    } else if is_last {
        p0 = select(w3, cut_low, is_middle);
        p1 = select(cut_low, w2, is_middle);
        p2 = select(long_low, w3, is_middle);
        p3 = long_low;
        is_whole = is_middle && height < low;
    } else if is_middle {
        let level = lv_edge_at(t, s.v1, s.v3, s.v2, height);
        p0 = select(cut_low, w2, is_upper);
        p1 = select(long_low, level, is_upper);
        p2 = select(level, long_high, is_upper);
        p3 = select(w2, cut_high, is_upper);
        is_whole = height < low || height > high;
    }
    if is_whole || lv_is_far(p0) || lv_is_far(p1) || lv_is_far(p2) || lv_is_far(p3) {
        p0 = w1;
        p1 = w2;
        p2 = w3;
        p3 = w3;
    }
    return select(select(p0, p1, corner == 1u), select(p2, p3, corner == 3u), corner >= 2u);
}

fn lv_corner(t: LvTriangle, nth: u32, corner: u32) -> LvPrimitive {
    let s = lv_sorted(t);
    let number = nth + lv_before(t, s.middle, t.ask.z);
    let first = lv_pieces(t, s.middle, 0).x;
    var slice = 0;
    var piece = number;
    if number >= first {
        let after = number - first;
        slice = 1 + i32(after / 2u);
        piece = after % 2u;
        if s.middle > 0 && s.middle < t.reach_high.z {
            let before_middle = 2u * u32(s.middle - 1);
            if after >= before_middle + 4u {
                slice -= 1;
            } else if after >= before_middle {
                slice = s.middle;
                piece = after - before_middle;
            }
        }
    }
    // A quad's two triangles are 0 1 2 and 0 2 3.
    let at = select(0u, corner + (piece & 1u), corner > 0u);
    return lv_primitive(t, slice, lv_strip(t, s, slice, piece >= 2u, at));
}
