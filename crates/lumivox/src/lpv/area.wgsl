// How much surface one point of a view's injection grid stands for; after grid.wgsl, view.wgsl and visibility.wgsl.

// A point seen at less than this cosine stands for as much as one at it.
const LEAST_COSINE: f32 = 0.05;
// A point stands for so many cell faces at most, so that sums keep their range.
const MOST_FACES: f32 = 8.0;

// Area of the surface around a texel, in cell faces: what is seen through the point's share of the picture at that depth,
// turned from the plane across the view's axis into the surface.
fn point_area(grid: GridUniform, view: ViewUniform, texel: vec2u, recorded: f32, n: vec3f) -> f32 {
    let here = world_from_texel(view, texel, recorded);
    let right = world_from_texel(view, texel + vec2u(1u, 0u), recorded) - here;
    let down = world_from_texel(view, texel + vec2u(0u, 1u), recorded) - here;
    let texels = vec2f(view.size) / vec2f(view.points);
    let ndc = ndc_from_uv((vec2f(texel) + 0.5) / vec2f(view.size));
    let ray = normalize(lifted(view, ndc, 0.3) - lifted(view, ndc, 0.7));
    let axis = normalize(cross(right, down));
    let flat_area = length(cross(right, down)) * texels.x * texels.y;
    let area = flat_area * abs(dot(axis, ray)) / max(abs(dot(n, ray)), LEAST_COSINE);
    let faces = area / (grid.cell_size * grid.cell_size);
    // NaN, of a matrix that is none, counts as nothing.
    return select(0.0, min(faces, MOST_FACES), faces > 0.0);
}
