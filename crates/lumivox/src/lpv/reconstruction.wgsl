// Irradiance of one pixel per invocation, from the light of the eight cells around the point half a cell before it.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> accumulated: array<vec4f>;

override HALF_CELL: f32;

// A cell's flux is on its way through one of six faces; the cosine lobe would count a quarter of it on every surface.
const FACES_PER_LOBE: f32 = 0.6666667;

fn irradiance_at(p: vec3f, n: vec3f) -> vec3f {
    let low = floor(p - 0.5);
    let fraction = p - 0.5 - low;
    var sum = vec4f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let cell = vec3i(low) + vec3i(offset);
        if !cell_in_grid(grid, cell) {
            continue;
        }
        let at = 3u * cell_index(grid, vec3u(cell));
        let sh = ShRgb(accumulated[at], accumulated[at + 1u], accumulated[at + 2u]);
        let along = select(1.0 - fraction, fraction, offset == vec3u(1u));
        // Light travels against the normal of what it meets.
        sum += along.x * along.y * along.z * vec4f(sh_irradiance(sh, -n), 1.0);
    }
    return clamp(FACES_PER_LOBE * sum.rgb / max(sum.w, 1e-6), vec3f(0.0), vec3f(HALF_MAX));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let facing = textureLoad(normal, texel, 0).xyz;
    if pixel_depth == view.far_depth || dot(facing, facing) < 0.25 {
        return vec4f(0.0);
    }
    let n = normalize(facing);
    let p = grid_from_world(grid, world_from_texel(view, texel, pixel_depth)) + HALF_CELL * n;
    return vec4f(irradiance_at(p, n), 1.0);
}
