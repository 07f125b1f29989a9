// Which layers and which channel of what stands still are taken.

struct StaticUniform {
    first_layer: u32,
    layers: u32,
    channel: u32,
    channels: u32,
}
