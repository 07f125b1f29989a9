// Which cells a triangle marks (lumivox_voxels::Coverage). A triangle and a cell are apart if an axis of the cell, the
// triangle's normal, or one of the nine products of axis and edge separates them. The nine are the edges of the projections along
// the axes, each a line `a p + b q + c >= 0` over the cells of its projection (Schwarz and Seidel 2010).

const LV_EXACT: u32 = 0u;
const LV_THIN: u32 = 1u;
const LV_SAMPLED: u32 = 2u;

// Cells count as larger by this, relative to their size, so that closed tests stay closed under rounding.
const LV_SLACK: f32 = 1e-5;

// The three lines of a projection, a component each.
struct LvLines {
    a: vec3f,
    b: vec3f,
    c: vec3f,
}

struct LvTests {
    xy: LvLines,
    yz: LvLines,
    zx: LvLines,
    // How far from its centre a cell reaches along the normal.
    half: f32,
}

// How far from its centre a cell counts along a direction, times the direction's length: a cube as far as its corners, and the octahedron
// between the middles of its faces for the thin set.
fn lv_reach(a: vec3f, b: vec3f) -> vec3f {
    if LV_COVERAGE == LV_EXACT {
        return 0.5 * (abs(a) + abs(b));
    }
    if LV_COVERAGE == LV_THIN {
        return 0.5 * max(abs(a), abs(b));
    }
    return vec3f(0.0);
}

// Lines of the projection onto axes p and q; `facing` is the normal's part along the third.
fn lv_lines(corners_p: vec3f, corners_q: vec3f, edges_p: vec3f, edges_q: vec3f, facing: f32) -> LvLines {
    let side = select(1.0, -1.0, facing < 0.0);
    let a = -side * edges_q;
    let b = side * edges_p;
    let grown = lv_reach(a, b) + LV_SLACK * (abs(a) + abs(b));
    return LvLines(a, b, grown - a * (corners_p - 0.5) - b * (corners_q - 0.5));
}

fn lv_tests(t: LvTriangle) -> LvTests {
    let x = vec3f(t.a.x, t.b.x, t.c.x);
    let y = vec3f(t.a.y, t.b.y, t.c.y);
    let z = vec3f(t.a.z, t.b.z, t.c.z);
    let ex = vec3f(t.ab.x, t.bc.x, t.ca.x);
    let ey = vec3f(t.ab.y, t.bc.y, t.ca.y);
    let ez = vec3f(t.ab.z, t.bc.z, t.ca.z);
    let n = abs(t.normal);
    let sum = n.x + n.y + n.z;
    var half = 0.5 * sum;
    if LV_COVERAGE == LV_THIN {
        half = 0.5 * max(n.x, max(n.y, n.z));
    }
    return LvTests(
        lv_lines(x, y, ex, ey, t.normal.z),
        lv_lines(y, z, ey, ez, t.normal.x),
        lv_lines(z, x, ez, ex, t.normal.y),
        half + LV_SLACK * sum,
    );
}

fn lv_pass(lines: LvLines, p: f32, q: f32) -> bool {
    let inside = lines.a * p + lines.b * q + lines.c;
    return min(inside.x, min(inside.y, inside.z)) >= 0.0;
}

// Height of the plane above the origin, over the centre of a column.
fn lv_height(t: LvTriangle, column: vec2f) -> f32 {
    let offset = column + 0.5 - t.a.xy;
    return t.a.z - dot(t.normal.xy, offset) / t.normal.z;
}

// Whether the triangle marks a cell of those to ask.
fn lv_marks(t: LvTriangle, tests: LvTests, cell: vec3f) -> bool {
    if LV_COVERAGE == LV_SAMPLED {
        if t.normal.z == 0.0 || !lv_pass(tests.xy, cell.x, cell.y) {
            return false;
        }
        // Rounding must not take a point out of its triangle.
        let height = clamp(floor(lv_height(t, cell.xy)), f32(t.reach_low.z), f32(t.reach_high.z));
        return height == cell.z;
    }
    // Without short cuts: a few multiplications take less than branches.
    let height = dot(t.normal, cell + 0.5 - t.a);
    let xy = tests.xy.a * cell.x + tests.xy.b * cell.y + tests.xy.c;
    let yz = tests.yz.a * cell.y + tests.yz.b * cell.z + tests.yz.c;
    let zx = tests.zx.a * cell.z + tests.zx.b * cell.x + tests.zx.c;
    let least = min(xy, min(yz, zx));
    return min(min(least.x, least.y), min(least.z, tests.half - abs(height))) >= 0.0;
}

// The cells of a column that may be marked, the first and the last: at most eight, since the triangle rises by no more than a
// cell from one column to the next.
fn lv_column(t: LvTriangle, tests: LvTests, column: vec2f) -> vec2i {
    var height = 0.0;
    var half = 2.5;
    if t.normal.z == 0.0 {
        // A line, along its longest edge.
        let squares = vec3f(dot(t.ab, t.ab), dot(t.bc, t.bc), dot(t.ca, t.ca));
        let longest = lv_dominant(squares);
        let edge = select(select(t.ca, t.bc, longest == 1u), t.ab, longest == 0u);
        let corner = select(select(t.c, t.b, longest == 1u), t.a, longest == 0u);
        let along = dot(column + 0.5 - corner.xy, edge.xy) / max(dot(edge.xy, edge.xy), 1e-30);
        height = corner.z + along * edge.z;
    } else {
        height = lv_height(t, column);
        // Wider by a hundredth: which of them count, the tests decide.
        half = select(tests.half / abs(t.normal.z), 0.5, LV_COVERAGE == LV_SAMPLED) + 0.01;
    }
    let first = clamp(ceil(height - 0.5 - half), -1.0, 4096.0);
    let last = clamp(floor(height - 0.5 + half), -1.0, 4096.0);
    var between = vec2i(vec2f(first, last));
    if LV_COVERAGE == LV_SAMPLED {
        between = clamp(between, vec2i(t.reach_low.z), vec2i(t.reach_high.z));
    }
    return vec2i(max(between.x, t.ask.z), min(between.y, t.ask.z + t.extent.z - 1));
}
