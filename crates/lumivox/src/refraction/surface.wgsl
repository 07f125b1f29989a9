// The nearest glass: vertices by their numbers, and their normals.

@group(0) @binding(0) var<uniform> slicemap: SlicemapUniform;

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
    // Relative to the eye.
    @location(1) eye: vec3f,
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Fragment {
    var f: Fragment;
    let triangle = batch.first + index / 3u;
    if triangle >= mesh.counts.y {
        f.position = vec4f(2.0, 2.0, 0.5, 1.0);
        return f;
    }
    let vertex = lv_index(3u * triangle + index % 3u);
    let world = mesh.world_from_local * vec4f(lv_local_position(vertex), 1.0);
    f.position = slicemap.clip_from_world * world;
    f.eye = (slicemap.eye_from_world * world).xyz;
    if lv_mesh_has(MESH_HAS_NORMALS) {
        f.normal = mat3x3f(mesh.normal_x, mesh.normal_y, mesh.normal_z) * lv_local_normal(vertex);
    } else {
        let a = lv_local_position(lv_index(3u * triangle));
        let b = lv_local_position(lv_index(3u * triangle + 1u));
        let c = lv_local_position(lv_index(3u * triangle + 2u));
        f.normal = mat3x3f(mesh.normal_x, mesh.normal_y, mesh.normal_z) * cross(b - a, c - a);
    }
    return f;
}

@fragment
fn fragment_main(f: Fragment, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let length2 = dot(f.normal, f.normal);
    let is_parallel = slicemap.clip_from_world[0].w == 0.0 && slicemap.clip_from_world[1].w == 0.0
        && slicemap.clip_from_world[2].w == 0.0;
    let eye = select(normalize(f.eye), vec3f(0.0, 0.0, -1.0), is_parallel);
    let way = (transpose(slicemap.eye_from_world) * vec4f(eye, 0.0)).xyz;
    // A pane is seen from its back too. A mirrored mesh turns its triangles the other way.
    let side = select(-1.0, 1.0, is_front == (mesh.side > 0.0));
    var n = select(-way, side * f.normal * inverseSqrt(max(length2, 1e-30)), length2 > 1e-30);
    // Near a silhouette an interpolated normal may look away though its face does not.
    n = normalize(n - 1.001 * max(dot(n, way), 0.0) * way);
    let kind = slicemap.bit_set / (1u + slicemap.splits_faces);
    return vec4f(n, 1.0 + f32(kind));
}
