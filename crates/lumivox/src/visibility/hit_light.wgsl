// The light that a hit reflects, after the look-ups in fields. The shader that uses this binds `tiles` and `hit_light`.

struct HitLampUniform {
    // Where it stands; the way to a sun, unit length.
    position: vec3f,
    // One of the LAMP_ constants.
    kind: u32,
    // W/sr, of a sun W/m2, of a panel along its normal.
    intensity: vec3f,
    beam: f32,
    direction: vec3f,
    cutoff: f32,
}

const LAMP_SUN: u32 = 0u;
const LAMP_POINT: u32 = 1u;
const LAMP_SPOT: u32 = 2u;
const LAMP_PANEL: u32 = 3u;
const MAX_LAMPS: u32 = 8u;

struct HitLightUniform {
    // Radiance from above and from below.
    above: vec3f,
    lamp_count: u32,
    below: vec3f,
    // Whether objects throw shadows on each other.
    shadows: u32,
    lamps: array<HitLampUniform, MAX_LAMPS>,
}

// Whether any object of the frame stands in a way, which ends at 1 or never.
fn is_any_in(origin: vec3f, way: vec3f, ends: f32) -> bool {
    for (var first = 0u; first < tiles.object_count; first += 32u) {
        let count = min(tiles.object_count - first, 32u);
        var bits = met_spheres(0xffffffffu >> (32u - count), first, origin, way);
        while bits != 0u {
            let object = objects[first + firstTrailingBit(bits)];
            bits &= bits - 1u;
            if ahead(object, origin, way).distance < ends {
                return true;
            }
        }
    }
    return false;
}

// Irradiance by one lamp.
fn lamp_irradiance(lamp: HitLampUniform, p: vec3f, n: vec3f) -> vec3f {
    let is_sun = lamp.kind == LAMP_SUN;
    let way = select(lamp.position - p, lamp.position, is_sun);
    let square = max(dot(way, way), 1e-12);
    let toward = way * inverseSqrt(square);
    var share = max(dot(n, toward), 0.0) / select(square, 1.0, is_sun);
    let off_axis = acos(clamp(-dot(lamp.direction, toward), -1.0, 1.0));
    if lamp.kind == LAMP_SPOT {
        share *= saturate((lamp.cutoff - off_axis) / max(lamp.cutoff - lamp.beam, 1e-4));
    } else if lamp.kind == LAMP_PANEL {
        share *= max(-dot(lamp.direction, toward), 0.0);
    }
    if share > 0.0 && hit_light.shadows != 0u && is_any_in(p, way, select(1.0, NOTHING, is_sun)) {
        share = 0.0;
    }
    return share * lamp.intensity;
}

// Radiance that a matt surface reflects.
fn lit(albedo: vec3f, p: vec3f, n: vec3f) -> vec3f {
    var irradiance = FIELD_PI * mix(hit_light.below, hit_light.above, 0.5 + 0.5 * n.y);
    for (var i = 0u; i < hit_light.lamp_count; i++) {
        irradiance += lamp_irradiance(hit_light.lamps[i], p, n);
    }
    return albedo / FIELD_PI * irradiance;
}
