// One workgroup per caster: the layers with receivers in all texels of its footprint, ORed (the paper's ideal algorithm).

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<uniform> map: MapUniform;
@group(0) @binding(2) var<storage, read> rects: array<u32>;
@group(0) @binding(3) var<storage, read> footprints: array<u32>;
@group(0) @binding(4) var<storage, read> covered: array<u32>;
@group(0) @binding(5) var<storage, read> slices: array<u32>;
// Of each caster whether the light sees it, and its layers.
@group(0) @binding(6) var<storage, read_write> kept: array<u32>;

var<workgroup> is_seen: atomic<u32>;
var<workgroup> found: array<atomic<u32>, 4>;

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) id: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let caster = id.x + id.y * groups.x;
    let is_caster = caster < volume.casters;
    let rect = rect_of(min(caster, volume.casters - 1u));
    let has_place = is_caster && rect.place != NO_PLACE;
    var bits: array<u32, 4>;
    var seen = 0u;
    for (var own = lane; has_place && own < rect.area; own += 64u) {
        let nearest = footprints[2u * (rect.place + own)];
        if nearest == 0u {
            continue;
        }
        let column = column_of(map.size, texel_of(rect, own));
        let is_seen_here = !is_hidden(covered[column], bitcast<f32>(~nearest));
        seen |= u32(is_seen_here);
        if is_seen_here || map.by_texel == 0u {
            for (var word = 0u; word < volume.words; word++) {
                bits[word] |= slices[column * volume.words + word];
            }
        }
    }
    atomicOr(&is_seen, seen);
    for (var word = 0u; word < volume.words; word++) {
        atomicOr(&found[word], bits[word]);
    }
    workgroupBarrier();
    if !is_caster || lane > 0u {
        return;
    }
    // Without room nothing is known, and all is kept.
    let all = select(0u, 0xffffffffu, !has_place);
    let first = caster * (volume.words + 1u);
    kept[first] |= atomicLoad(&is_seen) | all;
    for (var word = 0u; word < volume.words; word++) {
        kept[first + 1u + word] |= atomicLoad(&found[word]) | all;
    }
}
