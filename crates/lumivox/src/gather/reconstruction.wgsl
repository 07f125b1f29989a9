// Irradiance of one pixel per invocation, between the surfels around it.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> view: ViewUniform;
@group(0) @binding(2) var depth: texture_2d<f32>;
@group(0) @binding(3) var normal: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> table: array<u32>;
@group(0) @binding(5) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(6) var<storage, read> shown: array<vec4u>;
@group(0) @binding(7) var<storage, read> mask: array<vec2u>;
@group(0) @binding(8) var<storage, read> blocks: array<vec2u>;

// Light from behind a wall must not reach a pixel by interpolation: this much of a surfel's weight is left if the way to it is
// blocked, for pixels to which all ways seem so.
const BLOCKED: f32 = 1e-5;
// The sum of weights from which no surfels farther away are asked.
const ENOUGH: f32 = 1e-3;

// Whether pixels look for what stands between them and a surfel.
override LOOKS: bool;
// Whether the result is the share of the light that comes from surfels which the pixel cannot see.
override LEAKS: bool;
// How much farther off their surfaces pixels and surfels look for each other, in sub-cells.
override LIFT: f32;

// Of the weighted light, what comes from such surfels.
var<private> unseen: vec3f;

// Whether a surfel can be seen from `eye`, in sub-cells: one of its open faces, near its middle.
fn in_sight(surfel: Surfel, eye: vec3f) -> bool {
    let points = bit_count(surfel.bits);
    let corner = subcell_corner(cell_from_index(grid, surfel.cell), nth_bit(surfel.bits, (5u * points) / 8u));
    let way = corner + 0.5 + (0.75 + LIFT) * FACE_NORMALS[surfel.side / 2u] - eye;
    return march(eye, way, 1.0).ended == REACHED_LIMIT;
}

// How much a surfel on `side` counts for a pixel with normal n: one that faces its way, or where none does, as on mouldings finer
// than a cell, any, and least of all those that look the other way.
fn facing_weight(side: u32, surfel: Surfel, n: vec3f, strict: bool) -> f32 {
    let along = dot(surfel.normal, n);
    if !strict {
        return max(0.1 + along, 0.02);
    }
    let axis = n[side / 4u] * select(1.0, -1.0, (side & 2u) != 0u);
    return select(0.0, axis * axis * along * along, axis > 0.03 && along > 0.0);
}

// Weighted irradiance of the surfels in the eight cells around p, as far as they can be seen from `eye`, and the sum of the
// weights.
fn interpolated(p: vec3f, n: vec3f, eye: vec3f, strict: bool, looks: bool) -> vec4f {
    let low = floor(p - 0.5);
    let fraction = p - 0.5 - low;
    var sum = vec4f(0.0);
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let cell = vec3i(low) + vec3i(offset);
        if !cell_in_grid(grid, cell) {
            continue;
        }
        let along = select(1.0 - fraction, fraction, offset == vec3u(1u));
        let near = along.x * along.y * along.z + 1e-4;
        let at = SIDES * cell_index(grid, vec3u(cell));
        for (var side = 0u; side < SIDES; side++) {
            let place = table[at + side];
            if place == NO_SURFEL {
                continue;
            }
            let surfel = unpack_surfel(surfels[place]);
            let facing = facing_weight(side, surfel, n, strict);
            if facing > 0.0 {
                let hidden = (looks || LEAKS) && !in_sight(surfel, eye);
                let weight = near * facing * select(1.0, BLOCKED, looks && hidden);
                let light = weight * unpack_half4(shown[place].zw).rgb;
                unseen += select(vec3f(0.0), light, hidden);
                sum += vec4f(light, weight);
            }
        }
    }
    return sum;
}

// From the surfels that face the surface's way. One in a crease may have none near it; the nearest lie further out.
fn from_facing(p: vec3f, n: vec3f, eye: vec3f, looks: bool) -> vec4f {
    var sum = vec4f(0.0);
    for (var step = 0u; step < 3u && sum.w < ENOUGH; step++) {
        sum += interpolated(p + 0.75 * f32(step) * n, n, eye, true, looks);
    }
    return sum;
}

// Where a pixel looks from. In sub-cells of views, which are here and there two thick, from farther above where that is free.
fn eye_of(p: vec3f, n: vec3f, towards_eye: vec3f) -> vec3f {
    let lifted = 4.0 * p + (0.6 + LIFT) * n;
    if LIFT > 0.0 && is_free(lifted) {
        return lifted;
    }
    return free_point(p, n, towards_eye);
}

// Weighted light, and the sum of the weights.
fn irradiance_at(p: vec3f, n: vec3f, towards_eye: vec3f) -> vec4f {
    let eye = eye_of(p, n, towards_eye);
    var sum = from_facing(p, n, eye, LOOKS);
    // Beside an edge the point may lie level with the sub-cells of its own surface, which then hide all its surfels. Straight
    // above the surface it does not.
    let above = 4.0 * p + 1.2 * n;
    if sum.w < ENOUGH && is_free(above) {
        unseen = vec3f(0.0);
        sum = from_facing(p, n, above, LOOKS);
    }
    if sum.w < ENOUGH {
        sum += interpolated(p, n, eye, false, LOOKS);
    }
    return sum;
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let pixel_depth = textureLoad(depth, texel, 0).r;
    let n = textureLoad(normal, texel, 0).xyz;
    if pixel_depth == view.far_depth || dot(n, n) < 0.25 {
        return vec4f(0.0);
    }
    let world = world_from_texel(view, texel, pixel_depth);
    let nearer = world_from_texel(view, texel, mix(pixel_depth, 1.0 - view.far_depth, 0.5));
    let p = grid_from_world(grid, world);
    let sum = irradiance_at(p, normalize(n), normalize(nearer - world));
    if LEAKS {
        let most = max(sum.r, max(sum.g, sum.b));
        return vec4f(max(unseen.r, max(unseen.g, unseen.b)) / max(most, 1e-12), 0.0, 0.0, 1.0);
    }
    return vec4f(clamp(sum.rgb / max(sum.w, 1e-12), vec3f(0.0), vec3f(HALF_MAX)), 1.0);
}
