// The surfels of one cell per invocation: those that are new get a place, or those that are no more give theirs back.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<storage, read> normal: array<vec2u>;
@group(0) @binding(2) var<storage, read> mask: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> table: array<u32>;
@group(0) @binding(4) var<storage, read_write> surfels: array<vec4u>;
// Numbers of free places, a stack.
@group(0) @binding(5) var<storage, read_write> free_places: array<u32>;
// The height of the stack, how many surfels found no place on it, and how far places have ever been given out.
@group(0) @binding(6) var<storage, read_write> counts: array<atomic<i32>>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> hits: array<u32>;
@group(0) @binding(9) var<uniform> settings: GatherUniform;

// Gives back or gives out.
override FREES: bool;
override STEADY: f32;
override GRAZING: f32;
// Cosine of the angle that a normal may turn by before its surfel counts as moved.
const STILL: f32 = 0.995;

// Sub-cells at the low and high faces of a cell, per axis.
const X_LOW: u32 = 0x11111111u;
const X_HIGH: u32 = 0x88888888u;
const Y_LOW: u32 = 0x000f000fu;
const Y_HIGH: u32 = 0xf000f000u;

// The sub-cells' neighbours on one side: bit i says whether the neighbour of sub-cell i holds anything. `next` is the cell on
// that side.
fn neighbors(face: u32, own: vec2u, next: vec2u) -> vec2u {
    switch face {
        case 0u: { return ((own >> vec2u(1u)) & vec2u(~X_HIGH)) | ((next & vec2u(X_LOW)) << vec2u(3u)); }
        case 1u: { return ((own << vec2u(1u)) & vec2u(~X_LOW)) | ((next & vec2u(X_HIGH)) >> vec2u(3u)); }
        case 2u: { return ((own >> vec2u(4u)) & vec2u(~Y_HIGH)) | ((next & vec2u(Y_LOW)) << vec2u(12u)); }
        case 3u: { return ((own << vec2u(4u)) & vec2u(~Y_LOW)) | ((next & vec2u(Y_HIGH)) >> vec2u(12u)); }
        case 4u: { return vec2u((own.x >> 16u) | (own.y << 16u), (own.y >> 16u) | (next.x << 16u)); }
        default: { return vec2u((own.x << 16u) | (next.y >> 16u), (own.y << 16u) | (own.x >> 16u)); }
    }
}

// All of `open` that can be reached from its sub-cells in `seed`.
fn flooded(seed: vec2u, open: vec2u) -> vec2u {
    var reached = seed & open;
    // The longest way through 64 sub-cells is much shorter.
    for (var step = 0u; step < 32u; step++) {
        let along_x = ((reached << vec2u(1u)) & vec2u(~X_LOW)) | ((reached >> vec2u(1u)) & vec2u(~X_HIGH));
        let along_y = ((reached << vec2u(4u)) & vec2u(~Y_LOW)) | ((reached >> vec2u(4u)) & vec2u(~Y_HIGH));
        let up = vec2u(reached.x << 16u, (reached.y << 16u) | (reached.x >> 16u));
        let down = vec2u((reached.x >> 16u) | (reached.y << 16u), reached.y >> 16u);
        let grown = (reached | along_x | along_y | up | down) & open;
        if all(grown == reached) {
            break;
        }
        reached = grown;
    }
    return reached;
}

fn mask_at(cell: vec3i) -> vec2u {
    if !cell_in_grid(grid, cell) {
        return vec2u(0u);
    }
    return mask[cell_index(grid, vec3u(cell))];
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    if index >= grid.cell_count {
        return;
    }
    let cell = vec3i(cell_from_index(grid, index));
    let own = mask[index];
    let mean = unpack_half4(normal[index]).xyz;
    let steady = length(mean) > STEADY;
    for (var face = 0u; face < 6u; face++) {
        let outward = FACE_NORMALS[face];
        var normal_here = outward;
        // Before each sub-cell on this side: free or not.
        var free = vec2u(0u);
        if any(own != vec2u(0u)) {
            free = ~neighbors(face, own, mask_at(cell + vec3i(outward)));
        }
        var open = own & free;
        if steady {
            let along = dot(normalize(mean), outward);
            if abs(along) > GRAZING {
                normal_here = sign(along) * normalize(mean);
            } else {
                // The steps of a slanted surface, not a side of its own.
                open = vec2u(0u);
            }
        }
        let first = flooded(one_bit(nth_bit(open, 0u)), free) & open;
        let parts = in_order(index, 2u * face, first, open & ~first);
        keep_place(2u * face, Surfel(true, index, 2u * face, parts.xy, normal_here));
        keep_place(2u * face + 1u, Surfel(true, index, 2u * face + 1u, parts.zw, normal_here));
    }
}

fn bits_before(cell: u32, side: u32) -> vec2u {
    let place = table[SIDES * cell + side];
    if place == NO_SURFEL {
        return vec2u(0u);
    }
    return surfels[place].zw;
}

// The two parts of a side, in the order in which they were there before: what comes to stand between them must not hand the light of
// the one to the other.
fn in_order(cell: u32, side: u32, one: vec2u, other: vec2u) -> vec4u {
    let before = bits_before(cell, side);
    let before_too = bits_before(cell, side + 1u);
    let straight = bit_count(one & before) + bit_count(other & before_too);
    let crossed = bit_count(one & before_too) + bit_count(other & before);
    return select(vec4u(one, other), vec4u(other, one), crossed > straight);
}

// Gives the surfel a place, or its place back.
fn keep_place(side: u32, surfel: Surfel) {
    let wanted = any(surfel.bits != vec2u(0u));
    let at = SIDES * surfel.cell + side;
    let place = table[at];
    if FREES {
        if !wanted && place != NO_SURFEL {
            free_places[atomicAdd(&counts[0], 1)] = place;
            surfels[place] = vec4u(NO_SURFEL);
            table[at] = NO_SURFEL;
        }
        return;
    }
    if !wanted {
        return;
    }
    if place != NO_SURFEL {
        let before = surfels[place];
        surfels[place] = pack_surfel(surfel);
        let face = side / 2u;
        if all((ground(face, before.zw) & ground(face, surfel.bits)) == vec2u(0u)) {
            begin(place);
            return;
        }
        let turned = dot(unpack_surfel(before).normal, surfel.normal) < STILL;
        if (turned || any(before.zw != surfel.bits)) && light[place].w >= SETTLED {
            light[place].w = MOVED;
        }
        return;
    }
    let height = atomicSub(&counts[0], 1);
    if height <= 0 {
        atomicAdd(&counts[0], 1);
        atomicAdd(&counts[1], 1);
        return;
    }
    let given = free_places[height - 1];
    atomicMax(&counts[2], i32(given) + 1);
    surfels[given] = pack_surfel(surfel);
    table[at] = given;
    begin(given);
}

// What the rays of the place's last owner met is none of the new one's.
fn begin(place: u32) {
    light[place] = vec4f(0.0);
    for (var ray = 0u; ray < settings.rays; ray++) {
        hits[place * settings.rays + ray] = UNTRACED;
    }
}

// Where sub-cells stand, seen along their face's axis. A surface that comes forward or goes back stands where it did; one that has
// nothing of that in common is another, such as the ground outside of a block in place of that inside.
fn ground(face: u32, bits: vec2u) -> vec2u {
    switch face / 2u {
        case 0u: {
            let pairs = bits | (bits >> vec2u(1u));
            return (pairs | (pairs >> vec2u(2u))) & vec2u(X_LOW);
        }
        case 1u: {
            let pairs = bits | (bits >> vec2u(4u));
            return (pairs | (pairs >> vec2u(8u))) & vec2u(Y_LOW);
        }
        default: {
            let pairs = bits.x | bits.y;
            return vec2u((pairs | (pairs >> 16u)) & 0xffffu, 0u);
        }
    }
}
