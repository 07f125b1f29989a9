// Puts one surfel per invocation on the list of those that are served in this frame: whose turn it is, that are served early, or
// that have not looked around yet.

struct GrowingList {
    count: atomic<u32>,
    reserved: u32,
    surfels: array<vec2u>,
}

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(2) var<storage, read> light: array<vec4f>;
@group(0) @binding(3) var<storage, read> hits: array<u32>;
@group(0) @binding(4) var<storage, read_write> due: GrowingList;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity || surfels[place].x == NO_SURFEL {
        return;
    }
    let cell = surfels[place].x / SIDES;
    if has_turn(cell) || is_served_early(light[place]) || hits[place * settings.rays] == UNTRACED {
        due.surfels[atomicAdd(&due.count, 1u)] = vec2u(place, cell);
    }
}
