// A view of the light, in texels, and the part of a triangle in one of them. The shader that uses this binds `volume`.

struct MapUniform {
    clip_from_world: mat4x4f,
    // Of a homogeneous point: metres along the view.
    distance: vec4f,
    size: vec2u,
    // Texels that casters may have of their own together.
    capacity: u32,
    // 1: what of a caster lies in shadow is left out; 0: a caster is left out if all of it does.
    by_texel: u32,
}

// Texels that footprints reach beyond themselves on each side: more than rounding moves anything, here or in the picture.
const MARGIN: f32 = 0.125;
const NO_PLACE: u32 = 0xffffffffu;

// Of the part of a triangle in a texel: the range of its metres along the view and of its place along the picture's layers, in
// normalized device coordinates. Nothing if the second is less than the first.
struct Piece {
    distance: vec2f,
    place: vec2f,
}

struct Boxed {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) number: u32,
}

fn no_box() -> Boxed {
    return Boxed(vec4f(2.0, 2.0, 0.5, 1.0), 0u);
}

// The box around what of a triangle lies before the eye, in normalized device coordinates; empty if nothing does.
fn box_of(points: array<vec3f, 3>) -> vec4f {
    var low = vec2f(1e30);
    var high = vec2f(-1e30);
    for (var k = 0u; k < 3u; k++) {
        let a = points[k];
        let b = points[(k + 1u) % 3u];
        let least = 1e-6 * max(abs(a.z), abs(b.z));
        if a.z > least {
            low = min(low, a.xy / a.z);
            high = max(high, a.xy / a.z);
        }
        if (a.z > least) != (b.z > least) {
            let p = mix(a, b, (least - a.z) / (b.z - a.z));
            low = min(low, p.xy / p.z);
            high = max(high, p.xy / p.z);
        }
    }
    return vec4f(clamp(low, vec2f(-2.0), vec2f(2.0)), clamp(high, vec2f(-2.0), vec2f(2.0)));
}

// One of six corners of two triangles over the box, a texel wider on each side.
fn box_corner(points: array<vec3f, 3>, size: vec2u, index: u32, number: u32) -> Boxed {
    let box = box_of(points);
    if box.x > box.z {
        return no_box();
    }
    let corner = vec2u(0x32u >> (index % 6u), 0x2cu >> (index % 6u)) & vec2u(1u);
    let margin = 2.0 / vec2f(size);
    return Boxed(vec4f(mix(box.xy - margin, box.zw + margin, vec2f(corner)), 0.5, 1.0), number);
}

// First and last texel that the box touches, and one more on each side; nothing outside of the picture.
fn box_texels(box: vec4f, size: vec2u) -> array<vec2i, 2> {
    let pixels = vec2f(size);
    let low = vec2f(0.5 + 0.5 * box.x, 0.5 - 0.5 * box.w) * pixels - 1.0;
    let high = vec2f(0.5 + 0.5 * box.z, 0.5 - 0.5 * box.y) * pixels + 1.0;
    return array<vec2i, 2>(vec2i(max(floor(low), vec2f(0.0))), vec2i(min(floor(high), pixels - 1.0)));
}

// The part of the way from `a` to `b` that lies inside of a side, of which both are given their distances from it.
fn inside_part(way: vec2f, a: f32, b: f32) -> vec2f {
    if a < 0.0 && b < 0.0 {
        return vec2f(1.0, 0.0);
    }
    let t = a / (a - b);
    return vec2f(select(way.x, max(way.x, t), a < 0.0), select(way.y, min(way.y, t), b < 0.0));
}

// `value`: metres along the view; of the picture's clip space the coordinate that layers cut, and the last.
fn with_value(piece: Piece, value: vec3f) -> Piece {
    var place = vec2f(-1e30, 1e30);
    if value.z > 0.0 && value.z >= volume.near {
        place = vec2f(value.y / value.z);
    }
    return Piece(
        vec2f(min(piece.distance.x, value.x), max(piece.distance.y, value.x)),
        vec2f(min(piece.place.x, place.x), max(piece.place.y, place.y)),
    );
}

// The part of a triangle in a texel, which is made larger by the margin: the ends of its edges' parts in the texel, and the texel's
// corners in the triangle.
fn piece_in(points: array<vec3f, 3>, values: array<vec3f, 3>, texel: vec2u, size: vec2u) -> Piece {
    let step = 2.0 / vec2f(size);
    let left = (f32(texel.x) - MARGIN) * step.x - 1.0;
    let right = (f32(texel.x) + 1.0 + MARGIN) * step.x - 1.0;
    let top = 1.0 - (f32(texel.y) - MARGIN) * step.y;
    let bottom = 1.0 - (f32(texel.y) + 1.0 + MARGIN) * step.y;
    var piece = Piece(vec2f(1e30, -1e30), vec2f(1e30, -1e30));
    for (var k = 0u; k < 3u; k++) {
        let a = points[k];
        let b = points[(k + 1u) % 3u];
        var way = inside_part(vec2f(0.0, 1.0), a.z, b.z);
        way = inside_part(way, a.x - left * a.z, b.x - left * b.z);
        way = inside_part(way, right * a.z - a.x, right * b.z - b.x);
        way = inside_part(way, a.y - bottom * a.z, b.y - bottom * b.z);
        way = inside_part(way, top * a.z - a.y, top * b.z - b.y);
        if way.x <= way.y {
            piece = with_value(piece, mix(values[k], values[(k + 1u) % 3u], way.x));
            piece = with_value(piece, mix(values[k], values[(k + 1u) % 3u], way.y));
        }
    }
    let area = dot(points[0], cross(points[1], points[2]));
    for (var n = 0u; n < 4u && area != 0.0; n++) {
        let corner = vec3f(select(left, right, (n & 1u) != 0u), select(bottom, top, (n & 2u) != 0u), 1.0);
        let weights = sign(area) * vec3f(
            dot(cross(points[1], points[2]), corner),
            dot(cross(points[2], points[0]), corner),
            dot(cross(points[0], points[1]), corner),
        );
        let sum = weights.x + weights.y + weights.z;
        if all(weights >= vec3f(0.0)) && sum > 0.0 {
            piece = with_value(piece, (weights.x * values[0] + weights.y * values[1] + weights.z * values[2]) / sum);
        }
    }
    return piece;
}

fn points_in(clip_from_world: mat4x4f, corners: array<vec3f, 3>) -> array<vec3f, 3> {
    var points: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k++) {
        points[k] = (clip_from_world * vec4f(corners[k], 1.0)).xyw;
    }
    return points;
}

// What `piece_in` follows over a triangle, with metres along `distance`.
fn values_at(distance: vec4f, corners: array<vec3f, 3>) -> array<vec3f, 3> {
    var values: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k++) {
        let world = vec4f(corners[k], 1.0);
        let clip = volume.clip_from_world * world;
        values[k] = vec3f(dot(distance, world), select(clip.x, -clip.y, volume.axis == 1u), clip.w);
    }
    return values;
}

fn column_of(size: vec2u, texel: vec2u) -> u32 {
    return texel.y * size.x + texel.x;
}

// Whether something is before a distance all over a texel, given as the inverted bits of its farthest distance there.
fn is_hidden(covered: u32, distance: f32) -> bool {
    let before = bitcast<f32>(~covered);
    return covered != 0u && before + 1e-5 * abs(before) < distance;
}
