// Objects that count about the surfaces of a tile, or on their way to a light; after the part of all culling.

// The surface itself, the way from the surface to the light, and to a light far away.
const ROUND_SURFACE: u32 = 0u;
const ROUND_LIGHT: u32 = 1u;
const ROUND_SUN: u32 = 2u;

// A box, and whether anything is in it.
struct Seen {
    low: vec3f,
    high: vec3f,
    any: bool,
}

// What the texels of a tile show.
fn seen_in(tile: vec2u) -> Seen {
    var extent = Seen(vec3f(1e30), vec3f(-1e30), false);
    for (var n = 0u; n < TILE_SIDE * TILE_SIDE; n++) {
        let texel = tile * TILE_SIDE + vec2u(n % TILE_SIDE, n / TILE_SIDE);
        if all(texel < tiles.size) {
            let d = textureLoad(depth, texel, 0).r;
            if d != view.far_depth {
                let p = world_from_texel(view, texel, d);
                extent.low = min(extent.low, p);
                extent.high = max(extent.high, p);
                extent.any = true;
            }
        }
    }
    return extent;
}

// Whether a sphere reaches a box grown by a distance.
fn reaches_surface(extent: Seen, object: ObjectUniform) -> bool {
    let out = max(max(extent.low - object.center, object.center - extent.high), vec3f(0.0));
    let near = min(object.radius + tiles.reach, object.radius * tiles.reach_in_radii);
    return dot(out, out) <= near * near;
}

// Whether a sphere may stand between a box and a sun: whether it meets the cone that opens towards that.
fn reaches_sun(extent: Seen, object: ObjectUniform) -> bool {
    let tile_radius = 0.5 * distance(extent.low, extent.high);
    let offset = object.center - 0.5 * (extent.low + extent.high);
    let along = max(dot(offset, tiles.light), 0.0);
    // The axis within the cone may be nearer than the way at a right angle to it, by the slope.
    let near = object.radius * (1.0 + tiles.light_radius) + tile_radius + along * tiles.light_radius;
    let apart = offset - along * tiles.light;
    return dot(apart, apart) <= near * near;
}

// Whether a sphere may stand between a box and a light: whether it meets the capsule around both.
fn reaches_light(extent: Seen, object: ObjectUniform) -> bool {
    let middle = 0.5 * (extent.low + extent.high);
    let tile_radius = 0.5 * distance(extent.low, extent.high);
    let way = tiles.light - middle;
    let along = clamp(dot(object.center - middle, way) / max(dot(way, way), 1e-30), 0.0, 1.0);
    let near = object.radius + max(tile_radius, tiles.light_radius);
    let apart = object.center - (middle + along * way);
    return dot(apart, apart) <= near * near;
}

fn reaches(seen: Seen, object: ObjectUniform) -> bool {
    switch tiles.kind {
        case ROUND_LIGHT: { return reaches_light(seen, object); }
        case ROUND_SUN: { return reaches_sun(seen, object); }
        default: { return reaches_surface(seen, object); }
    }
}
