// Whose turn it is. Surfels take turns in runs of cells, which the golden ratio scatters evenly over a circle; each frame takes the part
// of the circle that follows the last frame's. So all get one turn in each round, whatever the parts were. By cells, not by
// places: these are given out in no order, and the same frames shall make the same picture.

const TURN_RUN: u32 = 16u;

// How far ahead on the circle a cell is; less than this frame's share means now.
fn ahead(cell: u32) -> u32 {
    return (cell / TURN_RUN) * 2654435769u - settings.phase;
}

fn has_turn(cell: u32) -> bool {
    return settings.share == 0xffffffffu || ahead(cell) < settings.share;
}

// Frames until the cell's next turn, this one included.
fn frames_to_turn(cell: u32) -> f32 {
    if settings.frames_left > 0u {
        return f32(settings.frames_left);
    }
    let way = f32(ahead(cell)) + select(0.0, 4294967296.0, has_turn(cell));
    return max(floor(way / f32(settings.share)), 1.0);
}

// The fourth number of a surfel's light says how far it is.
// No turn yet, and the light of its neighbors: no view has been asked, views are asked in this frame, or it waits.
const INHERITED: f32 = -1.0;
const INHERITED_ASKED: f32 = -0.5;
const INHERITED_WAITS: f32 = -0.25;
// The same without a neighbor to take after.
const NEW: f32 = 0.0;
const NEW_ASKED: f32 = 0.125;
const NEW_WAITS: f32 = 0.25;
// One turn.
const FIRST_TURN: f32 = 0.5;
// More turns. Above it: has moved so lately.
const SETTLED: f32 = 1.0;
const MOVED: f32 = 2.0;
// What a turn takes of that: then it is as if it had always been here.
const CALMING: f32 = 0.125;

// How often those without a turn are served in a round. More is sooner right where much is new at once, and costs as much more then.
const EARLY_TURNS: u32 = 4u;

// Whether a surfel that has had no turn yet is served in this frame too, once it has been asked and traced.
fn has_early_turn(cell: u32) -> bool {
    return ahead(cell) % (0xffffffffu / EARLY_TURNS + 1u) < settings.share;
}

// A surfel that has had no turn yet is served in the frame in which it comes, in the next with views, and then in early turns.
fn is_served_early(light: vec4f) -> bool {
    return light.w < FIRST_TURN && light.w != INHERITED_WAITS && light.w != NEW_WAITS;
}

// The surfels that are served in a frame.
struct DueSurfels {
    count: u32,
    reserved: u32,
    // Their places and their cells, in no order.
    surfels: array<vec2u>,
}
