// Of propagated light.

@group(0) @binding(6) var<storage, read> transport: array<vec4u>;

// Cells with a surface hold what arrives at its one side; they count where there are no others.
const OCCUPIED_WEIGHT: f32 = 1e-4;

fn cell_weight(index: u32) -> f32 {
    let properties = unpack_transport(transport[index]);
    if !is_occupied(properties) {
        return 1.0;
    }
    return select(OCCUPIED_WEIGHT, 0.0, is_buried(properties));
}

fn cell_light(index: u32) -> ShRgb {
    return ShRgb(light[3u * index], light[3u * index + 1u], light[3u * index + 2u]);
}
