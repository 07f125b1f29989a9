// A ray through the sub-cells. The shader that uses this binds `grid`, `mask` and `blocks`.

// A ray crosses at most the sum of the sides; empty boxes make it far fewer.
const MAX_STEPS: i32 = 4096;

// What ended a ray.
const MET_SUBCELL: u32 = 0u;
const LEFT_GRID: u32 = 1u;
const REACHED_LIMIT: u32 = 2u;

struct March {
    ended: u32,
    // The sub-cell that it met, and the face through which it entered that.
    at: vec3i,
    face: u32,
}

fn subcell_bit(at: vec3i) -> u32 {
    let place = at % SUBCELLS;
    return u32(place.x + 4 * (place.y + 4 * place.z));
}

fn has_bit(bits: vec2u, bit: u32) -> bool {
    return any((bits & one_bit(bit)) != vec2u(0u));
}

// Side of the largest empty box that is known around a sub-cell: a block's, a cell's, its own; 0 if it is filled.
fn empty_side(at: vec3i) -> i32 {
    let cell = at / SUBCELLS;
    let block = cell / BLOCK_CELLS;
    let block_dims = (vec3i(grid.dims) + BLOCK_CELLS - 1) / BLOCK_CELLS;
    let cells = blocks[block.x + block_dims.x * (block.y + block_dims.y * block.z)];
    if all(cells == vec2u(0u)) {
        return SUBCELLS * BLOCK_CELLS;
    }
    if !has_bit(cells, subcell_bit(cell)) {
        return SUBCELLS;
    }
    return select(1, 0, has_bit(mask[cell_index(grid, vec3u(cell))], subcell_bit(at)));
}

// Follows a ray for `limit` times its direction. Origin in sub-cells. What it starts in is left first.
fn march(origin: vec3f, direction: vec3f, limit: f32) -> March {
    let bound = SUBCELLS * vec3i(grid.dims);
    // A ray along an axis, or along a plane as from one surfel to the next, goes forward by nothing on the others.
    let slope = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let forward = slope > vec3f(0.0);
    let inverse = 1.0 / slope;
    var result = March(REACHED_LIMIT, clamp(vec3i(floor(origin)), vec3i(0), bound - 1), 0u);
    var leaving = true;
    for (var step = 0; step < MAX_STEPS; step++) {
        let side = empty_side(result.at);
        if side == 0 && !leaving {
            result.ended = MET_SUBCELL;
            return result;
        }
        leaving = leaving && side == 0;
        let size = max(side, 1);
        let low = result.at & vec3i(-size);
        let high = low + size;
        let exits = (vec3f(select(low, high, forward)) - origin) * inverse;
        let exit = min(exits.x, min(exits.y, exits.z));
        if exit >= limit {
            return result;
        }
        // On the two other axes the ray is still within the box, whatever rounding says.
        result.at = clamp(vec3i(floor(origin + exit * direction)), low, high - 1);
        if exit == exits.x {
            result.at.x = select(low.x - 1, high.x, forward.x);
            result.face = select(0u, 1u, forward.x);
        } else if exit == exits.y {
            result.at.y = select(low.y - 1, high.y, forward.y);
            result.face = select(2u, 3u, forward.y);
        } else {
            result.at.z = select(low.z - 1, high.z, forward.z);
            result.face = select(4u, 5u, forward.z);
        }
        if any(result.at < vec3i(0)) || any(result.at >= bound) {
            result.ended = LEFT_GRID;
            return result;
        }
    }
    return result;
}
