// What is shown of one surfel per invocation: it goes in even steps from its light of the last turn to that of this one, and is
// there when the next begins.

@group(0) @binding(0) var<uniform> settings: GatherUniform;
@group(0) @binding(1) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(2) var<storage, read> light: array<vec4f>;
@group(0) @binding(3) var<storage, read> shine: array<vec4u>;
@group(0) @binding(4) var<storage, read> smoothed: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> shown: array<vec4u>;

// The part of its way that the light of a surfel goes in a frame that has just moved: nine tenths in seven frames.
const AFTER_MOTION: f32 = 0.3;

// The part of its way that a surfel's light goes in this frame.
fn step_of(age: f32, frames_left: f32) -> f32 {
    if age < NEW {
        return AFTER_MOTION;
    }
    // One that has had one turn at most has no light of another to come from.
    if age <= FIRST_TURN {
        return 1.0;
    }
    // What moves has other sub-cells and other rays in each frame, and with them other grain.
    return min(1.0 / frames_left, mix(1.0, AFTER_MOTION, age - SETTLED));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let place = linear_id(id, workgroups);
    if place >= settings.capacity || surfels[place].x == NO_SURFEL {
        return;
    }
    let radiance = unpack_half4(shine[place].xy);
    let irradiance = unpack_half4(smoothed[place]);
    let step = step_of(light[place].w, frames_to_turn(surfels[place].x / SIDES));
    let before = shown[place];
    shown[place] = vec4u(
        pack_half4(mix(unpack_half4(before.xy), radiance, step)),
        pack_half4(mix(unpack_half4(before.zw), irradiance, step)),
    );
}
