//! The end of a frame by the rule [`LightRule::Stored`](super::LightRule): cells that cleanup has cleared, and that no sample of this frame
//! has reached, lose the light that was stored in them. It comes before attributes are resolved, while the volume holds what
//! cleanup has left.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::{NORMAL, VolumeBuffer};
use crate::wgsl::{GRID, PACK, linear_groups};

use super::DirectLight;

pub(super) const SHADER: Shader =
    Shader { name: "progressive/light_store", parts: &[GRID, PACK, include_str!("light_store.wgsl")] };

/// The stage, and the marks of cells that samples of this frame have reached.
#[derive(Debug)]
pub(super) struct LightStore {
    pass: ComputePass,
    pub(super) reached: Buffer,
}

impl LightStore {
    pub(super) fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        let bytes = volume.grid().cell_count() * size_of::<u32>() as u64;
        let reached = Buffer::storage(gpu, "light store/reached", bytes)?;
        Ok(Self { pass: ComputePass::new(gpu, &SHADER, &[]), reached })
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let groups = linear_groups(volume.grid().cell_count() as u32);
        let normal = volume.channel(NORMAL).ok_or_else(|| super::resolve::wrong_channels(SHADER.name))?;
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("normal", normal)
            .read("reached", &self.reached)
            .write("light", &mut light.sh);
        self.pass.record(gpu, encoder, &bindings, groups)
    }
}
