// Triangles into columns. A fragment is a column and a triangle; drawn conservatively, any column that the box around the triangle
// touches.

@group(0) @binding(0) var<uniform> slicemap: SlicemapUniform;
@group(0) @binding(1) var<storage, read_write> slicemap_bits: array<atomic<u32>>;
// For each column the largest of the inverted nearest distance's bits, and of the farthest's: bits of positive numbers are in order.
@group(0) @binding(2) var<storage, read_write> slicemap_extents: array<atomic<u32>>;

struct Fragment {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) distance: f32,
    @location(2) weights: vec3f,
}

struct Corners {
    world: mat3x3f,
    vertices: vec3u,
}

fn corners(triangle: u32) -> Corners {
    var c: Corners;
    for (var k = 0u; k < 3u; k++) {
        let vertex = lv_index(3u * triangle + k);
        c.vertices[k] = vertex;
        c.world[k] = (mesh.world_from_local * vec4f(lv_local_position(vertex), 1.0)).xyz;
    }
    return c;
}

fn nothing() -> Fragment {
    var f: Fragment;
    f.position = vec4f(2.0, 2.0, 0.5, 1.0);
    return f;
}

@vertex
fn vertex_main(@builtin(vertex_index) index: u32) -> Fragment {
    let drawn = select(3u, 6u, CONSERVATIVE);
    let triangle = batch.first + index / drawn;
    if triangle >= mesh.counts.y {
        return nothing();
    }
    var f: Fragment;
    f.triangle = triangle;
    let c = corners(triangle);
    if !CONSERVATIVE {
        let corner = index % 3u;
        f.position = slicemap.clip_from_world * vec4f(c.world[corner], 1.0);
        f.distance = slicemap_distance(c.world[corner]);
        f.weights[corner] = 1.0;
        return f;
    }
    let box = outline(c.world);
    if box.x > box.z {
        return nothing();
    }
    // Two triangles over the box, a pixel wider on each side than what is asked for.
    let corner = vec2u(0x32u >> (index % 6u), 0x2cu >> (index % 6u)) & vec2u(1u);
    let margin = 2.0 / vec2f(slicemap.size);
    f.position = vec4f(mix(box.xy - margin, box.zw + margin, vec2f(corner)), 0.5, 1.0);
    return f;
}

// The box around what of a triangle lies before the eye, in normalized device coordinates; empty if nothing does.
fn outline(world: mat3x3f) -> vec4f {
    var low = vec2f(1e30);
    var high = vec2f(-1e30);
    for (var k = 0u; k < 3u; k++) {
        let a = slicemap.clip_from_world * vec4f(world[k], 1.0);
        let b = slicemap.clip_from_world * vec4f(world[(k + 1u) % 3u], 1.0);
        let least = 1e-6 * max(abs(a.w), abs(b.w));
        if a.w > least {
            low = min(low, a.xy / a.w);
            high = max(high, a.xy / a.w);
        }
        if (a.w > least) != (b.w > least) {
            let p = mix(a, b, (least - a.w) / (b.w - a.w));
            low = min(low, p.xy / p.w);
            high = max(high, p.xy / p.w);
        }
    }
    return vec4f(clamp(low, vec2f(-2.0), vec2f(2.0)), clamp(high, vec2f(-2.0), vec2f(2.0)));
}

// The part of the way from `a` to `b` that lies inside of a side, of which both are given their distances from it.
fn cut(way: vec2f, a: f32, b: f32) -> vec2f {
    if a < 0.0 && b < 0.0 {
        return vec2f(1.0, 0.0);
    }
    let t = a / (a - b);
    return vec2f(select(way.x, max(way.x, t), a < 0.0), select(way.y, min(way.y, t), b < 0.0));
}

// Distances along the view between which a triangle passes through a column, or the second less than the first if it does not: those
// of its edges' parts in the column, and of the column's corners in the triangle.
fn crossed(world: mat3x3f, pixel: vec2u) -> vec2f {
    var points: array<vec4f, 3>;
    for (var k = 0u; k < 3u; k++) {
        let clip = slicemap.clip_from_world * vec4f(world[k], 1.0);
        points[k] = vec4f(clip.xyw, slicemap_distance(world[k]));
    }
    let step = 2.0 / vec2f(slicemap.size);
    let left = f32(pixel.x) * step.x - 1.0;
    let top = 1.0 - f32(pixel.y) * step.y;
    let right = left + step.x;
    let bottom = top - step.y;
    var range = vec2f(1e30, -1e30);
    for (var k = 0u; k < 3u; k++) {
        let a = points[k];
        let b = points[(k + 1u) % 3u];
        var way = cut(vec2f(0.0, 1.0), a.z, b.z);
        way = cut(way, a.x - left * a.z, b.x - left * b.z);
        way = cut(way, right * a.z - a.x, right * b.z - b.x);
        way = cut(way, a.y - bottom * a.z, b.y - bottom * b.z);
        way = cut(way, top * a.z - a.y, top * b.z - b.y);
        if way.x <= way.y {
            let ends = mix(vec2f(a.w), vec2f(b.w), way);
            range = vec2f(min(range.x, min(ends.x, ends.y)), max(range.y, max(ends.x, ends.y)));
        }
    }
    let area = dot(points[0].xyz, cross(points[1].xyz, points[2].xyz));
    for (var n = 0u; n < 4u && area != 0.0; n++) {
        let corner = vec3f(select(left, right, (n & 1u) != 0u), select(bottom, top, (n & 2u) != 0u), 1.0);
        let weights = sign(area) * vec3f(
            dot(cross(points[1].xyz, points[2].xyz), corner),
            dot(cross(points[2].xyz, points[0].xyz), corner),
            dot(cross(points[0].xyz, points[1].xyz), corner),
        );
        if all(weights >= vec3f(0.0)) {
            let distances = vec3f(points[0].w, points[1].w, points[2].w);
            let distance = dot(weights, distances) / (weights.x + weights.y + weights.z);
            range = vec2f(min(range.x, distance), max(range.y, distance));
        }
    }
    return range;
}

fn is_parallel() -> bool {
    return slicemap.clip_from_world[0].w == 0.0 && slicemap.clip_from_world[1].w == 0.0 && slicemap.clip_from_world[2].w == 0.0;
}

// Opacity at a point of a triangle.
fn opacity(c: Corners, weights: vec3f) -> f32 {
    var alpha = mesh.base_color.a;
    if lv_mesh_has(MESH_HAS_COLORS) {
        alpha *= weights.x * lv_color(c.vertices.x).a + weights.y * lv_color(c.vertices.y).a
            + weights.z * lv_color(c.vertices.z).a;
    }
    if lv_mesh_has(MESH_HAS_UVS) && lv_mesh_has(MESH_HAS_TEXTURES) {
        let uv = weights.x * lv_uv(c.vertices.x) + weights.y * lv_uv(c.vertices.y) + weights.z * lv_uv(c.vertices.z);
        alpha *= textureSampleLevel(base_color_texture, material_sampler, uv, 0.0).a;
    }
    return alpha;
}

fn is_hole(c: Corners, weights: vec3f) -> bool {
    return mesh.alpha_cutoff >= 0.0 && opacity(c, weights) < mesh.alpha_cutoff;
}

// Of the point of a triangle that is nearest to where a column's middle meets its plane.
fn weights_in(world: mat3x3f, pixel: vec2u) -> vec3f {
    let uv = (vec2f(pixel) + 0.5) / vec2f(slicemap.size);
    let p = vec3f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 1.0);
    var clip: mat3x3f;
    for (var k = 0u; k < 3u; k++) {
        clip[k] = (slicemap.clip_from_world * vec4f(world[k], 1.0)).xyw;
    }
    let parts = vec3f(dot(cross(clip[1], clip[2]), p), dot(cross(clip[2], clip[0]), p), dot(cross(clip[0], clip[1]), p));
    let inside = max(parts * sign(determinant(clip)), vec3f(0.0));
    let sum = inside.x + inside.y + inside.z;
    return select(vec3f(1.0 / 3.0), inside / sum, sum > 0.0);
}

@fragment
fn fragment_main(f: Fragment, @builtin(front_facing) is_front: bool) {
    let pixel = vec2u(f.position.xy);
    if any(pixel >= slicemap.size) {
        return;
    }
    var range = vec2f(f.distance);
    // A mirrored mesh turns its triangles the other way.
    var faces_camera = is_front == (mesh.side > 0.0);
    if CONSERVATIVE || mesh.alpha_cutoff >= 0.0 {
        let c = corners(f.triangle);
        var weights = f.weights;
        if CONSERVATIVE {
            range = crossed(c.world, pixel);
            if range.x > range.y {
                return;
            }
            weights = weights_in(c.world, pixel);
            let eye = slicemap.eye_from_world;
            let a = (eye * vec4f(c.world[0], 1.0)).xyz;
            let b = (eye * vec4f(c.world[1], 1.0)).xyz;
            let d = (eye * vec4f(c.world[2], 1.0)).xyz;
            let towards = select(-a, vec3f(0.0, 0.0, 1.0), is_parallel());
            faces_camera = (mesh.side * dot(cross(b - a, d - a), towards)) > 0.0;
        }
        if is_hole(c, weights) {
            return;
        }
    }
    range = vec2f(max(range.x, slicemap.near), min(range.y, slicemap.far));
    if range.x > range.y {
        return;
    }
    let column = slicemap_column(pixel);
    if EXTENTS {
        atomicMax(&slicemap_extents[2u * column], ~bitcast<u32>(max(range.x, 0.0)));
        atomicMax(&slicemap_extents[2u * column + 1u], bitcast<u32>(max(range.y, 0.0)));
        return;
    }
    var near = slicemap.near;
    var far = slicemap.far;
    if slicemap.is_local != 0u {
        near = bitcast<f32>(~atomicLoad(&slicemap_extents[2u * column]));
        far = bitcast<f32>(atomicLoad(&slicemap_extents[2u * column + 1u]));
    }
    let first = slicemap_slice(range.x, near, far);
    let last = slicemap_slice(range.y, near, far);
    let bit_set = slicemap.bit_set + select(0u, slicemap.splits_faces, !faces_camera);
    let word = slicemap_word(column, bit_set);
    if !CONSERVATIVE {
        atomicOr(&slicemap_bits[word + first / 32u], one_bit(first));
        return;
    }
    for (var n = first / 32u; n <= last / 32u; n++) {
        let crossed_bits = slicemap_bits_before(32u * n, last + 1u) & ~slicemap_bits_before(32u * n, first);
        atomicOr(&slicemap_bits[word + n], crossed_bits);
    }
}
