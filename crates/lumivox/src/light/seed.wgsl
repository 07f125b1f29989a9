// The first propagation state of one cell per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: PropagationUniform;
@group(0) @binding(2) var<storage, read> transport: array<vec4u>;
@group(0) @binding(3) var<storage, read> direct: array<vec2u>;
@group(0) @binding(4) var<storage, read> emission: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> state: array<vec2u>;

// Adds to what is under way, or takes its place.
override ADDS: bool;

const PI: f32 = 3.1415927;

fn surface_light(index: u32, properties: Transport) -> ShRgb {
    let reflected = ShRgb(
        unpack_half4(direct[3u * index]),
        unpack_half4(direct[3u * index + 1u]),
        unpack_half4(direct[3u * index + 2u]),
    );
    let emitted = sh_scaled(unpack_half4(emission[index]).rgb, sh_cosine_lobe(properties.normal));
    let crossed = max(dot(abs(properties.normal), vec3f(1.0)), 1.0);
    let light = sh_times(sh_add(reflected, emitted), opacity(properties) / crossed);
    if is_opaque(properties) {
        return light;
    }
    // What lets light through has no closed faces: its lobe must not send any back through the surface.
    let narrowed = vec4f(1.0, vec3f(SURFACE_RATIO / COSINE_RATIO));
    return ShRgb(narrowed * light.r, narrowed * light.g, narrowed * light.b);
}

// A uniform sky sends pi times its radiance through every face of the grid's boundary.
fn sky_light(cell: vec3i) -> ShRgb {
    var sh = sh_zero();
    for (var face = 0u; face < 6u; face++) {
        if !cell_in_grid(grid, cell + vec3i(FACE_NORMALS[face])) {
            sh = sh_add(sh, sh_scaled(PI * settings.sky, flux_lobe(-FACE_NORMALS[face], SURFACE_RATIO)));
        }
    }
    return sh;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let properties = unpack_transport(transport[index]);
    var sh = sh_zero();
    if is_occupied(properties) {
        sh = surface_light(index, properties);
    } else {
        sh = sky_light(vec3i(cell_from_index(grid, index)));
    }
    if ADDS {
        sh.r += unpack_half4(state[3u * index]);
        sh.g += unpack_half4(state[3u * index + 1u]);
        sh.b += unpack_half4(state[3u * index + 2u]);
    }
    state[3u * index] = pack_half4(sh.r);
    state[3u * index + 1u] = pack_half4(sh.g);
    state[3u * index + 2u] = pack_half4(sh.b);
}
