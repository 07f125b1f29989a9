// A reflective shadow map: what the light sees, and what those surfaces reflect of it.

@group(0) @binding(2) var<uniform> light: LightUniform;

struct ReflectiveShadowMap {
    @location(0) normal: vec4f,
    @location(1) albedo: vec4f,
    @location(2) emission: vec4f,
    @location(3) radiance: vec4f,
}

@fragment
fn fragment(in: Varyings) -> ReflectiveShadowMap {
    let surface = surface_at(in);
    if surface.edge_on || surface.albedo.a < material.alpha_cutoff {
        discard;
    }
    let albedo = saturate(surface.albedo.rgb);
    let reflected = albedo / PI * light_irradiance(light, in.world, surface.normal);
    return ReflectiveShadowMap(
        vec4f(surface.normal, 1.0),
        vec4f(albedo, 1.0),
        vec4f(surface.emission, 1.0),
        vec4f(reflected, 1.0),
    );
}
