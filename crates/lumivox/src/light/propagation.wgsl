// One propagation step, one cell per invocation: gathering from six neighbours.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: PropagationUniform;
@group(0) @binding(2) var<storage, read> transport: array<vec4u>;
@group(0) @binding(3) var<storage, read> state: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> next_state: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> incident: array<vec4f>;

// How surfaces reflect.
override REFLECTION: u32;
// Whether incident light is that of all steps, or of this one.
override ACCUMULATES: bool;
// Whether empty cells keep incident light, too.
override IN_FREE_SPACE: bool;
const LAMBERTIAN: u32 = 0u;
const AXIS_MIRROR: u32 = 1u;

// Flux in W/m2 that a cell sends through its face `face`, three colour bands.
fn sent_flux(index: u32, properties: Transport, face: u32) -> vec3f {
    let r = unpack_half4(state[3u * index]);
    let g = unpack_half4(state[3u * index + 1u]);
    let b = unpack_half4(state[3u * index + 2u]);
    if is_opaque(properties) {
        let weights = axis_weights(properties);
        return vec3f(
            occupied_face_flux(properties, weights, face, r),
            occupied_face_flux(properties, weights, face, g),
            occupied_face_flux(properties, weights, face, b),
        );
    }
    return vec3f(empty_face_flux(face, r), empty_face_flux(face, g), empty_face_flux(face, b));
}

// The normal of a surface on the side that light which travels along `travel` comes from.
fn lit_side(n: vec3f, travel: vec3f) -> vec3f {
    let side = select(n, -n, dot(n, travel) > 0.0);
    return select(side, -travel, dot(side, side) == 0.0);
}

// Where light goes on to that travels along `travel`, an axis, and meets a surface with this normal.
fn reflected_direction(n: vec3f, travel: vec3f) -> vec3f {
    if REFLECTION == LAMBERTIAN {
        return lit_side(n, travel);
    }
    // Turned into the normal's frame, mirrored and turned back: of bands 0 and 1 that mirrors a vector. Surfaces that cancel
    // mirror as faces do.
    if REFLECTION == AXIS_MIRROR || dot(n, n) == 0.0 {
        return -travel;
    }
    return travel - 2.0 * dot(travel, n) * n;
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
        // On, as far as nothing is in the way.
        if !is_opaque(here) {
            let ratio = select(settings.lobe_ratio, SURFACE_RATIO, is_opaque(there));
            let passing = flux_lobe(-to_neighbor, ratio);
            next = sh_add(next, sh_scaled((1.0 - opacity(here)) * flux, passing));
            // A mirror at the shared face gives back what this cell sends there.
            if REFLECTION != LAMBERTIAN && is_opaque(there) {
                let mirrored = flux_lobe(reflected_direction(there.normal, to_neighbor), SURFACE_RATIO);
                next = sh_add(next, sh_scaled(there.albedo * sent_flux(index, here, face), mirrored));
            }
        }
        if !is_occupied(here) {
            if IN_FREE_SPACE {
                // Radiance of two bands whose net flux along each axis is what came through its faces.
                let even = settings.free_space_gain / (6.0 * SH_COS0);
                let arriving = vec4f(even, (0.5 / SH_COS1) * to_neighbor);
                received = sh_add(received, sh_scaled(flux, arriving));
            }
            continue;
        }
        // Light that comes out of the same surface goes on along it.
        let same_kind = is_occupied(there) && is_opaque(there) == is_opaque(here);
        let same_surface = same_kind && dot(here.normal, there.normal) > 0.25;
        if !is_opaque(here) {
            let held = opacity(here) * flux;
            let outward = reflected_direction(here.normal, -to_neighbor);
            let along = flux_lobe(-to_neighbor, settings.lobe_ratio);
            let lobe = flux_lobe(outward, SURFACE_RATIO);
            next = sh_add(next, sh_scaled(select(here.albedo, vec3f(1.0), same_surface) * held,
                select(lobe, along, same_surface)));
        } else if same_surface {
            next = sh_add(next, sh_scaled(flux, flux_lobe(lit_side(here.normal, to_neighbor), COSINE_RATIO)));
        } else if REFLECTION == LAMBERTIAN || is_opaque(there) {
            let lobe = flux_lobe(lit_side(here.normal, -to_neighbor), COSINE_RATIO);
            next = sh_add(next, sh_scaled(here.albedo * flux, lobe));
        }
        if !same_surface {
            // Uniform radiance over the hemisphere about the face: (1 + n.f) / 2 of its flux arrives at a normal n.
            let arriving = vec4f(0.5 / SH_COS0, (0.5 / SH_COS1) * to_neighbor);
            received = sh_add(received, sh_scaled(here.gather * flux, arriving));
        }
    }
    next_state[3u * index] = pack_half4(next.r);
    next_state[3u * index + 1u] = pack_half4(next.g);
    next_state[3u * index + 2u] = pack_half4(next.b);
    if IN_FREE_SPACE || is_occupied(here) {
        if ACCUMULATES {
            received.r += incident[3u * index];
            received.g += incident[3u * index + 1u];
            received.b += incident[3u * index + 2u];
        }
        incident[3u * index] = received.r;
        incident[3u * index + 1u] = received.g;
        incident[3u * index + 2u] = received.b;
    }
}
