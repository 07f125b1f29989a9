// Frames since a view has shown each cell: one cell per invocation, after the frame's injection.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> normal: array<vec2u>;
@group(0) @binding(2) var<storage, read> attribute_sums: array<i32>;
// 0 for cells that are empty or that no view has shown, else 1 more than the frames.
@group(0) @binding(3) var<storage, read_write> ages: array<u32>;

override ATTRIBUTE_SUM_WORDS: u32;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let before = ages[index];
    var age = select(before, before + 1u, before > 0u && before < 0xffffffffu);
    if attribute_sums[ATTRIBUTE_SUM_WORDS * index + 9u] > 0 {
        age = 1u;
    }
    ages[index] = select(0u, age, unpack_half4(normal[index]).w > 0.0);
}
