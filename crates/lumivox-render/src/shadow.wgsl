// Shadow maps of opaque surfaces: depth alone.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> instances: array<mat4x4f>;

@vertex
fn vertex(@builtin(instance_index) instance: u32, @location(0) position: vec3f) -> @builtin(position) vec4f {
    return view.clip_from_world * (instances[instance] * vec4f(position, 1.0));
}
