// A value of a channel, added to the sums of a cell from word `at` on. Goes with a shader that declares `view` and `sums`.

fn add(at: u32, value: vec4f, largest: f32) {
    let fixed = vec4i(round(clamp(value, vec4f(-largest), vec4f(largest)) * (view.unit_steps / largest)));
    atomicAdd(&sums[at], fixed.x);
    atomicAdd(&sums[at + 1u], fixed.y);
    atomicAdd(&sums[at + 2u], fixed.z);
    atomicAdd(&sums[at + 3u], fixed.w);
}
