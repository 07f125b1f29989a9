// Single-pass voxelization: one cell per invocation, cleared, kept or written by one view. `is_cleared` and `keeps_light`
// are made of the rules.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var albedo: texture_2d<f32>;
@group(0) @binding(5) var emission: texture_2d<f32>;
@group(0) @binding(6) var radiance: texture_2d<f32>;
@group(0) @binding(7) var<storage, read_write> cell_normal: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> cell_albedo: array<vec2u>;
@group(0) @binding(9) var<storage, read_write> cell_emission: array<vec2u>;
@group(0) @binding(10) var<storage, read_write> light: array<vec2u>;
// Not zero where one of this light's views has had its say.
@group(0) @binding(11) var<storage, read_write> decided: array<u32>;

// Adds to the light of the cell or replaces it.
override ADDS: bool;

const KEPT: u32 = 0u;
const CLEARED: u32 = 1u;
const WRITTEN: u32 = 2u;

// `facing` is the unit normal of the surface there, or zero where there is none.
fn verdict(cell: vec3u, at: Projected, recorded: f32, facing: vec3f) -> u32 {
    let surface = lifted(view, at.ndc, recorded) - SURFACE_SHIFT * grid.cell_size * facing;
    let behind = eye_distance(view, cell_center(grid, cell)) - eye_distance(view, surface);
    let reach = cell_reach(grid, view);
    if is_cleared(cell, behind, reach) {
        return CLEARED;
    }
    let is_surface = any(facing != vec3f(0.0));
    return select(KEPT, WRITTEN, is_surface && abs(behind) <= reach);
}

fn unit_normal(texel: vec2u, recorded: f32) -> vec3f {
    let facing = textureLoad(normal, texel, 0).xyz;
    if recorded == view.far_depth || dot(facing, facing) < 0.25 {
        return vec3f(0.0);
    }
    return normalize(facing);
}

fn write_light(at: u32, band: u32, value: vec4f, keeps: bool) {
    let before = select(vec4f(0.0), unpack_half4(light[at + band]), keeps);
    light[at + band] = pack_half4(before + value);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let cell = cell_from_index(grid, index);
    let at = projected(view, cell_center(grid, cell));
    if !at.inside || decided[index] != 0u {
        return;
    }
    decided[index] = 1u;
    let recorded = textureLoad(depth, at.texel, 0).r;
    let facing = unit_normal(at.texel, recorded);
    switch verdict(cell, at, recorded, facing) {
        case CLEARED: {
            cell_normal[index] = vec2u(0u);
            cell_albedo[index] = vec2u(0u);
            cell_emission[index] = vec2u(0u);
            for (var band = 0u; band < 3u; band++) {
                light[3u * index + band] = vec2u(0u);
            }
        }
        case WRITTEN: {
            let emitted = within_range(view, textureLoad(emission, at.texel, 0).rgb);
            cell_normal[index] = pack_half4(vec4f(facing, 1.0));
            cell_albedo[index] = pack_half4(vec4f(saturate(textureLoad(albedo, at.texel, 0).rgb), 0.0));
            cell_emission[index] = pack_half4(vec4f(emitted, 0.0));
            let reflected = within_range(view, textureLoad(radiance, at.texel, 0).rgb);
            let leaving = sh_scaled(reflected, sh_cosine_lobe(facing));
            let keeps = keeps_light(index, ADDS);
            write_light(3u * index, 0u, leaving.r, keeps);
            write_light(3u * index, 1u, leaving.g, keeps);
            write_light(3u * index, 2u, leaving.b, keeps);
        }
        default: {}
    }
}
