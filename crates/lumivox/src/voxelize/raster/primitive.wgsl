// A triangle on its way through the rasterizer, drawn into one slice of its sweep.

// Outlines are drawn this much wider, in columns, and fragments then ask whether the column's centre lies in the triangle: the
// cells are the same whatever grid a device snaps corners to (Vulkan allows 1/16 of a pixel, most have 1/256).
const LV_MARGIN: f32 = 0.0625;
// No slice of its own: the depth of each fragment decides.
const LV_ANY_SLICE: i32 = -0x40000000;

// What fragments are told. They look the triangle up again: a vertex that hands it on costs more than a fragment that reads it, since most
// triangles have few fragments.
struct LvPrimitive {
    @builtin(position) position: vec4f,
    // The triangle's number, the slice that it is drawn into, and the axis of the sweep.
    @location(0) @interpolate(flat) drawn: vec3i,
}

// Nothing: all corners at one point.
fn lv_no_primitive() -> LvPrimitive {
    var p: LvPrimitive;
    p.position = vec4f(2.0, 2.0, 0.5, 1.0);
    return p;
}

// A corner at `at`, in columns from the triangle's origin. A column is a pixel.
fn lv_primitive(t: LvTriangle, slice: i32, at: vec2f) -> LvPrimitive {
    var p: LvPrimitive;
    let size = vec2f(lv_turned_i(vec3i(grid.dims), t.facing).xy);
    let clip = 2.0 * (at + vec2f(t.origin.xy)) / size - 1.0;
    p.position = vec4f(clip.x, -clip.y, 0.5, 1.0);
    p.drawn = vec3i(i32(t.number), slice, i32(t.facing));
    return p;
}

// A corner of a triangle after each edge has moved outwards by the margin. At the tip of a needle that is far away, up to 8192
// columns. `facing` is the normal's part along the sweep, over `scale` squared.
fn lv_moved_out(at: vec3f, next: vec3f, last: vec3f, scale: f32, facing: f32) -> vec2f {
    let to_next = (next.xy - at.xy) / scale;
    let to_last = (last.xy - at.xy) / scale;
    let next_length = max(length(to_next), 1e-30);
    let last_length = max(length(to_last), 1e-30);
    let sine = abs(facing) / (next_length * last_length);
    let inwards = to_next / next_length + to_last / last_length;
    return at.xy - inwards * min(LV_MARGIN / max(sine, 1e-30), 8192.0);
}

// A corner of the whole triangle's outline.
fn lv_outline(t: LvTriangle, corner: u32) -> vec2f {
    let is_b = corner == 1u;
    let is_c = corner == 2u;
    let at = select(select(t.a, t.b, is_b), t.c, is_c);
    let next = select(select(t.b, t.c, is_b), t.a, is_c);
    let last = select(select(t.c, t.a, is_b), t.b, is_c);
    return lv_moved_out(at, next, last, max(t.scale, 1e-30), t.normal.z);
}
