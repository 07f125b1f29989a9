// Cleanup of sub-cells: those of one cell per invocation that a view proves empty are cleared.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> subcells: array<vec2u>;

// Half the extent of a sub-cell along the view's depth axis, in metres.
fn subcell_reach() -> f32 {
    return 0.25 * cell_reach(grid, view);
}

fn proven_empty(center: vec3f) -> bool {
    let at = projected(view, center);
    if !at.inside {
        return false;
    }
    let surface = lifted(view, at.ndc, textureLoad(depth, at.texel, 0).r);
    return eye_distance(view, center) < eye_distance(view, surface) - subcell_reach();
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let bits = subcells[index];
    if all(bits == vec2u(0u)) {
        return;
    }
    let cell = cell_from_index(grid, index);
    var kept = vec2u(0u);
    for (var n = bit_count(bits); n > 0u; n--) {
        let bit = nth_bit(bits, n - 1u);
        let center = grid.origin + 0.25 * grid.cell_size * (subcell_corner(cell, bit) + 0.5);
        if !proven_empty(center) {
            kept |= one_bit(bit);
        }
    }
    subcells[index] = kept;
}
