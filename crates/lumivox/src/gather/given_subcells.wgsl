// The sub-cells of one cell per invocation, from bits in the order of a grid four times as fine.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> fine: array<u32>;
@group(0) @binding(2) var<storage, read_write> subcells: array<vec2u>;

// Whether those that are there stay.
override KEEPS: bool;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let first = 4u * cell_from_index(grid, index);
    let dims = 4u * grid.dims;
    var bits = select(vec2u(0u), subcells[index], KEEPS);
    for (var z = 0u; z < 4u; z++) {
        var layer = 0u;
        for (var y = 0u; y < 4u; y++) {
            // Four bits of a row, which lie in one word.
            let at = first.x + dims.x * (first.y + y + dims.y * (first.z + z));
            layer |= ((fine[at / 32u] >> (at % 32u)) & 15u) << (4u * y);
        }
        let word = layer << (16u * (z % 2u));
        bits |= select(vec2u(word, 0u), vec2u(0u, word), z >= 2u);
    }
    subcells[index] = bits;
}
