// Ambient visibility of one pixel per invocation (dissertation 4.5.1, Algorithm 3).

struct OcclusionUniform {
    rays: u32,
    // Whether each caster is subtracted by itself, as the papers do, in place of the nearest hit of each ray.
    subtracts: u32,
    reserved_0: u32,
    reserved_3: u32,
    // V(d) = 1 - (1 - d / reach)^exponent.
    inverse_reach: f32,
    exponent: f32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var<uniform> occlusion: OcclusionUniform;
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

const NO_CASTER: u32 = 0xffffffffu;

// What of the light along a ray a hit at a distance takes: 1 - V of equation 3.
fn blocked(distance: f32) -> f32 {
    let left = max(1.0 - distance * occlusion.inverse_reach, 0.0);
    return select(pow(left, occlusion.exponent), 0.0, distance >= NOTHING || left == 0.0);
}

// What the objects of a tile take of a ray.
fn ray_occlusion(first: u32, origin: vec3f, direction: vec3f) -> f32 {
    var sum = 0.0;
    var nearest = NOTHING;
    var caster = NO_CASTER;
    for (var group = 0u; group < filled_words(); group++) {
        var filled = tile_masks[first + tiles.words + group];
        while filled != 0u {
            let word = 32u * group + firstTrailingBit(filled);
            filled &= filled - 1u;
            var bits = met_spheres(tile_masks[first + word], 32u * word, origin, direction);
            while bits != 0u {
                let object = objects[32u * word + firstTrailingBit(bits)];
                bits &= bits - 1u;
                if occlusion.subtracts != 0u && object.caster != caster {
                    sum += blocked(nearest);
                    nearest = NOTHING;
                    caster = object.caster;
                }
                nearest = min(nearest, ahead(object, origin, direction).distance);
            }
        }
    }
    return sum + blocked(nearest);
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
    var taken = 0.0;
    for (var ray = 0u; ray < occlusion.rays; ray++) {
        let direction = cosine_direction(normalize(n), pixel_sample(texel, ray, occlusion.rays));
        taken += ray_occlusion(first_word(in.tile), p, direction);
    }
    return vec4f(max(1.0 - taken / f32(occlusion.rays), 0.0));
}
