// Irradiance of one pixel per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> incident: array<vec4f>;
@group(0) @binding(5) var<storage, read> transport: array<vec4u>;

fn interpolated(p: vec3f, n: vec3f) -> vec3f {
    let low = floor(p - 0.5);
    let fraction = p - 0.5 - low;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let cell = vec3i(low) + vec3i(offset);
        if !cell_in_grid(grid, cell) {
            continue;
        }
        let index = cell_index(grid, vec3u(cell));
        let properties = unpack_transport(transport[index]);
        if !is_occupied(properties) || is_buried(properties) {
            continue;
        }
        let sh = ShRgb(incident[3u * index], incident[3u * index + 1u], incident[3u * index + 2u]);
        let along = select(1.0 - fraction, fraction, offset == vec3u(1u));
        let weight = along.x * along.y * along.z;
        sum += weight * sh_irradiance(sh, n);
        weights += weight;
    }
    return max(sum / max(weights, 1e-4), vec3f(0.0));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    if pixel_depth == view.far_depth || dot(n, n) < 0.25 {
        return vec4f(0.0);
    }
    let p = grid_from_world(grid, world_from_texel(view, texel, pixel_depth));
    return vec4f(interpolated(p, normalize(n)), 1.0);
}
