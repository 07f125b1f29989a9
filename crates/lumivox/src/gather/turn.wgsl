// Whose turn it is. Surfels take turns in runs of 64, which the golden ratio scatters evenly over a circle; each frame takes the part
// of the circle that follows the last frame's. So all get one turn in each round, whatever the parts were.

const TURN_RUN: u32 = 64u;
// Every how many rays a surfel traces at once when it is new, before its first turn.
const FIRST_RAYS: u32 = 8u;

// How far ahead on the circle a surfel is; less than this frame's share means now.
fn ahead(place: u32) -> u32 {
    return (place / TURN_RUN) * 2654435769u - settings.phase;
}

fn has_turn(place: u32) -> bool {
    return settings.share == 0xffffffffu || ahead(place) < settings.share;
}

// Frames until the surfel's next turn, this one included.
fn frames_to_turn(place: u32) -> f32 {
    if settings.frames_left > 0u {
        return f32(settings.frames_left);
    }
    let way = f32(ahead(place)) + select(0.0, 4294967296.0, has_turn(place));
    return max(floor(way / f32(settings.share)), 1.0);
}

// A surfel that has had no turn yet, by the fourth number of its light: it is served in each frame until it has.
fn is_new(light: vec4f) -> bool {
    return light.w == 0.0;
}
