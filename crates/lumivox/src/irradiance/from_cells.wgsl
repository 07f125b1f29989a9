// Light at one point of a lattice per invocation: the mean over the cells around it. The shader that uses this says what light a cell has
// (`cell_light`) and how much it counts (`cell_weight`).

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> lattice: LatticeUniform;
@group(0) @binding(2) var<storage, read> light: array<vec4f>;
@group(0) @binding(3) var red: texture_storage_3d<rgba16float, write>;
@group(0) @binding(4) var green: texture_storage_3d<rgba16float, write>;
@group(0) @binding(5) var blue: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let nth = linear_id(id, workgroups);
    if nth >= lattice.count {
        return;
    }
    let at = lattice_point(lattice.dims, lattice.first + nth);
    let low = lattice.spacing * at;
    let high = min(low + lattice.spacing, grid.dims);
    var sum = sh_zero();
    var weights = 0.0;
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                let index = cell_index(grid, vec3u(x, y, z));
                let weight = cell_weight(index);
                sum = sh_add(sum, sh_times(cell_light(index), weight));
                weights += weight;
            }
        }
    }
    let mean = sh_times(sum, 1.0 / max(weights, 1e-12));
    textureStore(red, at, clamp(mean.r, vec4f(-HALF_MAX), vec4f(HALF_MAX)));
    textureStore(green, at, clamp(mean.g, vec4f(-HALF_MAX), vec4f(HALF_MAX)));
    textureStore(blue, at, clamp(mean.b, vec4f(-HALF_MAX), vec4f(HALF_MAX)));
}
