// Counts fragments, and those among them that change the stencil.

@group(0) @binding(4) var<storage, read_write> fill: array<atomic<u32>>;

fn filled(counts: bool) {
    atomicAdd(&fill[0], 1u);
    if counts {
        atomicAdd(&fill[1], 1u);
    }
}
