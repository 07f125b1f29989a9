// Directions for the pixels of a picture. The 16 pixels of every 4 x 4 block have directions of their own, consecutive runs of
// one sequence, so that any 4 x 4 pixels together have 16 times as many and a filter of that size leaves no pattern.

// Number of a pixel in its block, 0 to 15, neighbours far apart.
fn block_number(texel: vec2u) -> u32 {
    let x = texel.x & 3u;
    let y = texel.y & 3u;
    let q = x ^ y;
    return ((q & 1u) << 3u) | ((y & 1u) << 2u) | (q & 2u) | (y >> 1u);
}

// Point `n` of Sobol's sequence in the unit square.
fn sobol(n: u32) -> vec2f {
    var second = 0u;
    var v = 1u << 31u;
    var rest = n;
    while rest != 0u {
        second ^= select(0u, v, (rest & 1u) != 0u);
        v ^= v >> 1u;
        rest >>= 1u;
    }
    return (vec2f(vec2u(reverseBits(n), second) >> vec2u(8u)) + 0.5) / 16777216.0;
}

// The `n`th of `count` points of a pixel.
fn pixel_sample(texel: vec2u, n: u32, count: u32) -> vec2f {
    return sobol(block_number(texel) * count + n);
}

// Two tangents of a normal.
fn tangents(n: vec3f) -> mat2x3f {
    let s = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    return mat2x3f(vec3f(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3f(b, s + n.y * n.y * a, -n.y));
}

// A direction around a normal as dense as its cosine with that, from a point of the unit square.
fn cosine_direction(n: vec3f, unit: vec2f) -> vec3f {
    let turn = 6.2831853 * unit.y;
    let disk = sqrt(unit.x) * vec2f(cos(turn), sin(turn));
    return tangents(n) * disk + sqrt(max(1.0 - unit.x, 0.0)) * n;
}
