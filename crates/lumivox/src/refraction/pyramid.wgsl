// A level of a pyramid: the mean of the texels of the finer one that lie under a pixel. The first level is a copy.

struct PyramidUniform {
    size: vec2f,
    reach: f32,
    reserved: f32,
}

@group(0) @binding(0) var finer: texture_2d<f32>;
@group(0) @binding(1) var linear: sampler;
@group(0) @binding(2) var<uniform> pyramid: PyramidUniform;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    // Four look-ups in the quarters of the pixel: of even sizes a texel each, of odd ones what they share.
    let quarter = pyramid.reach / pyramid.size;
    let uv = position.xy / pyramid.size;
    var sum = textureSampleLevel(finer, linear, uv + quarter * vec2f(-1.0, -1.0), 0.0);
    sum += textureSampleLevel(finer, linear, uv + quarter * vec2f(1.0, -1.0), 0.0);
    sum += textureSampleLevel(finer, linear, uv + quarter * vec2f(-1.0, 1.0), 0.0);
    sum += textureSampleLevel(finer, linear, uv + quarter * vec2f(1.0, 1.0), 0.0);
    return 0.25 * sum;
}
