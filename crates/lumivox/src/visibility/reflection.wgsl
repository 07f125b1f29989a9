// What a polished surface mirrors of the objects, one pixel per invocation (dissertation 4.5.2 and 4.7.2).

struct ReflectionUniform {
    rays: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var<uniform> reflection: ReflectionUniform;
@group(0) @binding(3) var<uniform> hit_light: HitLightUniform;
@group(0) @binding(4) var depth: texture_2d<f32>;
@group(0) @binding(5) var normal: texture_2d<f32>;
// For each pixel, or one texel for all.
@group(0) @binding(6) var roughness: texture_2d<f32>;
@group(0) @binding(7) var<storage, read> objects: array<ObjectUniform>;
@group(0) @binding(8) var<storage, read> fields: array<FieldUniform>;
@group(0) @binding(9) var<storage, read> field_points: array<vec4f>;
@group(0) @binding(10) var<storage, read> field_table: array<u32>;
@group(0) @binding(11) var<storage, read> field_depths: array<f32>;
@group(0) @binding(12) var field_maps: texture_3d<u32>;
@group(0) @binding(13) var field_normals: texture_3d<i32>;
@group(0) @binding(14) var<storage, read> tile_list: array<u32>;
@group(0) @binding(15) var<storage, read> tile_masks: array<u32>;

// Less rough than this a surface is a mirror: one ray says all.
const MIRROR: f32 = 0.01;

struct NearestHit {
    hit: Ahead,
    object: u32,
}

// The nearest hit over the objects of a tile.
fn nearest_hit(first: u32, origin: vec3f, direction: vec3f) -> NearestHit {
    var nearest = NearestHit(Ahead(NOTHING, vec3f(0.0), direction), 0u);
    for (var group = 0u; group < filled_words(); group++) {
        var filled = tile_masks[first + tiles.words + group];
        while filled != 0u {
            let word = 32u * group + firstTrailingBit(filled);
            filled &= filled - 1u;
            var bits = met_spheres(tile_masks[first + word], 32u * word, origin, direction);
            while bits != 0u {
                let n = 32u * word + firstTrailingBit(bits);
                bits &= bits - 1u;
                let found = ahead(objects[n], origin, direction);
                if found.distance < nearest.hit.distance {
                    nearest = NearestHit(found, n);
                }
            }
        }
    }
    return nearest;
}

@fragment
fn fragment(in: TileVertex) -> @location(0) vec4f {
    let texel = vec2u(in.position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    let rough = roughness_of(textureLoad(roughness, min(texel, textureDimensions(roughness) - 1u), 0).r);
    if pixel_depth == view.far_depth || dot(n, n) < 0.25 || rough >= MATT {
        return vec4f(0.0);
    }
    let p = world_from_texel(view, texel, pixel_depth);
    let toward = -way_from_eye(texel, pixel_depth, p);
    let count = select(reflection.rays, 1u, rough < MIRROR);
    var light = vec4f(0.0);
    var sent = 0.0;
    for (var i = 0u; i < count; i++) {
        let unit = select(pixel_sample(texel, i, count), vec2f(0.0), rough < MIRROR);
        let ray = lobe_ray(normalize(n), toward, rough, unit);
        sent += ray.weight;
        if ray.weight > 0.0 {
            let found = nearest_hit(first_word(in.tile), p, ray.direction);
            if found.hit.distance < NOTHING {
                let object = objects[found.object];
                let met = p + found.hit.distance * ray.direction;
                let facing = hit_normal(object, found.hit, ray.direction);
                light += ray.weight * vec4f(lit(object.albedo, met, facing), 1.0);
            }
        }
    }
    return select(vec4f(0.0), light / sent, sent > 0.0);
}
