// One ray per invocation: from a point of a surfel through the sub-cells to the surfel that it meets.

@group(0) @binding(0) var<uniform> grid: GridUniform;
@group(0) @binding(1) var<uniform> settings: GatherUniform;
@group(0) @binding(2) var<storage, read> mask: array<vec2u>;
@group(0) @binding(3) var<storage, read> blocks: array<vec2u>;
@group(0) @binding(4) var<storage, read> table: array<u32>;
@group(0) @binding(5) var<storage, read> surfels: array<vec4u>;
@group(0) @binding(6) var<storage, read_write> hits: array<u32>;
@group(0) @binding(7) var<storage, read> due: DueSurfels;

// Number `ray` of directions about the normal, as dense as its cosine.
fn cosine_direction(n: vec3f, ray: u32, turn: f32) -> vec3f {
    let radius = sqrt((f32(ray) + 0.5) / f32(settings.rays));
    let angle = 6.2831853 * fract(f32(ray) * 0.61803399 + turn);
    let side = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.7);
    let u = normalize(cross(side, n));
    let v = cross(n, u);
    return normalize(radius * (cos(angle) * u + sin(angle) * v) + sqrt(max(1.0 - radius * radius, 0.0)) * n);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) workgroups: vec3u) {
    let index = linear_id(id, workgroups);
    let nth = index / settings.rays;
    if nth >= due.count {
        return;
    }
    let place = due.surfels[nth].x;
    let ray = index % settings.rays;
    let surfel = unpack_surfel(surfels[place]);
    // One that is new looks around at once, and then waits for its turn.
    if !has_turn(surfel.cell) && hits[place * settings.rays + ray] != UNTRACED {
        return;
    }
    let seed = SIDES * surfel.cell + surfel.side;
    let direction = cosine_direction(surfel.normal, ray, hashed(seed, 1u));
    // Points in another order than directions, so that near and far rays start everywhere.
    let there = bit_count(surfel.bits);
    let subcell = min(u32(fract(f32(ray) * 0.75487767 + hashed(seed, 2u)) * f32(there)), there - 1u);
    let corner = subcell_corner(cell_from_index(grid, surfel.cell), nth_bit(surfel.bits, subcell));
    // On the open face of the sub-cell; off a slanted surface, whose sub-cells are the steps of a stair.
    let outward = FACE_NORMALS[surfel.side / 2u];
    let off = 0.5 * saturate(20.0 * (1.0 - dot(surfel.normal, outward)));
    let origin = corner + 0.5 + 0.5 * outward + off * surfel.normal;
    let met = march(origin, direction, 1e9);
    var hit = FIRST_SKY_HIT + sky_square(direction);
    if met.ended == MET_SUBCELL {
        hit = surfel_met(met, -direction);
    }
    hits[place * settings.rays + ray] = hit;
}
