// The texels that a caster has of its own. The shader that uses this binds `map` and `rects`, plain words.

struct Rect {
    low: vec2u,
    width: u32,
    // NO_PLACE if there was no room.
    place: u32,
    area: u32,
}

fn rect_of(caster: u32) -> Rect {
    let first = 8u * caster;
    let low = map.size - vec2u(rects[first], rects[first + 1u]);
    return Rect(low, rects[first + 2u] - low.x, rects[first + 4u], rects[first + 5u]);
}

// Where a texel stands among all, or NO_PLACE.
fn place_of(rect: Rect, texel: vec2u) -> u32 {
    if rect.place == NO_PLACE || rect.area == 0u || any(texel < rect.low) || texel.x - rect.low.x >= rect.width {
        return NO_PLACE;
    }
    let at = texel - rect.low;
    let own = at.y * rect.width + at.x;
    return select(NO_PLACE, rect.place + own, own < rect.area);
}

fn texel_of(rect: Rect, own: u32) -> vec2u {
    return rect.low + vec2u(own % rect.width, own / rect.width);
}
