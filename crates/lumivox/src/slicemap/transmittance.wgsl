// Light that thin absorbers leave for one pixel per invocation.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var normal: texture_2d<f32>;
@group(0) @binding(3) var<uniform> slicemap: SlicemapUniform;
@group(0) @binding(4) var<storage, read> slicemap_bits: array<u32>;
@group(0) @binding(5) var<storage, read> slicemap_extents: array<u32>;
@group(0) @binding(6) var<uniform> transmittance: TransmittanceUniform;
// Of each byte the number of its ones: the paper's summask.
@group(0) @binding(7) var<storage, read> summask: array<u32>;

// Whether ones are counted by the table, or by the processor.
override USES_TABLE: bool;

fn slicemap_ones(word: u32) -> u32 {
    if !USES_TABLE {
        return countOneBits(word);
    }
    return summask[word & 0xffu] + summask[(word >> 8u) & 0xffu] + summask[(word >> 16u) & 0xffu] + summask[word >> 24u];
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    var left = vec3f(1.0);
    var is_inside = false;
    if pixel_depth != view.far_depth && dot(n, n) > 0.25 {
        let world = world_from_texel(view, texel, pixel_depth);
        let clip = slicemap.clip_from_world * vec4f(world, 1.0);
        let uv = uv_from_ndc(clip.xy / clip.w);
        is_inside = clip.w > 0.0 && all(uv >= vec2f(0.0)) && all(uv < vec2f(1.0));
        left = lumivox_light_left(world);
    }
    if !is_inside && transmittance.only_inside != 0u {
        discard;
    }
    return vec4f(left, 1.0);
}
