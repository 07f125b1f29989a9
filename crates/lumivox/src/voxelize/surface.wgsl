// The piece of a triangle in a cell, and the surface there as channels see it.

struct SurfacePoint {
    // Metres, in the world: the middle of the piece of the triangle in the cell.
    position: vec3f,
    // Square metres of the triangle in the cell.
    area: f32,
    // Unit, in the world.
    normal: vec3f,
    // The host's number of the mesh.
    mesh: u32,
    // Linear: base colour times texture times vertex colour.
    color: vec4f,
    // W/(m2 sr).
    emission: vec3f,
    // Number of the triangle in the mesh.
    triangle: u32,
    uv: vec2f,
    // Linear index of the cell.
    cell: u32,
}

// A part of a triangle: a point of it in cells from the triangle's origin, and its area in cell faces.
struct LvPiece {
    point: vec3f,
    area: f32,
}

fn lv_whole(t: LvTriangle) -> LvPiece {
    return LvPiece((t.a + t.b + t.c) / 3.0, 0.5 * length(t.normal) * t.scale * t.scale);
}

// The point of an edge nearest to `point`.
fn lv_nearest_on_edge(corner: vec3f, edge: vec3f, point: vec3f) -> vec3f {
    let square = dot(edge, edge);
    return corner + edge * select(0.0, clamp(dot(point - corner, edge) / square, 0.0, 1.0), square > 0.0);
}

// The point of the triangle's edges nearest to `point`, for triangles that are, but for rounding, edge alone.
fn lv_nearest_on_edges(t: LvTriangle, point: vec3f) -> vec3f {
    let on_ab = lv_nearest_on_edge(t.a, t.ab * t.scale, point);
    let on_bc = lv_nearest_on_edge(t.b, t.bc * t.scale, point);
    let on_ca = lv_nearest_on_edge(t.c, t.ca * t.scale, point);
    let nearer = select(on_ab, on_bc, distance(on_bc, point) < distance(on_ab, point));
    return select(nearer, on_ca, distance(on_ca, point) < distance(nearer, point));
}

// A polygon as its directed sides: cutting shortens some, and adds the one between where they were cut. So it stays closed
// whatever rounding does, and needs no list.
struct LvSide {
    start: vec3f,
    end: vec3f,
}

// Keeps what lies where the distances from a plane, of the side's start and end, are not negative; notes in `closing` where
// it was cut.
fn lv_cut(side: ptr<function, LvSide>, closing: ptr<function, LvSide>, d0: f32, d1: f32) {
    let starts_inside = d0 >= 0.0;
    let ends_inside = d1 >= 0.0;
    let along = select(0.0, d0 / (d0 - d1), starts_inside != ends_inside);
    let at = (*side).start + along * ((*side).end - (*side).start);
    (*closing).start = select((*closing).start, at, starts_inside && !ends_inside);
    (*closing).end = select((*closing).end, at, !starts_inside && ends_inside);
    // What is outside altogether becomes a point.
    (*side).end = select(at, (*side).end, ends_inside);
    (*side).start = select(at, (*side).start, starts_inside);
}

// The area and the middle of the part in a cell of a triangle that reaches beyond it.
fn lv_clipped(t: LvTriangle, low: vec3f) -> LvPiece {
    var s0 = LvSide(t.a, t.b);
    var s1 = LvSide(t.b, t.c);
    var s2 = LvSide(t.c, t.a);
    // Sides along the cell's faces: points, while they are none.
    var s3 = LvSide(t.a, t.a);
    var s4 = s3;
    var s5 = s3;
    var s6 = s3;
    var s7 = s3;
    var s8 = s3;
    let high = low + 1.0;
    let below = vec3f(t.reach_low) < low;
    let above = vec3f(t.reach_high) > low;
    if below.x {
        lv_cut(&s0, &s3, s0.start.x - low.x, s0.end.x - low.x);
        lv_cut(&s1, &s3, s1.start.x - low.x, s1.end.x - low.x);
        lv_cut(&s2, &s3, s2.start.x - low.x, s2.end.x - low.x);
    }
    if above.x {
        lv_cut(&s0, &s4, high.x - s0.start.x, high.x - s0.end.x);
        lv_cut(&s1, &s4, high.x - s1.start.x, high.x - s1.end.x);
        lv_cut(&s2, &s4, high.x - s2.start.x, high.x - s2.end.x);
        lv_cut(&s3, &s4, high.x - s3.start.x, high.x - s3.end.x);
    }
    if below.y {
        lv_cut(&s0, &s5, s0.start.y - low.y, s0.end.y - low.y);
        lv_cut(&s1, &s5, s1.start.y - low.y, s1.end.y - low.y);
        lv_cut(&s2, &s5, s2.start.y - low.y, s2.end.y - low.y);
        lv_cut(&s3, &s5, s3.start.y - low.y, s3.end.y - low.y);
        lv_cut(&s4, &s5, s4.start.y - low.y, s4.end.y - low.y);
    }
    if above.y {
        lv_cut(&s0, &s6, high.y - s0.start.y, high.y - s0.end.y);
        lv_cut(&s1, &s6, high.y - s1.start.y, high.y - s1.end.y);
        lv_cut(&s2, &s6, high.y - s2.start.y, high.y - s2.end.y);
        lv_cut(&s3, &s6, high.y - s3.start.y, high.y - s3.end.y);
        lv_cut(&s4, &s6, high.y - s4.start.y, high.y - s4.end.y);
        lv_cut(&s5, &s6, high.y - s5.start.y, high.y - s5.end.y);
    }
    if below.z {
        lv_cut(&s0, &s7, s0.start.z - low.z, s0.end.z - low.z);
        lv_cut(&s1, &s7, s1.start.z - low.z, s1.end.z - low.z);
        lv_cut(&s2, &s7, s2.start.z - low.z, s2.end.z - low.z);
        lv_cut(&s3, &s7, s3.start.z - low.z, s3.end.z - low.z);
        lv_cut(&s4, &s7, s4.start.z - low.z, s4.end.z - low.z);
        lv_cut(&s5, &s7, s5.start.z - low.z, s5.end.z - low.z);
        lv_cut(&s6, &s7, s6.start.z - low.z, s6.end.z - low.z);
    }
    if above.z {
        lv_cut(&s0, &s8, high.z - s0.start.z, high.z - s0.end.z);
        lv_cut(&s1, &s8, high.z - s1.start.z, high.z - s1.end.z);
        lv_cut(&s2, &s8, high.z - s2.start.z, high.z - s2.end.z);
        lv_cut(&s3, &s8, high.z - s3.start.z, high.z - s3.end.z);
        lv_cut(&s4, &s8, high.z - s4.start.z, high.z - s4.end.z);
        lv_cut(&s5, &s8, high.z - s5.start.z, high.z - s5.end.z);
        lv_cut(&s6, &s8, high.z - s6.start.z, high.z - s6.end.z);
        lv_cut(&s7, &s8, high.z - s7.start.z, high.z - s7.end.z);
    }
    // Triangles between the middle of the rim, which is near however small the piece, and the sides.
    let rim = lv_rim(s0) + lv_rim(s1) + lv_rim(s2) + lv_rim(s3) + lv_rim(s4) + lv_rim(s5) + lv_rim(s6) + lv_rim(s7)
        + lv_rim(s8);
    if rim.w <= 0.0 {
        return LvPiece(lv_nearest_on_edges(t, low + 0.5), 0.0);
    }
    let middle = rim.xyz / rim.w;
    let normal = normalize(t.normal);
    let sum = lv_wedge(s0, middle, normal) + lv_wedge(s1, middle, normal) + lv_wedge(s2, middle, normal)
        + lv_wedge(s3, middle, normal) + lv_wedge(s4, middle, normal) + lv_wedge(s5, middle, normal)
        + lv_wedge(s6, middle, normal) + lv_wedge(s7, middle, normal) + lv_wedge(s8, middle, normal);
    let area = max(sum.w, 0.0);
    let point = middle + select(vec3f(0.0), sum.xyz / (3.0 * area), area > 0.0);
    return LvPiece(clamp(point, low, high), 0.5 * area);
}

// The length of a side, as steps along the axes, in w, and that times its middle.
fn lv_rim(side: LvSide) -> vec4f {
    let along = abs(side.end - side.start);
    let length = along.x + along.y + along.z;
    return vec4f(0.5 * length * (side.start + side.end), length);
}

// Twice the area between a point and a side, in w, and that times the sum of the side's ends from there.
fn lv_wedge(side: LvSide, origin: vec3f, normal: vec3f) -> vec4f {
    let a = side.start - origin;
    let b = side.end - origin;
    let area = dot(cross(a, b), normal);
    return vec4f((a + b) * area, area);
}

// The part of the triangle in a cell that it marks. Where it only touches the cell, or has no area: no area, and the
// triangle's point nearest to the cell's centre.
fn lv_piece(t: LvTriangle, cell: vec3i) -> LvPiece {
    let low = vec3f(cell);
    if LV_COVERAGE == LV_SAMPLED {
        let facing = abs(t.normal.z);
        let area = select(0.0, length(t.normal) / facing, facing > 0.0);
        return LvPiece(vec3f(low.xy + 0.5, lv_height(t, low.xy)), area);
    }
    if all(t.reach_low == t.reach_high) {
        return lv_whole(t);
    }
    if all(t.normal == vec3f(0.0)) {
        return LvPiece(lv_nearest_on_edges(t, low + 0.5), 0.0);
    }
    return lv_clipped(t, low);
}

// Weights of the corners at a point of the triangle, none negative, sum one.
fn lv_barycentric(t: LvTriangle, point: vec3f) -> vec3f {
    let inverse = 1.0 / max(t.scale, 1e-30);
    let a = (t.a - point) * inverse;
    let b = (t.b - point) * inverse;
    let c = (t.c - point) * inverse;
    let weights = max(
        vec3f(dot(cross(b, c), t.normal), dot(cross(c, a), t.normal), dot(cross(a, b), t.normal)),
        vec3f(0.0),
    );
    let sum = weights.x + weights.y + weights.z;
    if sum > 0.0 {
        return weights / sum;
    }
    // A line: between the ends of its longest edge.
    let squares = vec3f(dot(t.ab, t.ab), dot(t.bc, t.bc), dot(t.ca, t.ca));
    let along = clamp(-vec3f(dot(a, t.ab), dot(b, t.bc), dot(c, t.ca)) / max(squares, vec3f(1e-30)), vec3f(0.0), vec3f(1.0));
    if all(squares == vec3f(0.0)) {
        return vec3f(1.0 / 3.0);
    }
    let longest = lv_dominant(squares);
    let on_ab = vec3f(1.0 - along.x, along.x, 0.0);
    let on_bc = vec3f(0.0, 1.0 - along.y, along.y);
    let on_ca = vec3f(along.z, 0.0, 1.0 - along.z);
    return select(select(on_ca, on_bc, longest == 1u), on_ab, longest == 0u);
}

// Unit length; zero for what has no direction. Largest component first: squares of tiny vectors underflow.
fn lv_unit(v: vec3f) -> vec3f {
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if largest == 0.0 || !lv_is_finite(v) {
        return vec3f(0.0);
    }
    return normalize(v / largest);
}

// The surface at a point of a triangle. Where masks are cut, its colour's opacity is read at the finest level, so that holes stay
// holes.
fn lv_surface_point(t: LvTriangle, piece: LvPiece, cell: u32) -> SurfacePoint {
    var s: SurfacePoint;
    let weights = lv_barycentric(t, piece.point);
    let from_corner = lv_turned_back(piece.point + vec3f(t.origin), t.facing);
    s.position = grid.origin + grid.cell_size * from_corner;
    s.area = piece.area * grid.cell_size * grid.cell_size;
    s.normal = mesh.side * lv_unit(lv_turned_back(t.normal, t.facing));
    if lv_mesh_has(MESH_HAS_NORMALS) {
        let local = weights.x * lv_local_normal(t.vertices.x) + weights.y * lv_local_normal(t.vertices.y)
            + weights.z * lv_local_normal(t.vertices.z);
        let normal = lv_unit(lv_world_normal(local));
        s.normal = select(normal, s.normal, all(normal == vec3f(0.0)));
    }
    s.mesh = mesh.number;
    s.triangle = t.number;
    s.cell = cell;
    s.color = mesh.base_color;
    s.emission = mesh.emission;
    if lv_mesh_has(MESH_HAS_COLORS) {
        s.color *= weights.x * lv_color(t.vertices.x) + weights.y * lv_color(t.vertices.y)
            + weights.z * lv_color(t.vertices.z);
    }
    if lv_mesh_has(MESH_HAS_UVS) {
        let a = lv_uv(t.vertices.x);
        let b = lv_uv(t.vertices.y);
        let c = lv_uv(t.vertices.z);
        s.uv = weights.x * a + weights.y * b + weights.z * c;
        if !LV_IS_PLAIN && lv_mesh_has(MESH_HAS_TEXTURES) {
            let uv_area = 0.5 * abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
            let share = piece.area / max(lv_whole(t).area, 1e-20);
            let base_level = lv_level(vec2f(textureDimensions(base_color_texture)), uv_area * share);
            var base = textureSampleLevel(base_color_texture, material_sampler, s.uv, base_level);
            if LV_SEE_THROUGH == LV_CUT && mesh.alpha_cutoff >= 0.0 {
                base.a = textureSampleLevel(base_color_texture, material_sampler, s.uv, 0.0).a;
            }
            let glow_level = lv_level(vec2f(textureDimensions(emission_texture)), uv_area * share);
            s.color *= base;
            s.emission *= textureSampleLevel(emission_texture, material_sampler, s.uv, glow_level).rgb;
        }
    }
    return s;
}

// What becomes of surfaces with a cutoff.
const LV_CUT: u32 = 0u;
const LV_DITHERED: u32 = 2u;
// Less opacity than this is none: steps of light have as many.
const LV_LEAST_OPACITY: f32 = 0.5 / 255.0;

// One over the cells of a layer that light from a whole hemisphere goes through: of a layer of cells with gaps, slanted rays cross
// more than one, 1.4 as far as what they let through is concerned.
const LV_SLANT: f32 = 0.7;

// Whether a surface is not there: all of it, where its opacity is the same everywhere, or what is cut out.
fn lv_is_hole(s: SurfacePoint) -> bool {
    if LV_IS_PLAIN || mesh.alpha_cutoff < 0.0 {
        return false;
    }
    if LV_SEE_THROUGH == LV_CUT || !lv_mesh_has(MESH_HAS_TEXTURES) {
        if s.color.a < mesh.alpha_cutoff {
            return true;
        }
    }
    if LV_SEE_THROUGH == LV_DITHERED {
        return 1.0 - pow(saturate(1.0 - s.color.a), LV_SLANT) <= lv_hashed(s.cell);
    }
    return LV_SEE_THROUGH != LV_CUT && s.color.a <= LV_LEAST_OPACITY;
}

// The part of light that a surface holds back.
fn lv_opacity(s: SurfacePoint) -> f32 {
    return select(1.0, saturate(s.color.a), !LV_IS_PLAIN && mesh.alpha_cutoff >= 0.0);
}

// A number that looks random, from 0 to less than 1.
fn lv_hashed(n: u32) -> f32 {
    var h = n * 747796405u + 2891336453u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    return f32(((h >> 22u) ^ h) >> 8u) / 16777216.0;
}

// The mip level whose texels are as large as an area of texture coordinates.
fn lv_level(size: vec2f, uv_area: f32) -> f32 {
    return max(0.5 * log2(max(uv_area * size.x * size.y, 1e-20)), 0.0);
}

// Where surfaces are moved, pieces smaller than this, in cell faces, of larger triangles do not count: a face that ends on a
// cell boundary would else mark the cells beyond it, in front of its neighbours.
const LV_TOUCH: f32 = 1e-4;

// Group 0's side of a method: what a marked cell takes from a triangle.
fn lv_fragment(t: LvTriangle, local: vec3i) {
    let cell = cell_index(grid, vec3u(lv_turned_back_i(local + t.origin, t.facing)));
    if !lv_in_window(cell) {
        return;
    }
    if LV_IS_BARE && LV_IS_PLAIN && LV_SHIFT == 0.0 {
        lv_occupy(cell);
        return;
    }
    let piece = lv_piece(t, local);
    if LV_SHIFT != 0.0 && piece.area < LV_TOUCH && piece.area < 1e-3 * lv_whole(t).area {
        return;
    }
    let s = lv_surface_point(t, piece, cell);
    if lv_is_hole(s) {
        return;
    }
    lv_occupy(cell);
    let from_center = piece.point - (vec3f(local) + 0.5);
    lv_accumulate(s, piece.area, dot(from_center, from_center));
}
