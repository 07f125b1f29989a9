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

fn lv_axis(v: vec3f, axis: u32) -> f32 {
    return select(select(v.z, v.y, axis == 1u), v.x, axis == 0u);
}

fn lv_whole(t: LvTriangle) -> LvPiece {
    let point = (t.corners[0] + t.corners[1] + t.corners[2]) / 3.0;
    return LvPiece(point, 0.5 * length(t.normal) * t.scale * t.scale);
}

// The point of the triangle's edges nearest to `point`, for triangles that are, but for rounding, edge alone.
fn lv_nearest_on_edges(t: LvTriangle, point: vec3f) -> vec3f {
    var nearest = t.corners[0];
    var distance = 1e30;
    for (var i = 0u; i < 3u; i++) {
        let edge = t.edges[i] * t.scale;
        let square = dot(edge, edge);
        let along = select(0.0, clamp(dot(point - t.corners[i], edge) / square, 0.0, 1.0), square > 0.0);
        let candidate = t.corners[i] + along * edge;
        let away = dot(candidate - point, candidate - point);
        if away < distance {
            distance = away;
            nearest = candidate;
        }
    }
    return nearest;
}

// A triangle cut at six planes has up to nine corners.
var<private> lv_polygon: array<vec3f, 10>;
var<private> lv_polygon_size: u32;

// Keeps what lies at `sign * (x[axis] - at) >= 0`.
fn lv_clip(axis: u32, at: f32, sign: f32) {
    let count = lv_polygon_size;
    if count == 0u {
        return;
    }
    var kept: array<vec3f, 10>;
    var size = 0u;
    var before = lv_polygon[count - 1u];
    var d0 = sign * (lv_axis(before, axis) - at);
    for (var i = 0u; i < count; i++) {
        let corner = lv_polygon[i];
        let d1 = sign * (lv_axis(corner, axis) - at);
        if (d0 > 0.0 && d1 < 0.0) || (d0 < 0.0 && d1 > 0.0) {
            kept[min(size, 9u)] = before + (corner - before) * (d0 / (d0 - d1));
            size++;
        }
        if d1 >= 0.0 {
            kept[min(size, 9u)] = corner;
            size++;
        }
        before = corner;
        d0 = d1;
    }
    lv_polygon_size = min(size, 10u);
    lv_polygon = kept;
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
    for (var i = 0u; i < 3u; i++) {
        lv_polygon[i] = t.corners[i];
    }
    lv_polygon_size = 3u;
    let cut_low = vec3f(t.reach_low) < low;
    let cut_high = vec3f(t.reach_high) > low;
    for (var axis = 0u; axis < 3u; axis++) {
        if select(select(cut_low.z, cut_low.y, axis == 1u), cut_low.x, axis == 0u) {
            lv_clip(axis, lv_axis(low, axis), 1.0);
        }
        if select(select(cut_high.z, cut_high.y, axis == 1u), cut_high.x, axis == 0u) {
            lv_clip(axis, lv_axis(low, axis) + 1.0, -1.0);
        }
    }
    let center = low + 0.5;
    var normal = vec3f(0.0);
    var moment = vec3f(0.0);
    let first = lv_polygon[0];
    for (var i = 2u; i < lv_polygon_size; i++) {
        let b = lv_polygon[i - 1u] - first;
        let c = lv_polygon[i] - first;
        let part = cross(b, c);
        // All parts of a convex polygon turn the same way, so that a sum of absolutes is the length along the normal.
        let weight = abs(part.x) + abs(part.y) + abs(part.z);
        normal += part;
        moment += weight * (b + c);
    }
    let weight = abs(normal.x) + abs(normal.y) + abs(normal.z);
    if weight == 0.0 {
        return LvPiece(lv_nearest_on_edges(t, center), 0.0);
    }
    let point = first + moment / (3.0 * weight);
    return LvPiece(clamp(point, low, low + 1.0), 0.5 * length(normal));
}

// Weights of the corners at a point of the triangle, none negative, sum one.
fn lv_barycentric(t: LvTriangle, point: vec3f) -> vec3f {
    let inverse = 1.0 / max(t.scale, 1e-30);
    let a = (t.corners[0] - point) * inverse;
    let b = (t.corners[1] - point) * inverse;
    let c = (t.corners[2] - point) * inverse;
    let weights = max(
        vec3f(dot(cross(b, c), t.normal), dot(cross(c, a), t.normal), dot(cross(a, b), t.normal)),
        vec3f(0.0),
    );
    let sum = weights.x + weights.y + weights.z;
    if sum > 0.0 {
        return weights / sum;
    }
    // A line: between the ends of its longest edge.
    let squares = vec3f(dot(t.edges[0], t.edges[0]), dot(t.edges[1], t.edges[1]), dot(t.edges[2], t.edges[2]));
    let longest = lv_dominant(squares);
    if squares[longest] == 0.0 {
        return vec3f(1.0 / 3.0);
    }
    let along_edge = (point - t.corners[longest]) * inverse;
    let along = clamp(dot(along_edge, t.edges[longest]) / squares[longest], 0.0, 1.0);
    var on_line = vec3f(0.0);
    on_line[longest] = 1.0 - along;
    on_line[(longest + 1u) % 3u] = along;
    return on_line;
}

// Unit length; zero for what has no direction. Largest component first: squares of tiny vectors underflow.
fn lv_unit(v: vec3f) -> vec3f {
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if largest == 0.0 || !lv_is_finite(v) {
        return vec3f(0.0);
    }
    return normalize(v / largest);
}

// The surface at a point of a triangle. Its colour's opacity is read at the finest level, so that holes stay holes.
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
        if lv_mesh_has(MESH_HAS_TEXTURES) {
            let uv_area = 0.5 * abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
            let share = piece.area / max(lv_whole(t).area, 1e-20);
            let base_level = lv_level(vec2f(textureDimensions(base_color_texture)), uv_area * share);
            var base = textureSampleLevel(base_color_texture, material_sampler, s.uv, base_level);
            if mesh.alpha_cutoff >= 0.0 {
                base.a = textureSampleLevel(base_color_texture, material_sampler, s.uv, 0.0).a;
            }
            let glow_level = lv_level(vec2f(textureDimensions(emission_texture)), uv_area * share);
            s.color *= base;
            s.emission *= textureSampleLevel(emission_texture, material_sampler, s.uv, glow_level).rgb;
        }
    }
    return s;
}

// The mip level whose texels are as large as an area of texture coordinates.
fn lv_level(size: vec2f, uv_area: f32) -> f32 {
    return max(0.5 * log2(max(uv_area * size.x * size.y, 1e-20)), 0.0);
}

// Group 0's side of a method: what a marked cell takes from a triangle.
fn lv_fragment(t: LvTriangle, local: vec3i) {
    let cell = cell_index(grid, vec3u(lv_turned_back_i(local + t.origin, t.facing)));
    if cell < window.first || cell - window.first >= window.count {
        return;
    }
    if LV_IS_BARE && mesh.alpha_cutoff < 0.0 {
        lv_occupy(cell);
        return;
    }
    let piece = lv_piece(t, local);
    let s = lv_surface_point(t, piece, cell);
    if s.color.a < mesh.alpha_cutoff {
        return;
    }
    lv_occupy(cell);
    let from_center = piece.point - (vec3f(local) + 0.5);
    lv_accumulate(s, piece.area, dot(from_center, from_center));
}
