// One propagation step, one cell per invocation: what six neighbours send through the five far faces of the cell.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> state: array<vec2u>;
@group(0) @binding(2) var<storage, read> geometry: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> next_state: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> accumulated: array<vec4f>;

// Whether blockers hold light back, and whether they reflect it.
override BLOCKS: bool;
override REFLECTS: bool;

const PI: f32 = 3.1415927;
// Solid angles of a neighbour's face opposite to the shared one, and of each of the four beside that, from the middle
// of the sending cell. Six neighbours have the whole sphere.
const FRONT_ANGLE: f32 = 0.4006697;
const SIDE_ANGLE: f32 = 0.4234314;
// The middle of a side face lies in the direction (1, 1/2): its cosines.
const SIDE_AHEAD: f32 = 0.8944272;
const SIDE_ACROSS: f32 = 0.4472136;

// What one band of a neighbour becomes that sends along d, nothing in the way: the flux through each of the five faces, intensity
// times solid angle, leaves as a cosine lobe about that face's direction, added up by hand.
fn unobstructed(sh: vec4f, d: vec3f) -> vec4f {
    let along = dot(sh.yzw, d);
    let front = FRONT_ANGLE * (SH_Y0 * sh.x + SH_Y1 * along);
    let sides = 4.0 * SIDE_ANGLE * (SH_Y0 * sh.x + SH_Y1 * SIDE_AHEAD * along);
    let across = 2.0 * SIDE_ANGLE * SH_Y1 * SIDE_ACROSS * (sh.yzw - along * d);
    return vec4f(SH_COS0 * (front + sides), SH_COS1 * (front * d + across)) / PI;
}

fn state_of(index: u32) -> ShRgb {
    return ShRgb(
        unpack_half4(state[3u * index]),
        unpack_half4(state[3u * index + 1u]),
        unpack_half4(state[3u * index + 2u]),
    );
}

// What stands at the face of a cell: means over its four corners.
struct Blocker {
    potential: vec4f,
    albedo: vec3f,
}

fn blocker_at(cell: vec3i, face: u32) -> Blocker {
    let axis = face / 2u;
    let u = abs(FACE_NORMALS[(2u * axis + 2u) % 6u]);
    let v = abs(FACE_NORMALS[(2u * axis + 4u) % 6u]);
    let first = vec3u(vec3f(cell) + max(FACE_NORMALS[face], vec3f(0.0)));
    var blocker = Blocker(vec4f(0.0), vec3f(0.0));
    for (var corner = 0u; corner < 4u; corner++) {
        let place = first + vec3u(f32(corner & 1u) * u + f32(corner >> 1u) * v);
        let stored = geometry[corner_index(grid, place)];
        let potential = unpack_half4(stored.xy);
        blocker.potential += 0.25 * potential;
        blocker.albedo += potential.x * unpack_half4(stored.zw).rgb;
    }
    // The sum of weights is four times the mean.
    blocker.albedo /= max(4.0 * blocker.potential.x, 1e-6);
    return blocker;
}

// Share of the light along `direction` that is held back.
fn held_back(blocker: Blocker, direction: vec3f) -> f32 {
    return saturate(dot(blocker.potential, vec4f(SH_Y0, -SH_Y1 * direction)));
}

fn intensity(sh: ShRgb, direction: vec3f) -> vec3f {
    let basis = vec4f(SH_Y0, SH_Y1 * direction);
    return vec3f(dot(sh.r, basis), dot(sh.g, basis), dot(sh.b, basis));
}

// As `unobstructed`, face by face, without what the blocker holds back. What is below zero passes: held back it would be light
// made.
fn let_through(sh: ShRgb, d: vec3f, blocker: Blocker) -> ShRgb {
    var sum = sh_zero();
    for (var face = 0u; face < 6u; face++) {
        let n = FACE_NORMALS[face];
        let cosine = dot(n, d);
        // The shared face is not crossed again.
        if cosine < -0.5 {
            continue;
        }
        let direction = select(SIDE_AHEAD * d + SIDE_ACROSS * n, d, cosine > 0.5);
        let angle = select(SIDE_ANGLE, FRONT_ANGLE, cosine > 0.5);
        let sent = intensity(sh, direction);
        let passing = sent - held_back(blocker, direction) * max(sent, vec3f(0.0));
        sum = sh_add(sum, sh_scaled(angle / PI * passing, sh_cosine_lobe(n)));
    }
    return sum;
}

// What the blocker sends back of the light that leaves along d: a cosine lobe about its normal.
fn sent_back(sh: ShRgb, d: vec3f, blocker: Blocker) -> ShRgb {
    let facing = blocker.potential.yzw;
    if dot(facing, facing) == 0.0 {
        return sh_zero();
    }
    var flux = vec3f(0.0);
    for (var face = 0u; face < 6u; face++) {
        let n = FACE_NORMALS[face];
        let cosine = dot(n, d);
        if cosine < -0.5 {
            continue;
        }
        let direction = select(SIDE_AHEAD * d + SIDE_ACROSS * n, d, cosine > 0.5);
        let angle = select(SIDE_ANGLE, FRONT_ANGLE, cosine > 0.5);
        flux += angle * held_back(blocker, direction) * max(intensity(sh, direction), vec3f(0.0));
    }
    return sh_scaled(blocker.albedo * flux / PI, sh_cosine_lobe(normalize(facing)));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let cell = vec3i(cell_from_index(grid, index));
    var next = sh_zero();
    for (var face = 0u; face < 6u; face++) {
        let to_neighbor = FACE_NORMALS[face];
        let neighbor_cell = cell + vec3i(to_neighbor);
        var blocker: Blocker;
        if BLOCKS {
            blocker = blocker_at(cell, face);
        }
        if REFLECTS {
            next = sh_add(next, sent_back(state_of(index), to_neighbor, blocker));
        }
        if !cell_in_grid(grid, neighbor_cell) {
            continue;
        }
        let sent = state_of(cell_index(grid, vec3u(neighbor_cell)));
        if BLOCKS {
            next = sh_add(next, let_through(sent, -to_neighbor, blocker));
        } else {
            next.r += unobstructed(sent.r, -to_neighbor);
            next.g += unobstructed(sent.g, -to_neighbor);
            next.b += unobstructed(sent.b, -to_neighbor);
        }
    }
    next_state[3u * index] = pack_half4(next.r);
    next_state[3u * index + 1u] = pack_half4(next.g);
    next_state[3u * index + 2u] = pack_half4(next.b);
    accumulated[3u * index] += next.r;
    accumulated[3u * index + 1u] += next.g;
    accumulated[3u * index + 2u] += next.b;
}
