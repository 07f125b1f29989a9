// Transport properties of one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: PropagationUniform;
@group(0) @binding(2) var<storage, read> normal: array<vec2u>;
@group(0) @binding(3) var<storage, read> albedo: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> transport: array<vec4u>;

// Occupancy in steps of 1/255, of which opacity has as many.
fn opacity_steps(occupancy: f32) -> u32 {
    return u32(round(255.0 * saturate(occupancy)));
}

fn stops_light(cell: vec3i) -> bool {
    return cell_in_grid(grid, cell) && opacity_steps(unpack_half4(normal[cell_index(grid, vec3u(cell))]).w) == 255u;
}

// Every open face before the surface adds (1 + n.f) / 2 of its irradiance, which is exact for one face. A slanted surface is
// seen through two or three: it gets their mean.
fn gather_correction(n: vec3f, open: u32) -> f32 {
    var received = 0.0;
    for (var face = 0u; face < 6u; face++) {
        let cosine = dot(n, FACE_NORMALS[face]);
        if (open & (1u << face)) != 0u && cosine > 0.05 {
            received += 0.5 * (1.0 + cosine);
        }
    }
    return select(1.0, 1.0 / max(received, 0.5), received > 0.0);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let stored = unpack_half4(normal[index]);
    if !(stored.w > 0.0) {
        transport[index] = vec4u(0u);
        return;
    }
    let cell = vec3i(cell_from_index(grid, index));
    var bits = OCCUPIED | (opacity_steps(stored.w) << 8u);
    for (var face = 0u; face < 6u; face++) {
        if !stops_light(cell + vec3i(FACE_NORMALS[face])) {
            bits |= 1u << face;
        }
    }
    // Shorter than this, the surfaces in the cell look into all directions and none is better than another.
    let steady = dot(stored.xyz, stored.xyz) > 1e-4;
    let n = select(vec3f(0.0), normalize(stored.xyz + vec3f(0.0, 1e-20, 0.0)), steady);
    let stored_albedo = saturate(unpack_half4(albedo[index]).rgb);
    let reflectance = select(stored_albedo, vec3f(settings.bounce_albedo), settings.bounce_albedo >= 0.0);
    transport[index] = pack_transport(Transport(n, bits, reflectance, gather_correction(n, bits)));
}
