// The lists of triangles that are drawn: all over the picture, and within runs of layers. Filled twice: first only counted, so that
// `plan` can give each list its place.
//
// Runs are those of a binary tree: list 1 is of all layers, and lists 2n and 2n + 1 are of the halves of list n's. So any run of layers
// is a few of them.
//
// The shader that uses this binds `volume`, `vertices`, `kept`, `lists` and `primitives`.

// False: counts alone.
override EMITS: bool;

// In `lists`: how many triangles each has; where each goes on; how many there were in one list alone; sides in the lists and in
// one; whether the lists are too long, so that all go into one; sides in any list, each once.
const CURSORS: u32 = 256u;
const WHOLE: u32 = 512u;
const SIDES: u32 = 513u;
const WHOLE_SIDES: u32 = 514u;
const TOO_LONG: u32 = 515u;
const KEPT_SIDES: u32 = 516u;

fn push(list: u32, a: u32, b: u32, c: u32) {
    if !EMITS {
        atomicAdd(&lists[list], 1u);
        return;
    }
    let at = atomicAdd(&lists[CURSORS + list], 1u);
    if at < volume.capacity {
        primitives[3u * at] = a;
        primitives[3u * at + 1u] = b;
        primitives[3u * at + 2u] = c;
    }
}

fn push_face(list: u32, corners: vec4u, count: u32) {
    push(list, corners.x, corners.y, corners.z);
    if count == 4u {
        push(list, corners.x, corners.z, corners.w);
    }
}

fn is_kept(caster: u32, layer: u32) -> bool {
    let word = kept[caster * (volume.words + 1u) + 1u + layer / 32u];
    return ((word >> (layer % 32u)) & 1u) != 0u;
}

// The first and last layer that a face touches in the picture; the second before the first if it touches none.
fn layers_of(corners: vec4u, count: u32) -> vec2i {
    if corners.x >= SCREEN {
        return vec2i(0, i32(volume.layers) - 1);
    }
    var points: array<vec3f, 4>;
    for (var n = 0u; n < count; n++) {
        let reference = corners[n];
        let corner = volume_corner(reference, vertices[reference & ~AT_INFINITY].xyz);
        let clip = volume_clip(corner);
        points[n] = vec3f(select(clip.x, -clip.y, volume.axis == 1u), clip.w, clip.z);
    }
    var low = 1e30;
    var high = -1e30;
    for (var n = 0u; n < count; n++) {
        let a = points[n];
        let b = points[(n + 1u) % count];
        if a.z >= 0.0 && a.y <= 0.0 {
            // Infinity in a parallel view: anywhere.
            low = -1e30;
            high = 1e30;
        } else if a.z >= 0.0 {
            low = min(low, a.x / a.y);
            high = max(high, a.x / a.y);
        }
        if (a.z >= 0.0) != (b.z >= 0.0) {
            let p = mix(a, b, a.z / (a.z - b.z));
            low = min(low, p.x / max(p.y, 1e-30));
            high = max(high, p.x / max(p.y, 1e-30));
        }
    }
    // A pixel more on each side.
    let pixels = f32(volume.size[volume.axis]);
    let first = (0.5 * low + 0.5) * pixels - 1.0;
    let last = (0.5 * high + 0.5) * pixels + 1.0;
    if low > high || last < 0.0 || first >= pixels {
        return vec2i(1, 0);
    }
    let ends = vec2u(clamp(vec2f(first, last), vec2f(0.0), vec2f(pixels - 1.0)));
    return vec2i(ends * volume.layers / u32(pixels));
}

// Puts a face into the lists of a run of layers; returns how many these are.
fn push_run(first: u32, last: u32, corners: vec4u, count: u32) -> u32 {
    // The leaves of the tree begin after as many lists as it has.
    var low = first + volume.leaves;
    var end = last + 1u + volume.leaves;
    var times = 0u;
    while low < end {
        if (low & 1u) != 0u {
            push_face(low, corners, count);
            low += 1u;
            times += 1u;
        }
        if (end & 1u) != 0u {
            end -= 1u;
            push_face(end, corners, count);
            times += 1u;
        }
        low /= 2u;
        end /= 2u;
    }
    return times;
}

// Puts a face of a caster's volume into the lists: into that of the whole picture if all layers that it touches are kept, else into
// those of the layers that are.
fn put(caster: u32, corners: vec4u, count: u32, is_side: bool) {
    if !EMITS {
        atomicAdd(&lists[WHOLE], count - 2u);
        if is_side {
            atomicAdd(&lists[WHOLE_SIDES], 1u);
        }
    }
    var times = 0u;
    if volume.culls == 0u || atomicLoad(&lists[TOO_LONG]) != 0u {
        push_face(1u, corners, count);
        times = 1u;
    } else if kept[caster * (volume.words + 1u)] != 0u {
        let layers = layers_of(corners, count);
        var dropped = 0;
        for (var layer = layers.x; layer <= layers.y; layer++) {
            dropped += select(1, 0, is_kept(caster, u32(layer)));
        }
        if dropped == 0 && layers.x <= layers.y {
            push_face(1u, corners, count);
            times = 1u;
        } else {
            var first = layers.x;
            for (var layer = layers.x; layer <= layers.y + 1; layer++) {
                if layer <= layers.y && is_kept(caster, u32(layer)) {
                    continue;
                }
                if first < layer {
                    times += push_run(u32(first), u32(layer - 1), corners, count);
                }
                first = layer + 1;
            }
        }
    }
    if EMITS && is_side {
        atomicAdd(&lists[SIDES], times);
        atomicAdd(&lists[KEPT_SIDES], min(times, 1u));
    }
}
