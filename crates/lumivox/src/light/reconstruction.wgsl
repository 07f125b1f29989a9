// Irradiance of one pixel per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> incident: array<vec4f>;
@group(0) @binding(5) var<storage, read> transport: array<vec4u>;

// How well a cell's open faces see the side that n looks to. What sees another side counts only where nothing better is
// near: the outer layer of a wall would else darken its inside.
fn facing_weight(properties: Transport, n: vec3f) -> f32 {
    var best = 0.0;
    for (var face = 0u; face < 6u; face++) {
        if is_open(properties, face) {
            best = max(best, dot(n, FACE_NORMALS[face]));
        }
    }
    return max(best, 1e-3);
}

// Weighted irradiance of the eight cells around p, and the sum of the weights.
fn interpolated(p: vec3f, n: vec3f) -> vec4f {
    let low = floor(p - 0.5);
    let fraction = p - 0.5 - low;
    var sum = vec4f(0.0);
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
        sum += along.x * along.y * along.z * facing_weight(properties, n) * vec4f(sh_irradiance(sh, n), 1.0);
    }
    return sum;
}

// In a crease narrower than a cell no cell faces the pixel's side; the nearest that do lie further out.
fn irradiance_at(p: vec3f, n: vec3f) -> vec3f {
    var sum = vec4f(0.0);
    for (var step = 0u; step < 3u && sum.w < 0.02; step++) {
        sum += interpolated(p + 0.75 * f32(step) * n, n);
    }
    return clamp(sum.rgb / max(sum.w, 1e-6), vec3f(0.0), vec3f(HALF_MAX));
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
    return vec4f(irradiance_at(p, normalize(n)), 1.0);
}
