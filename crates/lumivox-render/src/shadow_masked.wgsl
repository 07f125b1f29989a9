// Shadow maps of surfaces with holes.

@fragment
fn fragment(in: Varyings) {
    if surface_at(in).albedo.a < material.alpha_cutoff {
        discard;
    }
}
