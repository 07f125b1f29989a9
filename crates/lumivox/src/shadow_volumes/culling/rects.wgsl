// One triangle per invocation: the rectangle of texels around all casting triangles of a caster.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4u>;
@group(0) @binding(4) var<storage, read> facing: array<i32>;
// Of each caster eight words: the map's size less the first texel, one more than the last; then what `places` adds.
@group(0) @binding(5) var<storage, read_write> rects: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let n = linear_index(id, groups);
    if n >= volume.triangles || facing[n] == 0 {
        return;
    }
    let triangle = triangles[n];
    let box = box_of(points_in(map.clip_from_world, corners_of(triangle)));
    if box.x > box.z {
        return;
    }
    let ends = box_texels(box, map.size);
    if any(ends[0] > ends[1]) {
        return;
    }
    let first = 8u * (triangle.w & 0x7fffffffu);
    atomicMax(&rects[first], map.size.x - u32(ends[0].x));
    atomicMax(&rects[first + 1u], map.size.y - u32(ends[0].y));
    atomicMax(&rects[first + 2u], u32(ends[1].x) + 1u);
    atomicMax(&rects[first + 3u], u32(ends[1].y) + 1u);
}
