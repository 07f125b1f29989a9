// Surfels: one side of the surface in one cell, and the sub-cells it consists of. Where something stands on it that parts the space
// before it, such as a thin wall on a floor, it is two.

// Sub-cells along an axis of a cell, and of a block of cells.
const SUBCELLS: i32 = 4;
const BLOCK_CELLS: i32 = 4;
// Places of a cell in the table of surfels: two for each face.
const SIDES: u32 = 12u;
// No surfel in the table of cells.
const NO_SURFEL: u32 = 0xffffffffu;
// A ray that met a surfel is that surfel's place. One that left the grid: this and the number of a square of the sky, which is
// an octahedron unfolded.
const FIRST_SKY_HIT: u32 = 0xfffffe00u;
// A ray that met a side without a surfel.
const DARK_HIT: u32 = 0xfffffffeu;
// A ray that has not been traced yet.
const UNTRACED: u32 = 0xfffffffdu;
const SKY_SIDE: f32 = 16.0;

// Whether a ray says anything: it has been traced, and met no inside of something, as rays at a grazing angle do and those that go
// behind what views have shown from one side alone. What is not known is taken to be like the rest.
fn is_known(hit: u32) -> bool {
    return hit != UNTRACED && hit != DARK_HIT;
}

struct GatherUniform {
    // Rays of a surfel.
    rays: u32,
    // Room for surfels.
    capacity: u32,
    // Points of a surfel at which a view is asked for light.
    light_points: u32,
    // Whether irradiance at pixels leaves out what comes straight from the sky.
    sky_apart: u32,
    // The part of all surfels whose turn it is this frame, in units of 2^-32, and where on the circle of turns that begins.
    share: u32,
    phase: u32,
    // Frames until the next turn of all surfels, where they take turns together; else 0.
    frames_left: u32,
    reserved: u32,
}

// The square of the sky that a direction lies in.
fn sky_square(direction: vec3f) -> u32 {
    let at = (0.5 + 0.5 * octahedron_from_direction(direction)) * SKY_SIDE;
    let square = vec2u(clamp(at, vec2f(0.0), vec2f(SKY_SIDE - 1.0)));
    return square.x + u32(SKY_SIDE) * square.y;
}

fn is_sky_hit(hit: u32) -> bool {
    return hit >= FIRST_SKY_HIT && hit < FIRST_SKY_HIT + u32(SKY_SIDE * SKY_SIDE);
}

struct Surfel {
    exists: bool,
    cell: u32,
    // Twice its face, plus one for the second of two parts between which no way leads in front of them.
    side: u32,
    // Bit x + 4 * (y + 4 * z): the sub-cells whose face is open on this side.
    bits: vec2u,
    normal: vec3f,
}

fn pack_surfel(s: Surfel) -> vec4u {
    return vec4u(SIDES * s.cell + s.side, pack2x16snorm(octahedron_from_direction(s.normal)), s.bits);
}

fn unpack_surfel(p: vec4u) -> Surfel {
    return Surfel(p.x != NO_SURFEL, p.x / SIDES, p.x % SIDES, p.zw, direction_from_octahedron(unpack2x16snorm(p.y)));
}

fn bit_count(bits: vec2u) -> u32 {
    return countOneBits(bits.x) + countOneBits(bits.y);
}

// The word pair with this bit alone.
fn one_bit(bit: u32) -> vec2u {
    return vec2u(select(0u, 1u << (bit & 31u), bit < 32u), select(1u << (bit & 31u), 0u, bit < 32u));
}

// The lowest corner of sub-cell `bit` of a cell, in sub-cells of the grid.
fn subcell_corner(cell: vec3u, bit: u32) -> vec3f {
    return vec3f(4u * cell + vec3u(bit & 3u, (bit >> 2u) & 3u, bit >> 4u));
}

// The bit of the n-th sub-cell of a surfel.
fn nth_bit(bits: vec2u, n: u32) -> u32 {
    let low = countOneBits(bits.x);
    var word = select(bits.y, bits.x, n < low);
    for (var skip = select(n - low, n, n < low); skip > 0u; skip--) {
        word &= word - 1u;
    }
    return firstTrailingBit(word) + select(32u, 0u, n < low);
}

// In place of a deviation: a surfel that shares nothing with those beside it.
const KEEPS_GRAIN: f32 = -1.0;

// Of a colour (Rec. 709).
fn brightness(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// The standard deviation of a mean of so many numbers, from the sum of their squares.
fn deviation_of_mean(mean: f32, squares: f32, count: f32) -> f32 {
    return sqrt(max(squares / max(count, 1.0) - mean * mean, 0.0) / max(count, 1.0));
}

// A number that looks random, 0 to 1.
fn hashed(a: u32, b: u32) -> f32 {
    var h = a * 747796405u + b * 2891336453u + 2654435769u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    return f32((h >> 22u) ^ h) / 4294967296.0;
}
