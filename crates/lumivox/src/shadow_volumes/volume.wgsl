// What shadow volumes are made for. The shader that uses this binds `volume`.

struct VolumeUniform {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    // Of a homogeneous point: metres along the view, times its last coordinate.
    distance: vec4f,
    // A point, or with 0 at the end the direction in which parallel light travels.
    light: vec4f,
    size: vec2u,
    far_depth: f32,
    // Nothing nearer counts; 0 for a parallel view, which has no eye to be near to.
    near: f32,
    bias: f32,
    // 0: layers are columns of pixels, 1: rows.
    axis: u32,
    layers: u32,
    // Words of bits for these.
    words: u32,
    triangles: u32,
    edges: u32,
    casters: u32,
    // Triangles that fit into the lists.
    capacity: u32,
    culls: u32,
    light_views: u32,
    // Layers, up to a power of two; 1 without any.
    leaves: u32,
    reserved: u32,
    clip_from_world_of_light: array<mat4x4f, 6>,
}

// In a reference to a corner: the vertex's end at infinity.
const AT_INFINITY: u32 = 0x80000000u;
// From here on: corners of a triangle that turns its back and covers the picture, at infinity.
const SCREEN: u32 = 0xfffffffcu;

fn away_from_light(world: vec3f) -> vec3f {
    if volume.light.w == 0.0 {
        return volume.light.xyz;
    }
    let way = world - volume.light.xyz;
    return way / max(length(way), 1e-30);
}

// A corner of a volume, homogeneous: where it begins, `bias` behind the surface, or its end.
fn volume_corner(reference: u32, world: vec3f) -> vec4f {
    let away = away_from_light(world);
    if (reference & AT_INFINITY) != 0u {
        return vec4f(away, 0.0);
    }
    return vec4f(world + volume.bias * away, 1.0);
}

// In clip space without a far plane. No depth test reads the depth: it only cuts what is nearer than the near plane.
fn volume_clip(corner: vec4f) -> vec4f {
    var clip = volume.clip_from_world * corner;
    clip.z = 0.5 * (clip.w - volume.near * corner.w);
    return clip;
}

fn screen_clip(reference: u32) -> vec4f {
    let corner = reference - SCREEN;
    return vec4f(select(-1.0, 3.0, corner == 2u), select(-1.0, 3.0, corner == 1u), 0.5, 1.0);
}

fn volume_layer(pixel: vec2u) -> u32 {
    return (pixel[volume.axis] * volume.layers) / volume.size[volume.axis];
}

fn linear_index(id: vec3u, groups: vec3u) -> u32 {
    return id.x + id.y * groups.x * 64u;
}
