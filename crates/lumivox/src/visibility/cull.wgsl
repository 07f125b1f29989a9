// Which objects reach which tiles, one tile per invocation; tiles with any are listed and drawn later.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> objects: array<ObjectUniform>;
@group(0) @binding(4) var<storage, read_write> tile_masks: array<u32>;
@group(0) @binding(5) var<storage, read_write> tile_list: array<u32>;
@group(0) @binding(6) var<storage, read_write> draw: Draw;

// What an indirect draw reads.
struct Draw {
    vertex_count: u32,
    instance_count: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

// The surface itself, the way from the surface to the light, and to a light far away.
const ROUND_SURFACE: u32 = 0u;
const ROUND_LIGHT: u32 = 1u;
const ROUND_SUN: u32 = 2u;

// A box, and whether anything is in it.
struct Extent {
    low: vec3f,
    high: vec3f,
    any: bool,
}

// What the texels of a tile show.
fn tile_extent(tile: vec2u) -> Extent {
    var extent = Extent(vec3f(1e30), vec3f(-1e30), false);
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
fn reaches_surface(extent: Extent, object: ObjectUniform) -> bool {
    let out = max(max(extent.low - object.center, object.center - extent.high), vec3f(0.0));
    let near = min(object.radius + tiles.reach, object.radius * tiles.reach_in_radii);
    return dot(out, out) <= near * near;
}

// Whether a sphere may stand between a box and a sun: whether it meets the cone that opens towards that.
fn reaches_sun(extent: Extent, object: ObjectUniform) -> bool {
    let tile_radius = 0.5 * distance(extent.low, extent.high);
    let offset = object.center - 0.5 * (extent.low + extent.high);
    let along = max(dot(offset, tiles.light), 0.0);
    // The axis within the cone may be nearer than the way at a right angle to it, by the slope.
    let near = object.radius * (1.0 + tiles.light_radius) + tile_radius + along * tiles.light_radius;
    let apart = offset - along * tiles.light;
    return dot(apart, apart) <= near * near;
}

// Whether a sphere may stand between a box and a light: whether it meets the capsule around both.
fn reaches_light(extent: Extent, object: ObjectUniform) -> bool {
    let middle = 0.5 * (extent.low + extent.high);
    let tile_radius = 0.5 * distance(extent.low, extent.high);
    let way = tiles.light - middle;
    let along = clamp(dot(object.center - middle, way) / max(dot(way, way), 1e-30), 0.0, 1.0);
    let near = object.radius + max(tile_radius, tiles.light_radius);
    let apart = object.center - (middle + along * way);
    return dot(apart, apart) <= near * near;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x == 0u {
        draw.vertex_count = 6u;
    }
    if id.x >= tiles.tiles.x * tiles.tiles.y {
        return;
    }
    let extent = tile_extent(vec2u(id.x % tiles.tiles.x, id.x / tiles.tiles.x));
    var some = false;
    for (var word = 0u; word < tiles.words; word++) {
        var bits = 0u;
        let count = min(tiles.object_count - 32u * word, 32u);
        for (var n = 0u; n < count && extent.any; n++) {
            let object = objects[32u * word + n];
            var reaches: bool;
            switch tiles.kind {
                case ROUND_LIGHT: { reaches = reaches_light(extent, object); }
                case ROUND_SUN: { reaches = reaches_sun(extent, object); }
                default: { reaches = reaches_surface(extent, object); }
            }
            bits |= select(0u, 1u << n, reaches);
        }
        tile_masks[id.x * tiles.words + word] = bits;
        some = some || bits != 0u;
    }
    if some {
        tile_list[atomicAdd(&draw.instance_count, 1u)] = id.x;
    }
}
