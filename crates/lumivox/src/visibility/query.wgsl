// Rays from a buffer against all objects, one per invocation (dissertation 4.5.2).

struct QueryUniform {
    rays: u32,
    object_count: u32,
    reserved_0: u32,
    reserved_1: u32,
}

@group(0) @binding(0) var<uniform> query: QueryUniform;
@group(0) @binding(1) var<storage, read> objects: array<ObjectUniform>;
@group(0) @binding(2) var<storage, read> fields: array<FieldUniform>;
@group(0) @binding(3) var<storage, read> field_points: array<vec4f>;
@group(0) @binding(4) var<storage, read> field_table: array<u32>;
@group(0) @binding(5) var<storage, read> field_depths: array<f32>;
@group(0) @binding(6) var field_maps: texture_3d<u32>;
@group(0) @binding(7) var field_normals: texture_3d<i32>;
// Origin and direction of each ray.
@group(0) @binding(8) var<storage, read> rays: array<vec4f>;
// Distance, octahedral normal, and number of the object.
@group(0) @binding(9) var<storage, read_write> hits: array<vec4u>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let ray = id.x + id.y * groups.x * 64u;
    if ray >= query.rays {
        return;
    }
    let origin = rays[2u * ray].xyz;
    let direction = rays[2u * ray + 1u].xyz;
    var nearest = Ahead(NOTHING, vec3f(0.0), direction);
    var met = 0u;
    for (var first = 0u; first < query.object_count; first += 32u) {
        let all = select(0xffffffffu, (1u << (query.object_count - first)) - 1u, query.object_count - first < 32u);
        var bits = met_spheres(all, first, origin, direction);
        while bits != 0u {
            let n = first + firstTrailingBit(bits);
            bits &= bits - 1u;
            let found = ahead(objects[n], origin, direction);
            if found.distance < nearest.distance {
                nearest = found;
                met = n;
            }
        }
    }
    var flat_normal = vec2f(0.0);
    if nearest.distance < NOTHING {
        flat_normal = octahedron_from_direction(hit_normal(objects[met], nearest, direction));
    }
    hits[ray] = vec4u(bitcast<u32>(nearest.distance), bitcast<vec2u>(flat_normal), met);
}
