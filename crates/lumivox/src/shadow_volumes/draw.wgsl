// The faces of the volumes into the stencil: what of them lies behind the visible surface counts.

struct Fragment {
    @invariant @builtin(position) position: vec4f,
    // Metres along the view, and what to divide them by: infinity is no number.
    @location(0) place: vec2f,
    // How much of the first two corners there is.
    @location(1) weights: vec2f,
}

@group(0) @binding(0) var<uniform> volume: VolumeUniform;
@group(0) @binding(1) var<storage, read> vertices: array<vec4f>;
@group(0) @binding(2) var<storage, read> primitives: array<u32>;
@group(0) @binding(3) var receivers: texture_2d<f32>;

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Fragment {
    let reference = primitives[index];
    if reference >= SCREEN {
        return Fragment(screen_clip(reference), vec2f(1.0, 0.0), vec2f(1.0 / 3.0));
    }
    let corner = volume_corner(reference, vertices[reference & ~AT_INFINITY].xyz);
    let weights = vec2f(f32(index % 3u == 0u), f32(index % 3u == 1u));
    return Fragment(volume_clip(corner), vec2f(dot(volume.distance, corner), corner.w), weights);
}

// Rasterizers round corners to parts of a pixel, and so cover pixels a little beside a triangle. There two faces that share an edge
// cross each other: the nearer would lie behind the farther, and one be counted without the other. So what lies beside a triangle is
// as far away as the nearest point of the edge, which both faces have.
fn place_within(f: Fragment) -> vec2f {
    let x = dpdx(vec4f(f.place, f.weights));
    let y = dpdy(vec4f(f.place, f.weights));
    let last = 1.0 - f.weights.x - f.weights.y;
    var weight = f.weights.x;
    var slope = vec2f(x.z, y.z);
    if f.weights.y < weight {
        weight = f.weights.y;
        slope = vec2f(x.w, y.w);
    }
    if last < weight {
        weight = last;
        slope = -vec2f(x.z + x.w, y.z + y.w);
    }
    let step = -weight / max(dot(slope, slope), 1e-30) * slope;
    // Within, nothing of the slopes is used: beside a horizon they are no numbers.
    return select(f.place, f.place + step.x * x.xy + step.y * y.xy, weight < 0.0);
}

@fragment
fn fragment_main(f: Fragment) {
    let place = place_within(f);
    let surface = textureLoad(receivers, vec2u(f.position.xy), 0).r;
    let is_behind = surface >= 0.0 && place.x > surface * place.y;
    filled(is_behind);
    if !is_behind {
        discard;
    }
}
