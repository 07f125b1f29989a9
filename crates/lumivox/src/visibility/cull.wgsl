// Which objects reach which tiles, one tile per invocation; tiles with any are listed and drawn later. The part that comes with
// this says what of a tile counts, `Seen` and `seen_in`, and which objects do, `reaches`.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> tiles: TileUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> objects: array<ObjectUniform>;
@group(0) @binding(4) var<storage, read_write> tile_masks: array<u32>;
@group(0) @binding(5) var<storage, read_write> tile_list: array<u32>;
@group(0) @binding(6) var<storage, read_write> draw: Draw;

// What an indirect draw reads.
struct Draw {
    vertex_count: u32,
    instance_count: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x == 0u {
        draw.vertex_count = 6u;
    }
    if id.x >= tiles.tiles.x * tiles.tiles.y {
        return;
    }
    let seen = seen_in(vec2u(id.x % tiles.tiles.x, id.x / tiles.tiles.x));
    let first = first_word(id.x);
    var some = false;
    var filled = 0u;
    for (var word = 0u; word < tiles.words; word++) {
        var bits = 0u;
        let count = min(tiles.object_count - 32u * word, 32u);
        for (var n = 0u; n < count && seen.any; n++) {
            bits |= select(0u, 1u << n, reaches(seen, objects[32u * word + n]));
        }
        tile_masks[first + word] = bits;
        filled |= select(0u, 1u << (word & 31u), bits != 0u);
        some = some || bits != 0u;
        if (word & 31u) == 31u || word + 1u == tiles.words {
            tile_masks[first + tiles.words + word / 32u] = filled;
            filled = 0u;
        }
    }
    if some {
        tile_list[atomicAdd(&draw.instance_count, 1u)] = id.x;
    }
}
