// A caster's triangles for an occlusion query (the paper's practical algorithm): what is left of them are texels with receivers in one layer,
// the number of the instance; for the number after the last, texels that the light sees.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(4) var<storage, read> facing: array<i32>;
@group(0) @binding(5) var<storage, read> covered: array<u32>;
@group(0) @binding(6) var<storage, read> slices: array<u32>;

struct Asked {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) number: u32,
    @location(1) @interpolate(flat) layer: u32,
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32, @builtin(instance_index) layer: u32) -> Asked {
    let n = index / 6u;
    var boxed = no_box();
    if facing[n] != 0 {
        boxed = box_corner(points_in(map.clip_from_world, corners_of(triangles[n])), map.size, index, n);
    }
    return Asked(boxed.position, boxed.number, layer);
}

@fragment
fn fragment_main(f: Asked) {
    let texel = vec2u(f.position.xy);
    let column = column_of(map.size, texel);
    let asks_light = f.layer == volume.layers;
    let word = slices[column * volume.words + min(f.layer / 32u, volume.words - 1u)];
    let has_receiver = ((word >> (f.layer % 32u)) & 1u) != 0u;
    if !(asks_light || has_receiver) {
        discard;
    }
    let corners = corners_of(triangles[f.number]);
    let points = points_in(map.clip_from_world, corners);
    let distance = piece_in(points, values_at(map.distance, corners), texel, map.size).distance;
    let counts_hidden = !asks_light && map.by_texel == 0u;
    let is_seen = counts_hidden || !is_hidden(covered[column], max(distance.x, 0.0));
    if distance.x > distance.y || !is_seen {
        discard;
    }
}
