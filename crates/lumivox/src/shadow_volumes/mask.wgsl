// Dark where the stencil counts a volume; the test is the pipeline's.

@fragment
fn fragment() -> @location(0) vec4f {
    return vec4f(0.0);
}
