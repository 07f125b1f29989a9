// Which surfels lie beside another on the same surface. The shader that uses this binds `grid`, `mask`, `blocks`, `table` and `surfels`.

// Cosine between the normals of surfels that may take after each other.
const ALIKE: f32 = 0.7;
// Places of the table around a cell: its 27 cells, two for a face.
const PLACES_AROUND: u32 = 54u;

// A point just off the middle of a surfel, in sub-cells.
fn point_before(surfel: Surfel) -> vec3f {
    let corner = subcell_corner(cell_from_index(grid, surfel.cell), nth_bit(surfel.bits, bit_count(surfel.bits) / 2u));
    return corner + 0.5 + 0.75 * FACE_NORMALS[surfel.side / 2u];
}

// What is at one of the places around a surfel, on its own side of the cells.
fn place_around(surfel: Surfel, n: u32) -> u32 {
    let here = vec3i(cell_from_index(grid, surfel.cell));
    let offset = vec3i(vec3u((n / 2u) % 3u, (n / 6u) % 3u, n / 18u)) - 1;
    if !cell_in_grid(grid, here + offset) {
        return NO_SURFEL;
    }
    return table[SIDES * cell_index(grid, vec3u(here + offset)) + 2u * (surfel.side / 2u) + (n & 1u)];
}

// The way from a surfel to another beside it, in sub-cells.
fn way_beside(surfel: Surfel, other: Surfel) -> vec3f {
    let point = point_before(surfel);
    // Where a surface has come forward the others' points lie in it by now; they are looked for at its level.
    let outward = FACE_NORMALS[surfel.side / 2u];
    let behind = max(dot(point - point_before(other), outward), 0.0);
    return point_before(other) + behind * outward - point;
}

// Whether nothing stands on that way.
fn sees_beside(surfel: Surfel, way: vec3f) -> bool {
    return march(point_before(surfel), way, 1.0).ended == REACHED_LIMIT;
}
