// The mean of the values of a channel that were added to a cell. Goes with a shader that declares `view` and `sums`.

fn mean(at: u32, count: f32, largest: f32) -> vec4f {
    let sum = vec4i(sums[at], sums[at + 1u], sums[at + 2u], sums[at + 3u]);
    return vec4f(sum) / (count * (view.unit_steps / largest));
}
