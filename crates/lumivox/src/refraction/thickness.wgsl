// Metres of each kind that a column's ray crosses, for one column per invocation.

struct ThicknessUniform {
    is_cut: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var<uniform> slicemap: SlicemapUniform;
@group(0) @binding(3) var<storage, read> slicemap_bits: array<u32>;
@group(0) @binding(4) var<storage, read> slicemap_extents: array<u32>;
@group(0) @binding(5) var<uniform> thickness: ThicknessUniform;
@group(0) @binding(6) var<storage, read> evaluation: array<u32>;

// Whether cells are counted by the table of bytes, or surface by surface.
override USES_TABLE: bool;

const OUTSIDE: u32 = 0u;
const INSIDE: u32 = 1u;
// Behind an ambiguous cell.
const UNKNOWN: u32 = 2u;

// Inner cells of a kind before slice `end`, surface by surface.
fn inner_cells(column: u32, kind: u32, end: u32) -> u32 {
    let fronts = slicemap_word(column, 2u * kind);
    let backs = slicemap_word(column, 2u * kind + 1u);
    var count = 0u;
    var state = OUTSIDE;
    // Where the ray went in, or the first cell behind an ambiguous one.
    var since = 0u;
    for (var n = 0u; 32u * n < end; n++) {
        let wanted = slicemap_bits_before(32u * n, end);
        let front = slicemap_bits[fronts + n] & wanted;
        let back = slicemap_bits[backs + n] & wanted;
        var left = front | back;
        while left != 0u {
            let bit = left & (~left + 1u);
            let slice = 32u * n + firstTrailingBit(left);
            left &= left - 1u;
            let is_front = (front & bit) != 0u;
            let is_back = (back & bit) != 0u;
            if is_front && is_back {
                count += 1u + select(0u, slice - since, state == INSIDE);
                state = UNKNOWN;
                since = slice + 1u;
            } else if is_front {
                since = select(slice, since, state == INSIDE);
                state = INSIDE;
            } else {
                count += select(0u, slice - since, state != OUTSIDE);
                state = OUTSIDE;
            }
        }
    }
    return count + select(0u, end - since, state == INSIDE);
}

// The same, a byte after the other.
fn inner_cells_by_table(column: u32, kind: u32, end: u32) -> u32 {
    let fronts = slicemap_word(column, 2u * kind);
    let backs = slicemap_word(column, 2u * kind + 1u);
    var count = 0u;
    var is_inside = false;
    // One and the cells that wait for what comes next, or none.
    var waiting = 0u;
    for (var first = 0u; first < end; first += 8u) {
        let wanted = slicemap_bits_before(32u * (first / 32u), end);
        let front = ((slicemap_bits[fronts + first / 32u] & wanted) >> (first % 32u)) & 0xffu;
        let back = ((slicemap_bits[backs + first / 32u] & wanted) >> (first % 32u)) & 0xffu;
        if waiting != 0u && (front | back) == 0u {
            waiting += 8u;
            continue;
        }
        let entry = evaluation[front + 256u * back];
        if waiting != 0u {
            is_inside = ((entry >> 16u) & 0xffu) != 0u;
            count += select(0u, waiting - 1u, is_inside);
        }
        let found = select((entry >> 8u) & 0xffu, entry & 0xffu, is_inside);
        count += found & 0x7fu;
        is_inside = found >= 128u;
        waiting = entry >> 24u;
    }
    // The last byte has cells beyond the end.
    return count - select(0u, (8u - end % 8u) % 8u, is_inside);
}

// Metres along a column's ray for each along the view.
fn slant(column: vec2u) -> f32 {
    let ndc = ndc_from_uv((vec2f(column) + 0.5) / vec2f(slicemap.size));
    let near = slicemap.world_from_clip * vec4f(ndc, mix(slicemap.far_depth, 1.0 - slicemap.far_depth, 0.5), 1.0);
    let far = slicemap.world_from_clip * vec4f(ndc, mix(slicemap.far_depth, 1.0 - slicemap.far_depth, 0.25), 1.0);
    let way = far.xyz / far.w - near.xyz / near.w;
    let along = -(slicemap.eye_from_world * vec4f(way, 0.0)).z;
    return length(way) / max(along, 1e-30);
}

// The first slice that opaque things hide.
fn visible_end(column: vec2u, near: f32, far: f32) -> u32 {
    if thickness.is_cut == 0u {
        return slicemap.slices;
    }
    let texel = min(vec2u((vec2f(column) + 0.5) / vec2f(slicemap.size) * vec2f(view.size)), view.size - 1u);
    let stored = textureLoad(depth, texel, 0).r;
    if stored == view.far_depth {
        return slicemap.slices;
    }
    let place = slicemap_place(eye_distance(view, world_from_texel(view, texel, stored)), near, far);
    return u32(clamp(floor(place + 0.5), 0.0, f32(slicemap.slices)));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let column = slicemap_column(pixel);
    var near = slicemap.near;
    var far = slicemap.far;
    if slicemap.is_local != 0u {
        let last = slicemap_extents[2u * column + 1u];
        if last == 0u {
            return vec4f(0.0);
        }
        near = bitcast<f32>(~slicemap_extents[2u * column]);
        far = bitcast<f32>(last);
    }
    let end = visible_end(pixel, near, far);
    let metres = slant(pixel) * (far - near) / f32(slicemap.slices);
    var found = vec4f(0.0);
    for (var kind = 0u; 2u * kind < slicemap.sets; kind++) {
        var count = 0u;
        if USES_TABLE {
            count = inner_cells_by_table(column, kind, end);
        } else {
            count = inner_cells(column, kind, end);
        }
        // The farthest surface lies at the end of the last cell of a local column.
        let last = slicemap_word(column, 2u * kind) + (slicemap.slices - 1u) / 32u;
        let bit = 1u << ((slicemap.slices - 1u) % 32u);
        let closes = (slicemap_bits[last + slicemap.words] & ~slicemap_bits[last] & bit) != 0u;
        if closes && end == slicemap.slices && slicemap.is_local != 0u && count > 0u {
            count += 1u;
        }
        found[kind] = metres * f32(count);
    }
    return found;
}
