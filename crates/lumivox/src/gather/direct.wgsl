// Direct light of one surfel per invocation: a view is asked what it sees at some of the surfel's points.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var<uniform> settings: GatherUniform;
@group(0) @binding(3) var depth: texture_2d<f32>;
@group(0) @binding(4) var normal: texture_2d<f32>;
@group(0) @binding(5) var radiance: texture_2d<f32>;
@group(0) @binding(6) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(8) var<storage, read> due: DueSurfels;

override SAME_SIDE: f32;
override NEAR_PLANE: f32;
override NEAR_POINT: f32;
// Cosine below which a texel is not followed any farther along the surface that it grazes.
const STEEPEST: f32 = 0.05;

// How far a texel reaches along a surface with normal n, in metres: far, where the view grazes it.
fn texel_reach(texel: vec2u, recorded: f32, n: vec3f) -> f32 {
    let here = world_from_texel(view, texel, recorded);
    let beside = distance(world_from_texel(view, texel + vec2u(1u, 0u), recorded), here);
    let ahead = normalize(world_from_texel(view, texel, 0.3) - world_from_texel(view, texel, 0.7));
    return beside / max(abs(dot(ahead, n)), STEEPEST);
}

// Radiance that leaves the surface at a point, as the view shows it; black where it sees something else.
fn seen(surfel: Surfel, point: vec3f, subcell_size: f32) -> vec3f {
    let at = projected(view, point);
    if !at.inside {
        return vec3f(0.0);
    }
    let recorded = textureLoad(depth, at.texel, 0).r;
    if recorded == view.far_depth || dot(textureLoad(normal, at.texel, 0).xyz, surfel.normal) < SAME_SIDE {
        return vec3f(0.0);
    }
    let away = world_from_texel(view, at.texel, recorded) - point;
    let near_point = max(NEAR_POINT * subcell_size, texel_reach(at.texel, recorded, surfel.normal));
    if abs(dot(away, surfel.normal)) > NEAR_PLANE * subcell_size || length(away) > near_point {
        return vec3f(0.0);
    }
    return clamp(textureLoad(radiance, at.texel, 0).rgb, vec3f(0.0), vec3f(HALF_MAX));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= due.count {
        return;
    }
    let place = due.surfels[nth].x;
    let before = light[place];
    let surfel = unpack_surfel(surfels[place]);
    if !has_turn(surfel.cell) && !is_served_early(before) {
        return;
    }
    let cell = cell_from_index(grid, surfel.cell);
    let subcell_size = 0.25 * grid.cell_size;
    let there = bit_count(surfel.bits);
    let asked = min(there, settings.light_points);
    var sum = vec3f(0.0);
    for (var k = 0u; k < asked; k++) {
        let bit = nth_bit(surfel.bits, ((2u * k + 1u) * there) / (2u * asked));
        let point = grid.origin + subcell_size * (subcell_corner(cell, bit) + 0.5);
        sum += seen(surfel, point, subcell_size);
    }
    var age = select(before.w, INHERITED_ASKED, before.w == INHERITED);
    age = select(age, NEW_ASKED, before.w == NEW);
    light[place] = vec4f(before.rgb + sum / f32(asked), age);
}
