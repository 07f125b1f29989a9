// How many primitives each triangle of a batch becomes. What a geometry shader would decide triangle by triangle.

@group(3) @binding(0) var<storage, read_write> work: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= batch.count {
        return;
    }
    if index == 0u {
        work[0] = batch.count;
    }
    var primitives = 0u;
    if batch.first + index < mesh.counts.y {
        let t = lv_load_triangle(batch.first + index);
        // What a sweep sees edge-on has no samples.
        if t.exists && t.normal.z != 0.0 {
            primitives = lv_primitives(t);
        }
    }
    work[LV_WORK_HEAD + index] = primitives;
}
