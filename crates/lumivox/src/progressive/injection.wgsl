// Injection: one point of the view's injection grid per invocation, added to the sums of the cell it falls in.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var emission: texture_2d<f32>;
@group(0) @binding(6) var radiance: texture_2d<f32>;
@group(0) @binding(7) var<storage, read_write> attribute_sums: array<atomic<i32>>;
@group(0) @binding(8) var<storage, read_write> light_sums: array<atomic<i32>>;

override SURFACE_SHIFT: f32;
override ATTRIBUTE_SUM_WORDS: u32;
override LIGHT_SUM_WORDS: u32;

fn add_attributes(at: u32, values: vec3f, steps: f32) {
    let fixed = vec3i(round(values * steps));
    for (var i = 0u; i < 3u; i++) {
        atomicAdd(&attribute_sums[at + i], fixed[i]);
    }
}

fn add_light(at: u32, values: vec4f) {
    // The linear coefficients reach 1.03 times the radiance; the steps leave a factor of two of room.
    let fixed = vec4i(round(values * view.radiance_steps));
    for (var i = 0u; i < 4u; i++) {
        atomicAdd(&light_sums[at + i], fixed[i]);
    }
}

fn within_range(color: vec3f) -> vec3f {
    return clamp(color, vec3f(0.0), vec3f(view.radiance_max));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let point = linear_id(id, workgroups);
    if point >= view.points.x * view.points.y {
        return;
    }
    let column_row = vec2f(f32(point % view.points.x), f32(point / view.points.x));
    let texel = vec2u((column_row + 0.5) / vec2f(view.points) * vec2f(view.size));
    let point_depth = textureLoad(depth, texel, 0).r;
    let facing = textureLoad(normal, texel, 0).xyz;
    if point_depth == view.far_depth || dot(facing, facing) < 0.25 {
        return;
    }
    let n = normalize(facing);
    let p = grid_from_world(grid, world_from_texel(view, texel, point_depth)) - SURFACE_SHIFT * n;
    if !inside_grid(grid, p) {
        return;
    }
    let index = cell_index(grid, cell_from_grid(grid, p));

    let attributes_at = ATTRIBUTE_SUM_WORDS * index;
    add_attributes(attributes_at, n, view.unit_steps);
    add_attributes(attributes_at + 3u, saturate(textureLoad(albedo, texel, 0).rgb), view.unit_steps);
    add_attributes(attributes_at + 6u, within_range(textureLoad(emission, texel, 0).rgb), view.radiance_steps);
    atomicAdd(&attribute_sums[attributes_at + 9u], 1);

    let leaving = sh_scaled(within_range(textureLoad(radiance, texel, 0).rgb), sh_cosine_lobe(n));
    let light_at = LIGHT_SUM_WORDS * index;
    add_light(light_at, leaving.r);
    add_light(light_at + 4u, leaving.g);
    add_light(light_at + 8u, leaving.b);
    atomicAdd(&light_sums[light_at + 12u], 1);
}
