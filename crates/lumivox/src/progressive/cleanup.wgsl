// Cleanup: one cell per invocation, kept or cleared from one ping-pong side to the other. The rule stands in a part of its own.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> normal_in: array<vec2u>;
@group(0) @binding(4) var<storage, read> albedo_in: array<vec2u>;
@group(0) @binding(5) var<storage, read> emission_in: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> normal_out: array<vec2u>;
@group(0) @binding(7) var<storage, read_write> albedo_out: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> emission_out: array<vec2u>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    var normal = normal_in[index];
    var albedo = albedo_in[index];
    var emission = emission_in[index];
    let occupied = unpack_half4(normal).w > 0.0;
    if occupied && proven_empty(cell_from_index(grid, index)) {
        normal = vec2u(0u);
        albedo = vec2u(0u);
        emission = vec2u(0u);
    }
    normal_out[index] = normal;
    albedo_out[index] = albedo;
    emission_out[index] = emission;
}
