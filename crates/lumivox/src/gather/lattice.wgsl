// Light from all around at one point of a lattice per invocation.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> sky: array<vec4f>;
@group(0) @binding(2) var<uniform> lattice: LatticeUniform;
@group(0) @binding(3) var<storage, read> mask: array<vec2u>;
@group(0) @binding(4) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(5) var<storage, read> table: array<u32>;
@group(0) @binding(6) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(7) var<storage, read> shown: array<vec4u>;
@group(0) @binding(8) var red: texture_storage_3d<rgba16float, write>;
@group(0) @binding(9) var green: texture_storage_3d<rgba16float, write>;
@group(0) @binding(10) var blue: texture_storage_3d<rgba16float, write>;

// Shells that a point inside of something looks for a free place in; the last is a spacing away.
const SHELLS: u32 = 4u;

// The nearest free place to a point, in sub-cells, and whether there is one.
fn free_place(p: vec3f) -> vec4f {
    if is_free(p) {
        return vec4f(p, 1.0);
    }
    for (var shell = 1u; shell <= SHELLS; shell++) {
        let reach = f32(SUBCELLS) * f32(lattice.spacing) * f32(shell) / f32(SHELLS);
        // Faces first, then edges, then corners of a cube.
        for (var kind = 1u; kind <= 3u; kind++) {
            for (var n = 0u; n < 27u; n++) {
                let offset = vec3i(vec3u(n % 3u, (n / 3u) % 3u, n / 9u)) - 1;
                let sides = u32(abs(offset.x) + abs(offset.y) + abs(offset.z));
                let place = p + reach * vec3f(offset);
                if sides == kind && is_free(place) {
                    return vec4f(place, 1.0);
                }
            }
        }
    }
    return vec4f(p, 0.0);
}

// Direction number `ray` of a spiral over the whole sphere, turned differently at each point.
fn direction_around(ray: u32, turn: f32) -> vec3f {
    let y = 1.0 - (2.0 * f32(ray) + 1.0) / f32(lattice.rays);
    let angle = 6.2831853 * fract(f32(ray) * 0.61803399 + turn);
    return vec3f(sqrt(max(1.0 - y * y, 0.0)) * vec2f(cos(angle), sin(angle)), y).xzy;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= lattice.count {
        return;
    }
    let index = lattice.first + nth;
    let at = lattice_point(lattice.dims, index);
    let place = free_place(f32(SUBCELLS) * f32(lattice.spacing) * (vec3f(at) + 0.5) + 0.01);
    var sum = sh_zero();
    if place.w > 0.0 {
        let turn = hashed(index, 3u);
        for (var ray = 0u; ray < lattice.rays; ray++) {
            let direction = direction_around(ray, turn);
            let basis = vec4f(SH_Y0, SH_Y0 * 1.7320508 * direction);
            sum = sh_add(sum, sh_scaled(radiance_along(place.xyz, direction), basis));
        }
        sum = sh_times(sum, 12.566371 / f32(lattice.rays));
    }
    textureStore(red, at, sum.r);
    textureStore(green, at, sum.g);
    textureStore(blue, at, sum.b);
}
