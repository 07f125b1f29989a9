// The nearest depth of blocks of 2, 4, 8.. texels a side: three levels from the one before, a block of the last per invocation.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var depth: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> levels: array<u32>;

// The level that is read; 0 is the picture.
override FROM: u32;

fn level_size(level: u32) -> vec2u {
    return (view.size + (1u << level) - 1u) >> vec2u(level);
}

fn depth_at(at: vec2u) -> f32 {
    if FROM == 0u {
        return textureLoad(depth, at, 0).r;
    }
    return bitcast<f32>(levels[levels[FROM] + at.x + level_size(FROM).x * at.y]);
}

fn keep(up: u32, at: vec2u, value: f32) {
    let size = level_size(FROM + up);
    if all(at < size) {
        levels[levels[FROM + up] + at.x + size.x * at.y] = bitcast<u32>(value);
    }
}

fn nearer(a: f32, b: f32) -> f32 {
    return select(min(a, b), max(a, b), view.far_depth == 0.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level_size(FROM + 3u)) {
        return;
    }
    let size = level_size(FROM);
    var of_two = view.far_depth;
    var of_four = view.far_depth;
    var of_eight = view.far_depth;
    // Along a Z-shaped curve, so that blocks are done one after another.
    for (var n = 0u; n < 64u; n++) {
        let place = vec2u((n & 1u) | (n >> 1u & 2u) | (n >> 2u & 4u), (n >> 1u & 1u) | (n >> 2u & 2u) | (n >> 3u & 4u));
        let at = 8u * id.xy + place;
        if all(at < size) {
            of_two = nearer(of_two, depth_at(at));
        }
        if n % 4u == 3u {
            keep(1u, at / 2u, of_two);
            of_four = nearer(of_four, of_two);
            of_two = view.far_depth;
        }
        if n % 16u == 15u {
            keep(2u, at / 4u, of_four);
            of_eight = nearer(of_eight, of_four);
            of_four = view.far_depth;
        }
    }
    keep(3u, id.xy, of_eight);
}
