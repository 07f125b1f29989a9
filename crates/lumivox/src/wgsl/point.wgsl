// One point of a view's injection grid: where on a surface it lies.

struct SurfacePoint {
    // The texel that it is taken from.
    texel: vec2u,
    // False where nothing was drawn and outside the grid; the rest is then meaningless.
    exists: bool,
    cell_index: u32,
    normal: vec3f,
}

const INJECT_BLOCK: u32 = 1u;
const INJECT_STIPPLED: u32 = 2u;
const POINT_BLOCK: u32 = 8u;

// Column and row of point number `index` of this frame; outside of the view's points where there is no such point.
fn point_place(view: ViewUniform, index: u32) -> vec2u {
    let none = view.points;
    if view.pattern == INJECT_BLOCK {
        let blocks = (view.points + POINT_BLOCK - 1u) / POINT_BLOCK;
        let block = index / (POINT_BLOCK * POINT_BLOCK) * view.split + view.phase;
        let within = index % (POINT_BLOCK * POINT_BLOCK);
        let corner = POINT_BLOCK * vec2u(block % blocks.x, block / blocks.x);
        return corner + vec2u(within % POINT_BLOCK, within / POINT_BLOCK);
    }
    if view.pattern == INJECT_STIPPLED {
        let columns = (view.points.x + view.split - 1u) / view.split;
        let row = index / columns;
        let shift = (view.phase + row * ((view.split + 1u) / 2u)) % view.split;
        return vec2u(index % columns * view.split + shift, row);
    }
    let band = (view.points.x * view.points.y + view.split - 1u) / view.split;
    let number = view.phase * band + index;
    return select(none, vec2u(number % view.points.x, number / view.points.x), index < band);
}

// Point number `index` of the view in this frame, moved by `shift` cells against its normal.
fn surface_point(
    grid: GridUniform,
    view: ViewUniform,
    depth: texture_2d<f32>,
    normal: texture_2d<f32>,
    index: u32,
    shift: f32,
) -> SurfacePoint {
    var point: SurfacePoint;
    let place = point_place(view, index);
    if any(place >= view.points) {
        return point;
    }
    point.texel = vec2u((vec2f(place) + 0.5) / vec2f(view.points) * vec2f(view.size));
    let recorded = textureLoad(depth, point.texel, 0).r;
    let facing = textureLoad(normal, point.texel, 0).xyz;
    if recorded == view.far_depth || dot(facing, facing) < 0.25 {
        return point;
    }
    point.normal = normalize(facing);
    let p = grid_from_world(grid, world_from_texel(view, point.texel, recorded)) - shift * point.normal;
    point.exists = inside_grid(grid, p);
    point.cell_index = cell_index(grid, cell_from_grid(grid, p));
    return point;
}
