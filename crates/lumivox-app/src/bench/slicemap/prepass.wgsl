// Leaves drawn forward: each fragment asks what is left of the light.

struct Camera {
    clip_from_world: mat4x4f,
    sun: vec4f,
}

@group(0) @binding(0) var<uniform> camera: Camera;

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Fragment {
    return Fragment(camera.clip_from_world * vec4f(position, 1.0), position, normal);
}

@fragment
fn fragment(f: Fragment) -> @location(0) vec4f {
    let facing = abs(dot(normalize(f.normal), camera.sun.xyz));
    return vec4f(facing * lumivox_light_left(f.world), 1.0);
}
