//! Light from the sky on surfels: it comes in by the rays that leave the grid, so it reaches what can see it and nothing else.
//!
//! The sky is 16 x 16 squares of an octahedron unfolded, each with the mean radiance of its directions: for diffuse light that is
//! plenty.

use glam::{Vec2, Vec3};

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, HALF_MAX, OCTAHEDRON, PACK};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/sky light",
    parts: &[GRID, FACE, PACK, OCTAHEDRON, SURFEL, TURN, include_str!("sky_light.wgsl")],
};

/// Squares along a side of the sky.
const SKY_SIDE: u32 = 16;
/// Directions along a side of a square whose mean it takes.
const SAMPLES: u32 = 8;

/// The numbers that both sides spell out.
pub(crate) const CONSTANTS: [(&str, f32); 1] = [("SKY_SIDE", SKY_SIDE as f32)];

#[derive(Debug)]
pub(super) struct SkyLight(ComputePass);

impl SkyLight {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    /// Room for the sky's squares.
    pub(super) fn squares(gpu: &Gpu) -> Result<Buffer, GpuError> {
        Buffer::storage(gpu, "gather/sky", u64::from(SKY_SIDE * SKY_SIDE) * 16)
    }

    /// Fills them.
    pub(super) fn write(gpu: &Gpu, squares: &Buffer, radiance: impl Fn(Vec3) -> Vec3) {
        let fine = SKY_SIDE * SAMPLES;
        let mean = |square: u32| {
            let corner = glam::UVec2::new(square % SKY_SIDE, square / SKY_SIDE) * SAMPLES;
            let samples = (0..SAMPLES * SAMPLES).map(|n| {
                let at = (corner + glam::UVec2::new(n % SAMPLES, n / SAMPLES)).as_vec2() + 0.5;
                radiance(direction_from_octahedron(2.0 * at / fine as f32 - 1.0))
            });
            let sum: Vec3 = samples.sum();
            (sum / (SAMPLES * SAMPLES) as f32).clamp(Vec3::ZERO, Vec3::splat(HALF_MAX)).extend(0.0)
        };
        let values: Vec<[f32; 4]> = (0..SKY_SIDE * SKY_SIDE).map(|n| mean(n).to_array()).collect();
        gpu.queue.write_buffer(&squares.raw, 0, bytemuck::cast_slice(&values));
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Uniform<GatherUniform>,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("settings", settings)
            .read("sky", &store.sky)
            .read("due", &store.due)
            .read("hits", &store.hits)
            .write("sky_light", &mut store.sky_light);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_DUE)
    }
}

/// As `octahedron.wgsl` has it.
fn direction_from_octahedron(p: Vec2) -> Vec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let folded = (1.0 - Vec2::new(p.y, p.x).abs()) * Vec2::new(1.0f32.copysign(p.x), 1.0f32.copysign(p.y));
    let flat = if z >= 0.0 { p } else { folded };
    flat.extend(z).normalize_or_zero()
}
