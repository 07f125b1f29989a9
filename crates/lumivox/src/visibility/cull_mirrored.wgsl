// Objects that the polished surfaces of a tile may mirror; after the parts of all culling and of lobes.

@group(0) @binding(7) var normal: texture_2d<f32>;
@group(0) @binding(8) var roughness: texture_2d<f32>;

// A sphere around the surfaces, and a cone of what they mirror: its axis and its half angle.
struct Seen {
    middle: vec3f,
    radius: f32,
    axis: vec3f,
    angle: f32,
    any: bool,
}

// A point that mirrors: where it lies, the way that it mirrors, and how far its lobe strays from that.
struct Mirror {
    p: vec3f,
    way: vec3f,
    stray: f32,
    any: bool,
}

fn mirror_at(texel: vec2u) -> Mirror {
    if any(texel >= tiles.size) {
        return Mirror(vec3f(0.0), vec3f(0.0), 0.0, false);
    }
    let d = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    let rough = roughness_of(textureLoad(roughness, min(texel, textureDimensions(roughness) - 1u), 0).r);
    if d == view.far_depth || dot(n, n) < 0.25 || rough >= MATT {
        return Mirror(vec3f(0.0), vec3f(0.0), 0.0, false);
    }
    let p = world_from_texel(view, texel, d);
    return Mirror(p, reflect(way_from_eye(texel, d, p), normalize(n)), lobe_stray(rough), true);
}

fn seen_in(tile: vec2u) -> Seen {
    var low = vec3f(1e30);
    var high = vec3f(-1e30);
    var sum = vec3f(0.0);
    var stray = 0.0;
    var any_mirror = false;
    for (var n = 0u; n < TILE_SIDE * TILE_SIDE; n++) {
        let mirror = mirror_at(tile * TILE_SIDE + vec2u(n % TILE_SIDE, n / TILE_SIDE));
        if mirror.any {
            low = min(low, mirror.p);
            high = max(high, mirror.p);
            sum += mirror.way;
            stray = max(stray, mirror.stray);
            any_mirror = true;
        }
    }
    // Ways that have no mean go everywhere.
    let axis = sum / max(length(sum), 1e-6);
    var least = select(-1.0, 1.0, dot(axis, axis) > 0.5);
    for (var n = 0u; n < TILE_SIDE * TILE_SIDE; n++) {
        let mirror = mirror_at(tile * TILE_SIDE + vec2u(n % TILE_SIDE, n / TILE_SIDE));
        least = min(least, select(1.0, dot(mirror.way, axis), mirror.any));
    }
    // What rounding takes of a cosine near one is 3e-4 of an angle.
    let angle = acos(clamp(least, -1.0, 1.0)) + stray + 1e-3;
    return Seen(0.5 * (low + high), 0.5 * distance(low, high), axis, angle, any_mirror);
}

// Whether a sphere meets the cone around all that the tile mirrors.
fn reaches(seen: Seen, object: ObjectUniform) -> bool {
    let offset = object.center - seen.middle;
    let apart = length(offset);
    let near = object.radius + seen.radius;
    if apart <= near {
        return true;
    }
    let off_axis = acos(clamp(dot(offset, seen.axis) / apart, -1.0, 1.0));
    return off_axis <= seen.angle + asin(near / apart);
}
