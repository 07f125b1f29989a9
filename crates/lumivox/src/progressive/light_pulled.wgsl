// Light is made anew in each frame: what a cell has is of this frame.
fn keeps_light(index: u32, adds: bool) -> bool {
    return adds;
}
