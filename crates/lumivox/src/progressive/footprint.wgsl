// The rules `footprint` and `rays`: whether a view proves a whole cell empty. Goes with a shader that declares `grid`, `view` and
// `depth`; `levels` are made by progressive/nearest.

@group(0) @binding(12) var<storage, read> levels: array<u32>;

override SURFACE_SHIFT: f32;
// Whether each texel is held against the depth at which its ray leaves the cell, in place of that of the cell's farthest corner.
override BY_RAYS: bool;

// A footprint that is wider than this many texels is looked at in blocks of 2, 4, 8.. of them.
const FINE_LOG2: u32 = 3u;

struct Footprint {
    // Whether the cell lies before the eye, beyond the near plane and in the picture, all of it. The rest is meaningless if not.
    is_whole: bool,
    // The first and the last texel that it touches.
    low: vec2u,
    high: vec2u,
    // The depth of its farthest corner.
    farthest: f32,
}

// Of a cube with this middle, in metres.
fn footprint(middle: vec3f, half_side: f32) -> Footprint {
    var found: Footprint;
    let is_reversed = view.far_depth == 0.0;
    var low = vec2f(3.0e38);
    var high = vec2f(-3.0e38);
    found.farthest = 1.0 - view.far_depth;
    for (var corner = 0u; corner < 8u; corner++) {
        let side = vec3f(vec3u(corner, corner >> 1u, corner >> 2u) & vec3u(1u)) * 2.0 - 1.0;
        let clip = view.clip_from_world * vec4f(middle + half_side * side, 1.0);
        let ndc = clip.xyz / clip.w;
        let is_near = select((ndc.z < 0.0), (ndc.z > 1.0), is_reversed);
        if clip.w <= 0.0 || is_near {
            return found;
        }
        let at = uv_from_ndc(ndc.xy) * vec2f(view.size);
        low = min(low, at);
        high = max(high, at);
        found.farthest = select(max(found.farthest, ndc.z), min(found.farthest, ndc.z), is_reversed);
    }
    found.is_whole = all(low >= vec2f(0.0)) && all(high <= vec2f(view.size));
    found.low = vec2u(max(low, vec2f(0.0)));
    found.high = min(vec2u(max(high, vec2f(0.0))), view.size - 1u);
    return found;
}

// The nearest depth of a block of 2^level texels a side.
fn nearest_depth(block: vec2u, level: u32) -> f32 {
    if level == 0u {
        return textureLoad(depth, block, 0).r;
    }
    let columns = (view.size.x + (1u << level) - 1u) >> level;
    return bitcast<f32>(levels[levels[level] + block.x + columns * block.y]);
}

// The depth at which rays through the middles of these texels have left a cube with this middle, for the last of them.
fn exit_depth(middle: vec3f, half_side: f32, low: vec2u, high: vec2u, farthest: f32) -> f32 {
    let is_reversed = view.far_depth == 0.0;
    let first = ndc_from_uv((vec2f(low) + 0.5) / vec2f(view.size));
    let last = ndc_from_uv((vec2f(high) + 0.5) / vec2f(view.size));
    let center = 0.5 * (first + last);
    let reach = 0.5 * abs(last - first);
    var depth_there = farthest;
    for (var face = 0u; face < 6u; face++) {
        var outward = vec3f(0.0);
        outward[face / 2u] = f32(face % 2u) * 2.0 - 1.0;
        // Zero on the face's plane, positive beyond it.
        let plane = vec4f(outward, -dot(outward, middle) - half_side) * view.world_from_clip;
        let away = select(plane.z, -plane.z, is_reversed);
        // Rays come in by the others.
        if away > 0.0 {
            let at = -(dot(plane.xy, center) + plane.w) / plane.z;
            let more = dot(abs(plane.xy / plane.z), reach);
            depth_there = select(min(depth_there, at + more), max(depth_there, at - more), is_reversed);
        }
    }
    return depth_there;
}

fn proven_empty_cube(middle: vec3f, half_side: f32) -> bool {
    let print = footprint(middle, half_side);
    if !print.is_whole {
        return false;
    }
    let across = max(print.high.x - print.low.x, print.high.y - print.low.y);
    let level = u32(max(0, i32(firstLeadingBit(across)) - i32(FINE_LOG2) + 1));
    let first = print.low >> vec2u(level);
    let count = (print.high >> vec2u(level)) - first + 1u;
    let is_reversed = view.far_depth == 0.0;
    for (var n = 0u; n < count.x * count.y; n++) {
        let block = first + vec2u(n % count.x, n / count.x);
        let recorded = nearest_depth(block, level);
        var beyond = print.farthest;
        if BY_RAYS {
            let low = block << vec2u(level);
            let high = min(low + (1u << level), view.size) - 1u;
            beyond = exit_depth(middle, half_side, low, high, print.farthest);
        }
        if !select((recorded > beyond), (recorded < beyond), is_reversed) {
            return false;
        }
    }
    return true;
}

// A cell holds points of surfaces that lie up to the shift before it. Rays leave as much room again for rounding.
fn proven_empty(cell: vec3u) -> bool {
    let shift = select(SURFACE_SHIFT, 2.0 * SURFACE_SHIFT, BY_RAYS);
    return proven_empty_cube(cell_center(grid, cell), grid.cell_size * (0.5 + shift));
}
