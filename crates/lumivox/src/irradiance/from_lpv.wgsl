// Of light propagation volumes: intensity by the way that light travels, as its reconstruction takes it.

// A cell's flux is on its way through one of six faces; the cosine lobe would count a quarter of it on every surface.
const FACES_PER_LOBE: f32 = 0.6666667;
// From where light goes to where it comes from.
const TURNED: vec4f = vec4f(1.0, -1.0, -1.0, -1.0);

fn cell_weight(index: u32) -> f32 {
    return 1.0;
}

fn cell_light(index: u32) -> ShRgb {
    let k = FACES_PER_LOBE * TURNED;
    return ShRgb(k * light[3u * index], k * light[3u * index + 1u], k * light[3u * index + 2u]);
}
