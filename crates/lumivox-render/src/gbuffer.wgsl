// The camera's G-buffer.

struct GBuffer {
    @location(0) normal: vec4f,
    @location(1) albedo: vec4f,
    @location(2) emission: vec4f,
}

@fragment
fn fragment(in: Varyings) -> GBuffer {
    let surface = surface_at(in);
    if surface.edge_on || surface.albedo.a < material.alpha_cutoff {
        discard;
    }
    let face = octahedron_from_direction(surface.face);
    return GBuffer(
        vec4f(surface.normal, face.x),
        vec4f(saturate(surface.albedo.rgb), 1.0),
        vec4f(surface.emission, face.y),
    );
}
