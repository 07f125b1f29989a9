// One point of a view's injection grid: where on a surface it lies.

struct SurfacePoint {
    // The texel that it is taken from.
    texel: vec2u,
    // False where nothing was drawn and outside the grid; the rest is then meaningless.
    exists: bool,
    cell_index: u32,
    normal: vec3f,
}

// Point number `index` of the view, moved by `shift` cells against its normal.
fn surface_point(
    grid: GridUniform,
    view: ViewUniform,
    depth: texture_2d<f32>,
    normal: texture_2d<f32>,
    index: u32,
    shift: f32,
) -> SurfacePoint {
    var point: SurfacePoint;
    let column_row = vec2f(f32(index % view.points.x), f32(index / view.points.x));
    point.texel = vec2u((column_row + 0.5) / vec2f(view.points) * vec2f(view.size));
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
