// How light leaves a cell through its six faces, and how incoming flux becomes a new distribution.
//
// A cell's state is the flux that leaves it next, as spherical harmonics of its intensity per cell face area: the
// integral over the sphere is the flux in W/m2 (the area of one cell face is the unit of area, so that numbers do not
// depend on the size of the scene).

struct PropagationUniform {
    // Radiance that enters the grid from outside.
    sky: vec3f,
    // Band-1 to band-0 ratio of the lobes that empty cells pass on.
    lobe_ratio: f32,
    // Albedo of all surfaces after the first bounce; below zero where the stored one counts.
    bounce_albedo: f32,
    // What light that is the same from all sides is multiplied by in free space.
    free_space_gain: f32,
    reserved_1: f32,
    reserved_2: f32,
}

const ALL_FACES: u32 = 63u;
const OCCUPIED: u32 = 64u;
// The least bits of a cell of full opacity.
const OPAQUE: u32 = 0xff00u;

// Flux through one face of an empty cell: the projection of a 90-degree cone (equation 11), scaled by 1.138 so that the six
// faces sum to the whole. Constant part sqrt(4 pi) / 6; linear part Y1 * (pi / 2) * 1.138.
const FACE_FLUX0: f32 = 0.5908180;
const FACE_FLUX1: f32 = 0.8735300;
// Band-1 to band-0 ratio of the clamped cosine: sqrt(pi / 3) / (sqrt(pi) / 2).
const COSINE_RATIO: f32 = 1.1547005;

// The ratio of the lobes that surfaces send into empty cells: just so narrow that the face back to the surface gets nothing.
// A narrower one would take light out of the surface that sent it, as a negative echo.
const SURFACE_RATIO: f32 = FACE_FLUX0 / FACE_FLUX1;

// What propagation has to know of a cell.
struct Transport {
    // Unit mean normal; zero where surfaces cancel.
    normal: vec3f,
    // Bits 0 to 5: open faces, those towards a cell that lets light through or out of the grid. Bit 6: occupied. Bits 8 to 15:
    // opacity in steps of 1/255.
    bits: u32,
    albedo: vec3f,
    // Correction of received light where several open faces see the same surface.
    gather: f32,
}

fn pack_transport(t: Transport) -> vec4u {
    return vec4u(
        pack2x16float(t.normal.xy),
        (pack2x16float(vec2f(t.normal.z, 0.0)) & 0xffffu) | (t.bits << 16u),
        pack2x16float(t.albedo.rg),
        pack2x16float(vec2f(t.albedo.b, t.gather)),
    );
}

fn unpack_transport(p: vec4u) -> Transport {
    let blue_gather = unpack2x16float(p.w);
    return Transport(
        vec3f(unpack2x16float(p.x), unpack2x16float(p.y & 0xffffu).x),
        p.y >> 16u,
        vec3f(unpack2x16float(p.z), blue_gather.x),
        blue_gather.y,
    );
}

fn is_open(t: Transport, face: u32) -> bool {
    return (t.bits & (1u << face)) != 0u;
}

fn is_occupied(t: Transport) -> bool {
    return (t.bits & OCCUPIED) != 0u;
}

// Share of light that a cell holds up.
fn opacity(t: Transport) -> f32 {
    return f32(t.bits >> 8u) / 255.0;
}

// Whether light stops in the cell. Else it passes through all or a part of it, and leaves as from an empty one.
fn is_opaque(t: Transport) -> bool {
    return t.bits >= OPAQUE;
}

fn is_buried(t: Transport) -> bool {
    return (t.bits & (OCCUPIED | ALL_FACES)) == OCCUPIED;
}

// The axes that light may leave along, weighted by the normal: zero for closed axes, else |n|, summing to one. A buried
// cell passes light on along its normal through its occupied neighbours.
fn axis_weights(t: Transport) -> vec4f {
    let open = select(t.bits, ALL_FACES, is_buried(t));
    let axis_open = vec3f(
        f32(min(open & 3u, 1u)), f32(min((open >> 2u) & 3u, 1u)), f32(min((open >> 4u) & 3u, 1u)));
    var weights = abs(t.normal) * axis_open;
    var sum = dot(weights, vec3f(1.0));
    if sum < 0.05 {
        weights = axis_open;
        sum = max(dot(weights, vec3f(1.0)), 1.0);
    }
    return vec4f(weights / sum, 1.0 / sum);
}

// Share of one colour band that leaves an occupied cell through `face`. Linear in the light. A surface's cosine lobe leaves wholly
// on its side; where both faces of an axis are open the sign of the linear part decides between them. All
// faces together give all there is.
fn occupied_face_flux(t: Transport, weights: vec4f, face: u32, sh: vec4f) -> f32 {
    let buried = is_buried(t);
    if !(is_open(t, face) || buried) {
        return 0.0;
    }
    let axis = face / 2u;
    let whole = weights[axis] * sh.x * SH_INTEGRAL;
    if !(is_open(t, face ^ 1u) || buried) {
        return whole;
    }
    let along = dot(sh.yzw, FACE_NORMALS[face]) * SH_INTEGRAL / COSINE_RATIO;
    let closed_axis = weights[axis] == 0.0;
    return 0.5 * (whole + select(weights.w * along, 0.0, closed_axis));
}

fn empty_face_flux(face: u32, sh: vec4f) -> f32 {
    return FACE_FLUX0 * sh.x + FACE_FLUX1 * dot(sh.yzw, FACE_NORMALS[face]);
}

// The distribution of a unit flux about a direction with a given band-1 to band-0 ratio.
fn flux_lobe(direction: vec3f, ratio: f32) -> vec4f {
    return SH_Y0 * vec4f(1.0, ratio * direction);
}
