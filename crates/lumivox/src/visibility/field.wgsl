// Look-ups in visibility fields, after the part for objects. The shader that uses this binds `fields`, `field_points`, `field_table`, `field_depths`,
// `field_maps`, and `objects`.

struct FieldUniform {
    // First texel of the maps, and of the normals, in their 3D textures.
    maps_origin: vec3u,
    // Maps along x and y of a slice.
    columns: u32,
    normals_origin: vec3u,
    rows: u32,
    normals_columns: u32,
    normals_rows: u32,
    // One of the STORAGE_ and one of the MAPPING_ constants.
    storage: u32,
    mapping: u32,
    // Directions along a side of a map.
    side: u32,
    divisions: u32,
    // Where its points, its table and its depths begin.
    first_point: u32,
    first_cell: u32,
    table_side: u32,
    first_depth: u32,
    has_normals: u32,
    reserved_0: u32,
}

const STORAGE_BYTE: u32 = 0u;
const STORAGE_FLOAT: u32 = 1u;
const STORAGE_BIT: u32 = 2u;
const MAPPING_UNIFORM: u32 = 0u;
const MAPPING_REJECTION: u32 = 1u;
const MAPPING_CONCENTRIC: u32 = 2u;

// Farther than any hit.
const NOTHING: f32 = 1e30;
// The code of a byte that meets nothing; distances over 2 R are kept in one step less.
const BYTE_MISS: u32 = 255u;
const BYTE_STEPS: f32 = 254.0;
// Numbers that divide nothing by zero.
const TINY: f32 = 1e-37;
const FIELD_PI: f32 = 3.1415927;

// A direction of the unit sphere's space in the frame of a sample point: two tangents and the inward normal (Duff et al.
// 2017).
fn local_from_unit(point: vec3f, d: vec3f) -> vec3f {
    let n = -point;
    let s = select(-1.0, 1.0, (bitcast<u32>(n.z) >> 31u) == 0u);
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    let x = vec3f(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
    let y = vec3f(b, s + n.y * n.y * a, -n.y);
    return vec3f(dot(x, d), dot(y, d), dot(n, d));
}

// A direction's point in the unit disk; on its rim for one below the horizon.
fn flattened(local: vec3f) -> vec2f {
    let disk = local.xy;
    return select(disk / max(length(disk), TINY), disk, local.z > 0.0);
}

// The arc tangent of a number from 0 to 1 in eighths of a turn, to 1e-4.
fn octants(x: f32) -> f32 {
    let q = x * x;
    return x * ((1.272239 - 0.408933 * q) + q * q * (0.186230 - 0.049639 * q));
}

fn concentric_inverse(local: vec3f) -> vec2f {
    let disk = flattened(local);
    let a = abs(disk);
    let major = max(a.x, a.y);
    let minor = min(a.x, a.y);
    let radius = sqrt(major * major + minor * minor);
    let along = radius * octants(minor / max(major, TINY));
    let square = select(vec2f(radius, along), vec2f(along, radius), a.x < a.y);
    return 0.5 * select(square, -square, disk < vec2f(0.0)) + 0.5;
}

fn rejection_inverse(local: vec3f, side: f32) -> vec2f {
    let disk = flattened(local);
    let texel = 2.0 / side;
    let centre = floor((disk + 1.0) / texel) * texel + 0.5 * texel - 1.0;
    // A texel whose centre the disk leaves out gives way to one inwards.
    let inwards = disk / max(length(disk), 0.5) * (1.0 - 0.5005 * 1.4142135 * texel);
    return 0.5 * select(inwards, disk, dot(centre, centre) < 1.0) + 0.5;
}

fn uniform_inverse(local: vec3f) -> vec2f {
    let polar = atan2(length(local.xy), local.z);
    return vec2f((atan2(local.y, local.x) + FIELD_PI) / (2.0 * FIELD_PI), polar / (0.5 * FIELD_PI));
}

// The texel of a local unit direction in a map.
fn texel_of(field: FieldUniform, local: vec3f) -> vec2u {
    var unit: vec2f;
    switch field.mapping {
        case MAPPING_UNIFORM: { unit = uniform_inverse(local); }
        case MAPPING_REJECTION: { unit = rejection_inverse(local, f32(field.side)); }
        default: { unit = concentric_inverse(local); }
    }
    return min(vec2u(max(unit, vec2f(0.0)) * f32(field.side)), vec2u(field.side - 1u));
}

// What a field's table knows of a direction: its cell.
fn cell_of(field: FieldUniform, direction: vec3f) -> u32 {
    let a = abs(direction);
    let scale = f32(field.table_side) / (a.x + a.y + a.z);
    let cell = min(vec2u(a.xz * scale), vec2u(field.table_side - 1u));
    return field_table[field.first_cell + cell.x + field.table_side * cell.y];
}

// Number of a corner of the octant that `direction` lies in: hemispheres seen flat are diamonds, numbered row by row.
fn point_number(field: FieldUniform, direction: vec3f, corner: vec2u) -> u32 {
    let negative = (bitcast<vec3u>(direction) >> vec3u(31u)) != vec3u(0u);
    let x = select(i32(corner.x), -i32(corner.x), negative.x);
    let z = select(i32(corner.y), -i32(corner.y), negative.z);
    let m = i32(field.divisions);
    let hemisphere = 2 * m * m + 2 * m + 1;
    let row = z + m;
    let mirrored = min(row, 2 * m - row);
    let from_end = mirrored * mirrored + mirrored;
    let middle = select(hemisphere - 1 - from_end, from_end, z <= 0);
    return u32(middle + x + select(0, hemisphere, negative.y));
}

fn nearest_point(field: FieldUniform, direction: vec3f) -> u32 {
    let cell = cell_of(field, direction);
    return point_number(field, direction, vec2u(cell & 127u, (cell >> 7u) & 127u));
}

// Where a map's texel lies in the texture.
fn placed(origin: vec3u, columns: u32, rows: u32, map: u32, size: vec2u, texel: vec2u) -> vec3u {
    let slice = map / (columns * rows);
    let place = map % (columns * rows);
    let corner = vec2u(place % columns, place / columns) * size;
    return origin + vec3u(corner + texel, slice);
}

// Distance from a sample point along a direction, in radii; NOTHING where nothing is met.
fn rest_at(field: FieldUniform, point: u32, direction: vec3f) -> f32 {
    let local = local_from_unit(field_points[field.first_point + point].xyz, direction);
    let texel = texel_of(field, local);
    let is_bit = field.storage == STORAGE_BIT;
    let size = vec2u(select(field.side, field.side / 32u, is_bit), field.side);
    let stored = vec2u(select(texel.x, texel.x / 32u, is_bit), texel.y);
    let at = placed(field.maps_origin, field.columns, field.rows, point, size, stored);
    let code = textureLoad(field_maps, at, 0).r;
    if field.storage == STORAGE_BYTE {
        return select(f32(code) * (2.0 / BYTE_STEPS), NOTHING, code == BYTE_MISS);
    }
    if is_bit {
        let met = ((code >> (texel.x % 32u)) & 1u) == 1u;
        let cosine = max(local.z, TINY);
        let depth = field_depths[field.first_depth + point];
        return select(NOTHING, min(2.0 * depth / cosine, 2.0 * cosine), met);
    }
    let value = bitcast<f32>(code);
    return select(NOTHING, 2.0 * value, value < 1.0);
}

// The triangle of sample points around a direction, walked to from the one that the table knows.
struct Around {
    corners: array<vec2u, 3>,
    volumes: vec3f,
}

fn octant_corner(field: FieldUniform, corner: vec2u) -> vec3f {
    return field_points[field.first_point + point_number(field, vec3f(1.0), corner)].xyz;
}

fn triangle_at(field: FieldUniform, a: vec3f, i: u32, j: u32, down: bool) -> Around {
    var around: Around;
    around.corners[0] = select(vec2u(i, j), vec2u(i + 1u, j + 1u), down);
    around.corners[1] = select(vec2u(i + 1u, j), vec2u(i, j + 1u), down);
    around.corners[2] = select(vec2u(i, j + 1u), vec2u(i + 1u, j), down);
    let p = octant_corner(field, around.corners[0]);
    let q = octant_corner(field, around.corners[1]);
    let r = octant_corner(field, around.corners[2]);
    around.volumes = vec3f(dot(cross(r, q), a), dot(cross(p, r), a), dot(cross(q, p), a));
    return around;
}

// Steps that are enough for every direction, as on the CPU.
const WALK_STEPS: u32 = 6u;

fn triangle_around(field: FieldUniform, direction: vec3f) -> Around {
    let a = abs(direction);
    let packed = cell_of(field, direction) >> 14u;
    var i = packed & 63u;
    var j = (packed >> 6u) & 63u;
    var down = (packed >> 12u) != 0u;
    var around = triangle_at(field, a, i, j, down);
    for (var step = 0u; step < WALK_STEPS; step++) {
        let v = around.volumes;
        if min(v.x, min(v.y, v.z)) >= 0.0 {
            break;
        }
        // Across the edge that lies opposite to the corner with the least volume, unless the octant ends there.
        let second = v.y <= v.z;
        let first = v.x <= v.y && v.x <= v.z;
        var to = vec2i(i32(i), i32(j));
        if !first {
            let by = select(-1, 1, down);
            to += select(vec2i(0, by), vec2i(by, 0), second);
        }
        let fits = all(to >= vec2i(0)) && u32(to.x + to.y) + select(1u, 0u, down) < field.divisions;
        if !fits {
            break;
        }
        i = u32(to.x);
        j = u32(to.y);
        down = !down;
        around = triangle_at(field, a, i, j, down);
    }
    return around;
}

// Whether three maps answer for a ray from outside, in place of the nearest.
override BLENDED: bool;

// Distance from a point of the unit sphere inwards, in radii.
fn rest_from(field: FieldUniform, point: vec3f, direction: vec3f, blended: bool) -> f32 {
    if !blended {
        return rest_at(field, nearest_point(field, point), direction);
    }
    var around = triangle_around(field, point);
    let inside = max(around.volumes, vec3f(0.0));
    let sum = inside.x + inside.y + inside.z;
    let weights = select(vec3f(1.0, 0.0, 0.0), inside / sum, sum > 0.0);
    var share = 0.0;
    var distance = 0.0;
    for (var corner = 0u; corner < 3u; corner++) {
        let rest = rest_at(field, point_number(field, point, around.corners[corner]), direction);
        let weight = weights[corner];
        share += select(0.0, weight, rest < NOTHING);
        distance += select(0.0, weight * rest, rest < NOTHING);
    }
    return select(NOTHING, distance / share, share >= 0.5);
}

// A ray where an object's bounding sphere is the unit sphere.
struct UnitRay {
    origin: vec3f,
    direction: vec3f,
    // Length that the world's direction has there.
    length: f32,
}

fn unit_ray(object: ObjectUniform, origin: vec3f, direction: vec3f) -> UnitRay {
    let d = (object.unit_from_world * vec4f(direction, 0.0)).xyz;
    let l = length(d);
    return UnitRay((object.unit_from_world * vec4f(origin, 1.0)).xyz, d / l, l);
}

// Those of 32 objects from `first` on that `bits` names and whose spheres a ray meets. Most it does not, and software drivers
// take both sides of a branch, but no turn of a loop that nobody asks for: so these are sorted out before any is looked up.
fn met_spheres(bits: u32, first: u32, origin: vec3f, direction: vec3f) -> u32 {
    let scale = 1.0 / dot(direction, direction);
    var left = bits;
    var met = 0u;
    while left != 0u {
        let bit = firstTrailingBit(left);
        left &= left - 1u;
        let way = objects[first + bit].center - origin;
        let radius = 1.0001 * objects[first + bit].radius;
        let apart = way - max(dot(way, direction) * scale, 0.0) * direction;
        met |= select(0u, 1u << bit, dot(apart, apart) <= radius * radius);
    }
    return met;
}

// A hit of an object: the distance in lengths of the world's direction, or NOTHING; and where to look up its normal.
struct Ahead {
    distance: f32,
    // A point of the sphere and the direction inwards from it.
    point: vec3f,
    direction: vec3f,
}

// What lies ahead of a ray that starts anywhere, on the object too; see `Field::ahead` of lumivox-field.
fn ahead(object: ObjectUniform, origin: vec3f, direction: vec3f) -> Ahead {
    let ray = unit_ray(object, origin, direction);
    let middle = -dot(ray.origin, ray.direction);
    let nearest = ray.origin + middle * ray.direction;
    let height = dot(nearest, nearest);
    var found = Ahead(NOTHING, vec3f(0.0), ray.direction);
    if height > 1.0 {
        return found;
    }
    let half = sqrt(1.0 - height);
    let start = middle - half;
    let exit = middle + half;
    if exit < 0.0 {
        return found;
    }
    let field = fields[object.field];
    let blended = BLENDED && start >= 0.0;
    // First from the entry; if what is met there lies behind, backwards from the exit. A loop, since software drivers would take
    // both turns of a branch.
    found.point = ray.origin + start * ray.direction;
    for (var turn = 0; turn < 2; turn++) {
        let rest = rest_from(field, found.point, found.direction, blended);
        if rest >= NOTHING {
            break;
        }
        let distance = select(exit - rest, start + rest, turn == 0);
        if distance > object.bias || (turn == 0 && start >= 0.0) {
            found.distance = distance / ray.length;
            break;
        }
        found.point = ray.origin + exit * ray.direction;
        found.direction = -ray.direction;
    }
    return found;
}
