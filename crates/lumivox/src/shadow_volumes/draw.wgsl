// The faces of the volumes into the stencil: what of them lies behind the visible surface counts.

struct Fragment {
    @invariant @builtin(position) position: vec4f,
    // Metres along the view, and what to divide them by: infinity is no number.
    @location(0) place: vec2f,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> primitives: array<u32>;
@group(0) @binding(3) var receivers: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Fragment {
    let reference = primitives[index];
    if reference >= SCREEN {
        return Fragment(screen_clip(reference), vec2f(1.0, 0.0));
    }
    let corner = volume_corner(reference, vertices[reference & ~AT_INFINITY].xyz);
    return Fragment(volume_clip(corner), vec2f(dot(volume.distance, corner), corner.w));
}

@fragment
fn fragment_main(f: Fragment) {
    let surface = textureLoad(receivers, vec2u(f.position.xy), 0).r;
    let is_behind = surface >= 0.0 && f.place.x > surface * f.place.y;
    filled(is_behind);
    if !is_behind {
        discard;
    }
}
