//! The nearest depth of blocks of a view's texels: what the rule [`Footprint`](super::CleanupRule::Footprint) looks wide
//! footprints up in.
//!
//! Level `k` holds blocks of `2^k` texels a side, as many as the picture needs, cut off at its border. The picture
//! itself is level 0. Pictures of any size share one buffer per size.
//!
//! | words | hold |
//! | --- | --- |
//! | 0 to 15 | where each level begins |
//! | then | the levels, row by row |

use glam::UVec2;

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Texture, Uniform};
use crate::wgsl::{VIEW, ViewUniform};

pub(super) const SHADER: Shader =
    Shader { name: "progressive/nearest", parts: &[VIEW, include_str!("nearest.wgsl")] };

/// Levels that one pass makes.
const PER_PASS: u32 = 3;
/// Words before the first level.
const HEADER: u32 = 16;
/// Footprints of up to 2^3 texels are looked at texel by texel, twice as wide ones in blocks of two.
const FINE_LOG2: u32 = 3;

#[derive(Debug)]
pub(super) struct NearestDepth {
    passes: Vec<ComputePass>,
    made: Vec<(UVec2, Buffer)>,
}

/// Passes for a picture of this size.
fn pass_count(size: UVec2) -> u32 {
    let longest = size.max_element().max(1) - 1;
    let bits = u32::BITS - longest.leading_zeros();
    bits.saturating_sub(FINE_LOG2).div_ceil(PER_PASS)
}

impl NearestDepth {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let largest = gpu.device.limits().max_texture_dimension_2d;
        let pass = |n| ComputePass::new(gpu, &SHADER, &[("FROM", f64::from(PER_PASS * n))]);
        Self { passes: (0..pass_count(UVec2::splat(largest))).map(pass).collect(), made: Vec::new() }
    }

    /// Makes the levels of a view. Room for pictures of a size is made the first time.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, depth): (&Uniform<ViewUniform>, &Texture),
    ) -> Result<&Buffer, GpuError> {
        let size = UVec2::from(depth.size());
        let n = match self.made.iter().position(|(s, _)| *s == size) {
            Some(n) => n,
            None => {
                self.made.push((size, levels(gpu, size)?));
                self.made.len() - 1
            }
        };
        let levels = &mut self.made[n].1;
        for (n, pass) in self.passes.iter().take(pass_count(size) as usize).enumerate() {
            let side = PER_PASS * (n as u32 + 1);
            let groups = |texels: u32| texels.div_ceil(1 << side).div_ceil(8);
            let bindings = Bindings::new().read("view", view).read("depth", depth).write("levels", levels);
            pass.record(gpu, encoder, &bindings, [groups(size.x), groups(size.y), 1])?;
        }
        Ok(levels)
    }
}

fn levels(gpu: &Gpu, size: UVec2) -> Result<Buffer, GpuError> {
    let mut header = [0; HEADER as usize];
    let mut words = HEADER;
    let last = PER_PASS * pass_count(size);
    for (level, start) in (0..=last).zip(&mut header) {
        *start = words;
        if level > 0 {
            words += size.x.div_ceil(1 << level) * size.y.div_ceil(1 << level);
        }
    }
    let levels = Buffer::storage(gpu, "progressive/nearest", 4 * u64::from(words))?;
    gpu.queue.write_buffer(&levels.raw, 0, bytemuck::cast_slice(&header));
    Ok(levels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_levels_for_the_widest_footprint() {
        for size in [1, 2, 8, 9, 64, 65, 100, 512, 513, 8192] {
            // The level that a footprint as wide as the picture is looked up in.
            let across: u32 = size - 1;
            let bits = u32::BITS - across.leading_zeros();
            let level = bits.saturating_sub(FINE_LOG2);
            let made = PER_PASS * pass_count(UVec2::new(size, 1));
            assert!(made >= level && made < level + PER_PASS, "{size}: {made} levels for {level}");
            assert!(made < HEADER);
            assert!(across >> level < 8);
        }
    }
}
