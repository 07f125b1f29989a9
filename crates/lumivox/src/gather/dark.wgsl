// Takes away the direct light of one surfel per invocation, if views are asked for it anew.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> light: array<vec4f>;

// How far a surfel is after a turn.
fn after_turn(age: f32) -> f32 {
    if age > SETTLED {
        return max(age - CALMING, SETTLED);
    }
    if age < NEW {
        return MOVED;
    }
    return select(SETTLED, FIRST_TURN, age < FIRST_TURN);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity || surfels[place].x == NO_SURFEL {
        return;
    }
    let before = light[place];
    let cell = surfels[place].x / SIDES;
    if has_turn(cell) {
        light[place] = vec4f(0.0, 0.0, 0.0, after_turn(before.w));
    } else if before.w == INHERITED || before.w == NEW || (before.w < FIRST_TURN && has_early_turn(cell)) {
        light[place] = vec4f(0.0, 0.0, 0.0, select(NEW_ASKED, INHERITED_ASKED, before.w < NEW));
    } else if before.w < FIRST_TURN {
        light[place].w = select(NEW_WAITS, INHERITED_WAITS, before.w < NEW);
    }
}
