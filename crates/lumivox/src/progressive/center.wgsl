// The rule `center`: whether a view proves a cell empty, by its middle alone. Goes with a shader that declares `grid`, `view`
// and `depth`.

fn proven_empty(cell: vec3u) -> bool {
    let center = cell_center(grid, cell);
    let at = projected(view, center);
    if !at.inside {
        return false;
    }
    let surface = lifted(view, at.ndc, textureLoad(depth, at.texel, 0).r);
    return eye_distance(view, center) < eye_distance(view, surface) - cell_reach(grid, view);
}
