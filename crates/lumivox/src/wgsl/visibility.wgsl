// Where a view's pictures show a point of the world, and what a depth value there means.

// How far beyond the picture's border a point still counts as inside, in normalised device coordinates: rounding must not
// open a gap between views that share a border. It is 1/200 texel in a picture of 1024.
const BORDER: f32 = 1e-5;

struct Projected {
    // The rest is meaningless if not.
    inside: bool,
    ndc: vec2f,
    texel: vec2u,
}

fn projected(view: ViewUniform, world: vec3f) -> Projected {
    var point: Projected;
    let clip = view.clip_from_world * vec4f(world, 1.0);
    if clip.w <= 0.0 {
        return point;
    }
    let ndc = clip.xyz / clip.w;
    point.inside = all(abs(ndc.xy) <= vec2f(1.0 + BORDER)) && ndc.z >= 0.0 && ndc.z <= 1.0;
    point.ndc = ndc.xy;
    point.texel = vec2u(clamp(uv_from_ndc(ndc.xy) * vec2f(view.size), vec2f(0.0), vec2f(view.size - 1u)));
    return point;
}

// The inverse of the largest distance, in 1/metre, that a picture without a far plane shows.
const HORIZON: f32 = 1e-12;

// The world point at these coordinates with the depth of a picture.
fn lifted(view: ViewUniform, ndc: vec2f, depth: f32) -> vec3f {
    let world = view.world_from_clip * vec4f(ndc, depth, 1.0);
    return world.xyz / max(world.w, HORIZON);
}

// Half the extent of a cell along the view's depth axis, in metres.
fn cell_reach(grid: GridUniform, view: ViewUniform) -> f32 {
    let m = view.eye_from_world;
    let depth_axis = vec3f(m[0].z, m[1].z, m[2].z);
    return 0.5 * grid.cell_size * dot(abs(depth_axis), vec3f(1.0));
}
