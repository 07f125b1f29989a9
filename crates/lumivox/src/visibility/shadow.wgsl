// The visible share of one light at one pixel per invocation (dissertation 4.7.2).

struct ShadowUniform {
    // A corner of a rectangle; the middle of a sphere; the way to a sun, unit length.
    position: vec3f,
    // Radius of a sphere in metres, of a sun as the tangent of its angle.
    radius: f32,
    // Edges of a rectangle, which shines along their cross product.
    u: vec3f,
    kind: u32,
    v: vec3f,
    rays: u32,
    reserved_0: u32,
    reserved_3: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var<uniform> shadow: ShadowUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var<storage, read> objects: array<ObjectUniform>;
@group(0) @binding(6) var<storage, read> fields: array<FieldUniform>;
@group(0) @binding(7) var<storage, read> field_points: array<vec4f>;
@group(0) @binding(8) var<storage, read> field_table: array<u32>;
@group(0) @binding(9) var<storage, read> field_depths: array<f32>;
@group(0) @binding(10) var field_maps: texture_3d<u32>;
@group(0) @binding(11) var<storage, read> tile_list: array<u32>;
@group(0) @binding(12) var<storage, read> tile_masks: array<u32>;

const SHADOW_SPHERE: u32 = 0u;
const SHADOW_RECT: u32 = 1u;
const SHADOW_SUN: u32 = 2u;

// A ray to a point of the light: it ends at 1, or never; and what the point counts.
struct LightRay {
    way: vec3f,
    ends: f32,
    weight: f32,
}

fn light_ray(p: vec3f, n: vec3f, unit: vec2f) -> LightRay {
    if shadow.kind == SHADOW_RECT {
        let way = shadow.position + unit.x * shadow.u + unit.y * shadow.v - p;
        let square = dot(way, way);
        let facing = dot(normalize(cross(shadow.u, shadow.v)), -way);
        return LightRay(way, 1.0, max(facing, 0.0) * max(dot(n, way), 0.0) / max(square * square, TINY));
    }
    let turn = 6.2831853 * unit.y;
    let disk = shadow.radius * sqrt(unit.x) * vec2f(cos(turn), sin(turn));
    if shadow.kind == SHADOW_SUN {
        return LightRay(shadow.position + tangents(shadow.position) * disk, NOTHING, 1.0);
    }
    // A sphere is seen as a disk about its middle.
    let middle = shadow.position - p;
    return LightRay(middle + tangents(normalize(middle)) * disk, 1.0, 1.0);
}

// Whether an object of a tile stands in the way.
fn is_blocked(first: u32, p: vec3f, ray: LightRay) -> bool {
    for (var group = 0u; group < filled_words(); group++) {
        var filled = tile_masks[first + tiles.words + group];
        while filled != 0u {
            let word = 32u * group + firstTrailingBit(filled);
            filled &= filled - 1u;
            var bits = met_spheres(tile_masks[first + word], 32u * word, p, ray.way);
            while bits != 0u {
                let object = objects[32u * word + firstTrailingBit(bits)];
                bits &= bits - 1u;
                if ahead(object, p, ray.way).distance < ray.ends {
                    return true;
                }
            }
        }
    }
    return false;
}

@fragment
fn fragment(in: TileVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    if pixel_depth == view.far_depth || dot(n, n) < 0.25 {
        return vec4f(1.0);
    }
    let p = world_from_texel(view, texel, pixel_depth);
    var arrives = 0.0;
    var sent = 0.0;
    for (var i = 0u; i < shadow.rays; i++) {
        let ray = light_ray(p, n, pixel_sample(texel, i, shadow.rays));
        // What the surface turns away from brings nothing.
        let weight = select(0.0, ray.weight, dot(n, ray.way) > 0.0);
        sent += weight;
        if weight > 0.0 && !is_blocked(first_word(in.tile), p, ray) {
            arrives += weight;
        }
    }
    return vec4f(select(1.0, arrives / sent, sent > 0.0));
}
