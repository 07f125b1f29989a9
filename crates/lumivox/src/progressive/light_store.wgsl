// Stored light of cells that are gone, one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> normal: array<vec2u>;
@group(0) @binding(2) var<storage, read> reached: array<u32>;
@group(0) @binding(3) var<storage, read_write> light: array<vec2u>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count || reached[index] != 0u || unpack_half4(normal[index]).w > 0.0 {
        return;
    }
    for (var band = 0u; band < 3u; band++) {
        light[3u * index + band] = vec2u(0u);
    }
}
