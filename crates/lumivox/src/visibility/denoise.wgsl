// The mean of a factor over the pixels around that lie on the same surface: each of the 16 patterns of a block counts alike.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var noisy: texture_2d<f32>;
@group(0) @binding(5) var<storage, read> tile_list: array<u32>;

// Normals that count as the same surface: up to 37 degrees apart.
const LEAST_COSINE: f32 = 0.8;
// How far a point may lie off the pixel's plane, in sides of a pixel.
const OFF_PLANE: f32 = 1.5;

@fragment
fn fragment(in: TileVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let own = textureLoad(noisy, texel, 0);
    let own_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    if own_depth == view.far_depth || dot(n, n) < 0.25 {
        return own;
    }
    let p = world_from_texel(view, texel, own_depth);
    let beside = world_from_texel(view, texel + vec2u(1u, 0u), own_depth);
    let near = OFF_PLANE * distance(p, beside);
    var sum = vec4f(0.0);
    var weights = 0.0;
    // Five by five, the outermost half: rows and columns four apart have the same patterns.
    for (var i = 0; i < 25; i++) {
        let offset = vec2i(i % 5, i / 5) - 2;
        let at = vec2i(texel) + offset;
        if any(at < vec2i(0)) || any(at >= vec2i(tiles.size)) {
            continue;
        }
        let there = textureLoad(depth, at, 0).r;
        let other = textureLoad(normal, at, 0).xyz;
        let off = dot(n, world_from_texel(view, vec2u(at), there) - p);
        if there == view.far_depth || dot(n, other) < LEAST_COSINE || abs(off) > near {
            continue;
        }
        let edge = select(vec2f(1.0), vec2f(0.5), abs(offset) == vec2i(2));
        let weight = edge.x * edge.y;
        sum += weight * textureLoad(noisy, at, 0);
        weights += weight;
    }
    return sum / max(weights, 1e-6);
}
