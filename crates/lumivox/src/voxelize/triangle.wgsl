// Triangles in units of cells.

// Corners this close outside the grid, in cells, are moved onto its faces: rounding of a grid's origin and cell size
// would else lose the sides of the very box that it was fitted to.
const LV_RIM: f32 = 1e-4;

struct LvTriangle {
    // Corners in cells from the corner of cell `origin`, axes turned so that the triangle faces z most.
    // (No arrays: software drivers keep what is indexed in memory and not in registers.)
    a: vec3f,
    b: vec3f,
    c: vec3f,
    // Edges from a to b, b to c, c to a, over `scale`, so that none is longer than about 1.
    ab: vec3f,
    bc: vec3f,
    ca: vec3f,
    scale: f32,
    // Square to the edges; over `scale` squared it is twice the area long. Zero where the corners lie on a line.
    normal: vec3f,
    // The first cell to ask, from `origin` on, and how many along each axis: those that the triangle reaches, on the grid and
    // in the window.
    ask: vec3i,
    extent: vec3i,
    // Cells that it reaches at all, from `origin` on.
    reach_low: vec3i,
    reach_high: vec3i,
    // The lowest cell of the grid that it reaches, axes turned; it does not depend on the window.
    origin: vec3i,
    // The axis that became z.
    facing: u32,
    vertices: vec3u,
    number: u32,
    exists: bool,
}

// Axes turned in a circle so that `facing` becomes z.
fn lv_turned(v: vec3f, facing: u32) -> vec3f {
    return select(select(v, v.zxy, facing == 1u), v.yzx, facing == 0u);
}

fn lv_turned_i(v: vec3i, facing: u32) -> vec3i {
    return select(select(v, v.zxy, facing == 1u), v.yzx, facing == 0u);
}

fn lv_turned_back(v: vec3f, facing: u32) -> vec3f {
    return select(select(v, v.yzx, facing == 1u), v.zxy, facing == 0u);
}

fn lv_turned_back_i(v: vec3i, facing: u32) -> vec3i {
    return select(select(v, v.yzx, facing == 1u), v.zxy, facing == 0u);
}

// By its bits, since compilers may take it that no number is infinite.
fn lv_is_finite(v: vec3f) -> bool {
    return all((bitcast<vec3u>(v) & vec3u(0x7f800000u)) != vec3u(0x7f800000u));
}

// First along the mesh's axes, then from the grid's corner: a mesh that stands as it is, however far from the world's
// origin, loses no digits.
fn lv_grid_from_local(local: vec3f) -> vec3f {
    let m = mesh.world_from_local;
    let turned = m[0].xyz * local.x + m[1].xyz * local.y + m[2].xyz * local.z;
    let corner = (turned + (m[3].xyz - grid.origin)) / grid.cell_size;
    let onto = clamp(corner, vec3f(0.0), vec3f(grid.dims));
    return select(corner, onto, abs(corner - onto) <= vec3f(LV_RIM));
}

// One beyond the grid for all that lies outside. The upper faces of the grid belong to its last cells.
fn lv_cell_of(corner: vec3f) -> vec3i {
    let n = vec3f(grid.dims);
    return vec3i(select(floor(clamp(corner, vec3f(-1.0), n)), n - 1.0, corner == n));
}

// The axis along which a vector is longest; the first of those that tie.
fn lv_dominant(v: vec3f) -> u32 {
    let length = abs(v);
    if length.x >= length.y && length.x >= length.z {
        return 0u;
    }
    return select(2u, 1u, length.y >= length.z);
}

// From the two shortest edges, between which rounding turns it least, and square to the longest: what is left is the
// normal of a triangle turned about that edge by no more than rounding moves its corners.
fn lv_normal(ab: vec3f, bc: vec3f, ca: vec3f) -> vec3f {
    let squares = vec3f(dot(ab, ab), dot(bc, bc), dot(ca, ca));
    var longest = ab;
    var normal = cross(bc, ca);
    if squares.y > squares.x && squares.y >= squares.z {
        longest = bc;
        normal = cross(ca, ab);
    } else if squares.z > squares.x {
        longest = ca;
        normal = cross(ab, bc);
    }
    let square = max(squares.x, max(squares.y, squares.z));
    return normal - longest * (dot(normal, longest) / max(square, 1e-30));
}

fn lv_load_triangle(number: u32) -> LvTriangle {
    var t: LvTriangle;
    t.exists = false;
    t.number = number;
    t.vertices = vec3u(lv_index(3u * number), lv_index(3u * number + 1u), lv_index(3u * number + 2u));
    if any(t.vertices >= vec3u(mesh.counts.x)) {
        return t;
    }
    var a = lv_grid_from_local(lv_local_position(t.vertices.x));
    var b = lv_grid_from_local(lv_local_position(t.vertices.y));
    var c = lv_grid_from_local(lv_local_position(t.vertices.z));
    if !(lv_is_finite(a) && lv_is_finite(b) && lv_is_finite(c)) {
        return t;
    }
    let longest = max(max(abs(b - a), abs(c - b)), abs(a - c));
    t.scale = max(longest.x, max(longest.y, longest.z));
    let inverse = 1.0 / max(t.scale, 1e-30);
    let ab = (b - a) * inverse;
    let bc = (c - b) * inverse;
    let ca = (a - c) * inverse;
    t.normal = lv_normal(ab, bc, ca);
    if LV_SHIFT != 0.0 {
        let outwards = lv_shift(t);
        a -= outwards;
        b -= outwards;
        c -= outwards;
    }

    let cells_a = lv_cell_of(a);
    let cells_b = lv_cell_of(b);
    let cells_c = lv_cell_of(c);
    let reach_low = min(cells_a, min(cells_b, cells_c));
    let reach_high = max(cells_a, max(cells_b, cells_c));
    let low = max(reach_low, vec3i(0));
    var high = min(reach_high, vec3i(grid.dims) - 1);
    var ask = low;
    ask.z = max(ask.z, i32(window.first_layer));
    high.z = min(high.z, i32(window.last_layer));
    if any(high < ask) {
        return t;
    }
    t.facing = lv_dominant(t.normal);
    if all(t.normal == vec3f(0.0)) {
        // A line: across the axis along which it is shortest, columns are not deep.
        t.facing = lv_dominant(-vec3f(reach_high - reach_low) + vec3f(65536.0));
    }
    if window.axis < 3u && window.axis != t.facing {
        return t;
    }
    t.exists = true;
    t.origin = lv_turned_i(low, t.facing);
    t.ask = lv_turned_i(ask - low, t.facing);
    t.extent = lv_turned_i(high - ask + 1, t.facing);
    t.reach_low = lv_turned_i(reach_low, t.facing) - t.origin;
    t.reach_high = lv_turned_i(reach_high, t.facing) - t.origin;
    t.normal = lv_turned(t.normal, t.facing);
    let corner = vec3f(low);
    t.a = lv_turned(a - corner, t.facing);
    t.b = lv_turned(b - corner, t.facing);
    t.c = lv_turned(c - corner, t.facing);
    t.ab = lv_turned(ab, t.facing);
    t.bc = lv_turned(bc, t.facing);
    t.ca = lv_turned(ca, t.facing);
    return t;
}

// By how much the surface is moved against its visible side, which the mesh's normals tell if it has any.
fn lv_shift(t: LvTriangle) -> vec3f {
    let length = length(t.normal);
    if length == 0.0 {
        return vec3f(0.0);
    }
    var side = mesh.side;
    if lv_mesh_has(MESH_HAS_NORMALS) && dot(lv_world_normal(lv_local_normal(t.vertices.x)), t.normal) * side < 0.0 {
        side = -side;
    }
    return t.normal * (side * LV_SHIFT / length);
}

fn lv_world_normal(local: vec3f) -> vec3f {
    return mesh.normal_x * local.x + mesh.normal_y * local.y + mesh.normal_z * local.z;
}
