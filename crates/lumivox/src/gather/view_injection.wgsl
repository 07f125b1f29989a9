// Injection of sub-cells: those of its cell that the surface at one point of a view goes through.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read_write> subcells: array<atomic<u32>>;

override SURFACE_SHIFT: f32;

// Distance to the next points of the view along the surface, in sub-cells.
fn spacing(texel: vec2u, recorded: f32, n: vec3f) -> f32 {
    let step = vec2f(view.size) / vec2f(view.points);
    let here = world_from_texel(view, texel, recorded);
    let beside = length(world_from_texel(view, texel + vec2u(1u, 0u), recorded) - here) * max(step.x, step.y);
    // The farther the surface is turned away, the wider they lie.
    let ahead = normalize(lifted(view, vec2f(0.0), 0.3) - lifted(view, vec2f(0.0), 0.7));
    return 4.0 * beside / (grid.cell_size * max(abs(dot(ahead, n)), 0.1));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= view.points.x * view.points.y {
        return;
    }
    let point = surface_point(grid, view, depth, normal, index, SURFACE_SHIFT);
    if !point.exists {
        return;
    }
    let recorded = textureLoad(depth, point.texel, 0).r;
    let world = world_from_texel(view, point.texel, recorded);
    let cell = cell_from_index(grid, point.cell_index);
    // In sub-cells from the cell's corner.
    let p = 4.0 * (grid_from_world(grid, world) - SURFACE_SHIFT * point.normal - vec3f(cell));
    // The surface goes on as far as half way to the next points: all of it, where points are as dense as sub-cells.
    let reach = clamp(0.75 * spacing(point.texel, recorded, point.normal), 0.75, 4.0);
    let steepest = max(abs(point.normal.x), max(abs(point.normal.y), abs(point.normal.z)));
    var bits = vec2u(0u);
    // Along the axis that the surface faces most, each column of sub-cells meets its plane once.
    for (var column = 0u; column < 16u; column++) {
        let u = f32(column & 3u) + 0.5;
        let v = f32(column >> 2u) + 0.5;
        var q: vec3f;
        if abs(point.normal.x) == steepest {
            q = vec3f(p.x - ((u - p.y) * point.normal.y + (v - p.z) * point.normal.z) / point.normal.x, u, v);
        } else if abs(point.normal.y) == steepest {
            q = vec3f(u, p.y - ((u - p.x) * point.normal.x + (v - p.z) * point.normal.z) / point.normal.y, v);
        } else {
            q = vec3f(u, v, p.z - ((u - p.x) * point.normal.x + (v - p.y) * point.normal.y) / point.normal.z);
        }
        let away = q - p;
        if all(q >= vec3f(0.0)) && all(q < vec3f(4.0)) && dot(away, away) <= reach * reach {
            let place = vec3u(q);
            bits |= one_bit(place.x + 4u * (place.y + 4u * place.z));
        }
    }
    // The point's own sub-cell, in any case.
    let own = vec3u(clamp(p, vec3f(0.0), vec3f(3.99)));
    bits |= one_bit(own.x + 4u * (own.y + 4u * own.z));
    atomicOr(&subcells[2u * point.cell_index], bits.x);
    atomicOr(&subcells[2u * point.cell_index + 1u], bits.y);
}
