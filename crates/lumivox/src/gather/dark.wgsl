// Takes away the direct light of one surfel per invocation, if views are asked for it anew.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> light: array<vec4f>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity {
        return;
    }
    if surfels[place].x == NO_SURFEL {
        return;
    }
    if has_turn(surfels[place].x / SIDES) {
        light[place] = vec4f(0.0, 0.0, 0.0, select(1.0, FIRST_TURN, is_new(light[place])));
    } else if is_new(light[place]) {
        light[place] = vec4f(0.0);
    }
}
