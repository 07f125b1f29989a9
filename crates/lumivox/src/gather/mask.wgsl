// The sub-cells of one cell per invocation, none where the volume is empty, and from them which cells of a block hold any.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> normal: array<vec2u>;
@group(0) @binding(2) var<storage, read_write> subcells: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> mask: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> blocks: array<atomic<u32>>;

// Whether sub-cells are known. If not, an occupied cell has all of them.
override KNOWN: bool;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let occupied = unpack_half4(normal[index]).w > 0.0;
    if !occupied {
        subcells[index] = vec2u(0u);
    }
    let bits = select(vec2u(0u), select(vec2u(0xffffffffu), subcells[index], KNOWN), occupied);
    mask[index] = bits;
    if all(bits == vec2u(0u)) {
        return;
    }
    let cell = cell_from_index(grid, index);
    let block_dims = (grid.dims + 3u) / 4u;
    let block = cell / 4u;
    let at = block.x + block_dims.x * (block.y + block_dims.y * block.z);
    let place = cell % 4u;
    let bit = place.x + 4u * (place.y + 4u * place.z);
    atomicOr(&blocks[2u * at + bit / 32u], 1u << (bit % 32u));
}
