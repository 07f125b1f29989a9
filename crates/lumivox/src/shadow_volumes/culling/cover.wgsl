// One workgroup per caster: the texels that it covers all over, with the nearest of the casters' farthest distances there.
//
// How often a caster is crossed by rays changes only at its outline. So where it touches a texel and its outline does not, each ray of the
// texel is stopped by it, no farther than the farthest of it.

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> rects: array<u32>;
@group(0) @binding(3) var<storage, read> footprints: array<u32>;
// Inverted bits of a distance; 0 where nothing covers.
@group(0) @binding(4) var<storage, read_write> covered: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let caster = id.x + id.y * groups.x;
    if caster >= volume.casters {
        return;
    }
    let rect = rect_of(caster);
    if rect.place == NO_PLACE {
        return;
    }
    for (var own = lane; own < rect.area; own += 64u) {
        let nearest = footprints[2u * (rect.place + own)];
        let farthest = footprints[2u * (rect.place + own) + 1u];
        if nearest != 0u && farthest != 0xffffffffu {
            atomicMax(&covered[column_of(map.size, texel_of(rect, own))], ~farthest);
        }
    }
}
