//! Irradiance at each pixel: the light of all steps, interpolated between the eight cells around the point half a cell before
//! the surface, times the clamped cosine about its normal.
//!
//! What is stored is flux that leaves a cell, what is wanted is flux per area. Light without direction sends a sixth of a
//! cell's flux through each face, and the cosine lobe counts a quarter, so irradiance is two thirds of it.

use crate::gpu::{Bindings, Buffer, FullscreenPass, Gpu, GpuError, Shader, Texture};
use crate::light::IRRADIANCE_FORMAT;
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{FULLSCREEN, GRID, PACK, SH, VIEW};

use super::HALF_CELL;

pub(super) const SHADER: Shader = Shader {
    name: "lpv/reconstruction",
    parts: &[GRID, VIEW, PACK, SH, FULLSCREEN, include_str!("reconstruction.wgsl")],
};

#[derive(Debug)]
pub(super) struct Reconstruction(FullscreenPass);

impl Reconstruction {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let constants = [("HALF_CELL", HALF_CELL)];
        Self(FullscreenPass::with_constants(gpu, &SHADER, IRRADIANCE_FORMAT, false, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, accumulated): (&VolumeBuffer, &Buffer),
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("accumulated", accumulated);
        self.0.record(gpu, encoder, &bindings, target, false)
    }
}
