// One propagation step, one cell per invocation: gathering from six neighbours.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: PropagationUniform;
@group(0) @binding(2) var<storage, read> transport: array<vec4u>;
@group(0) @binding(3) var<storage, read> state: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> next_state: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> incident: array<vec4f>;

// Flux in W/m2 that a neighbour sends through its face `face`, three colour bands.
fn sent_flux(neighbor: u32, properties: Transport, face: u32) -> vec3f {
    let r = unpack_half4(state[3u * neighbor]);
    let g = unpack_half4(state[3u * neighbor + 1u]);
    let b = unpack_half4(state[3u * neighbor + 2u]);
    if is_occupied(properties) {
        let weights = axis_weights(properties);
        return vec3f(
            occupied_face_flux(properties, weights, face, r),
            occupied_face_flux(properties, weights, face, g),
            occupied_face_flux(properties, weights, face, b),
        );
    }
    return vec3f(empty_face_flux(face, r), empty_face_flux(face, g), empty_face_flux(face, b));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let cell = vec3i(cell_from_index(grid, index));
    let here = unpack_transport(transport[index]);
    var next = sh_zero();
    var received = sh_zero();
    for (var face = 0u; face < 6u; face++) {
        let to_neighbor = FACE_NORMALS[face];
        let neighbor_cell = cell + vec3i(to_neighbor);
        if !cell_in_grid(grid, neighbor_cell) {
            continue;
        }
        let neighbor = cell_index(grid, vec3u(neighbor_cell));
        let there = unpack_transport(transport[neighbor]);
        let flux = sent_flux(neighbor, there, face ^ 1u);
        if !is_occupied(here) {
            let ratio = select(settings.lobe_ratio, SURFACE_RATIO, is_occupied(there));
            next = sh_add(next, sh_scaled(flux, flux_lobe(-to_neighbor, ratio)));
            continue;
        }
        // On the side of the surface that the light meets, or leaves from when it comes out of the same surface.
        let same_surface = is_occupied(there) && dot(here.normal, there.normal) > 0.25;
        let toward = select(to_neighbor, -to_neighbor, same_surface);
        let side = select(here.normal, -here.normal, dot(here.normal, toward) < 0.0);
        let outward = select(side, toward, dot(side, side) == 0.0);
        let lobe = flux_lobe(outward, COSINE_RATIO);
        if same_surface {
            next = sh_add(next, sh_scaled(flux, lobe));
        } else {
            next = sh_add(next, sh_scaled(here.albedo * flux, lobe));
            // Uniform radiance over the hemisphere about the face: (1 + n.f) / 2 of its flux arrives at a normal n.
            let arriving = vec4f(0.5 / SH_COS0, (0.5 / SH_COS1) * to_neighbor);
            received = sh_add(received, sh_scaled(here.gather * flux, arriving));
        }
    }
    next_state[3u * index] = pack_half4(next.r);
    next_state[3u * index + 1u] = pack_half4(next.g);
    next_state[3u * index + 2u] = pack_half4(next.b);
    if is_occupied(here) {
        incident[3u * index] += received.r;
        incident[3u * index + 1u] += received.g;
        incident[3u * index + 2u] += received.b;
    }
}
