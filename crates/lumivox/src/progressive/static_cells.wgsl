// What stands still over what views have made of it, one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> still_normal: array<vec2u>;
@group(0) @binding(2) var<storage, read> still_albedo: array<vec2u>;
@group(0) @binding(3) var<storage, read> still_emission: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> normal_out: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> albedo_out: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> emission_out: array<vec2u>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count || unpack_half4(still_normal[index]).w == 0.0 {
        return;
    }
    normal_out[index] = still_normal[index];
    albedo_out[index] = still_albedo[index];
    emission_out[index] = still_emission[index];
}
