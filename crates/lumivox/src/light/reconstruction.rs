//! Reconstruction (5.5.3, equations 12 to 15): irradiance at each pixel, interpolated between the cells around it, of which
//! only the occupied ones count.
//!
//! The eight cells nearest to the point have trilinear weights; those that are empty, or so buried that no light reaches them,
//! are left out, those whose open faces look elsewhere than the pixel hardly count, and the rest is scaled up. The dot product of the incident light with the clamped cosine about the
//! pixel's normal gives the irradiance.

use crate::gpu::{Bindings, Buffer, FullscreenPass, Gpu, GpuError, Shader, Texture};
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, FULLSCREEN, GRID, PACK, SH, TRANSPORT, VIEW};

pub(super) const SHADER: Shader = Shader {
    name: "light/reconstruction",
    parts: &[GRID, VIEW, PACK, SH, FACE, TRANSPORT, FULLSCREEN, include_str!("reconstruction.wgsl")],
};

/// Format of irradiance targets.
pub const IRRADIANCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

#[derive(Debug)]
pub(super) struct Reconstruction(FullscreenPass);

impl Reconstruction {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(FullscreenPass::new(gpu, &SHADER, IRRADIANCE_FORMAT, false))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        (incident, transport): (&Buffer, &Buffer),
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("incident", incident)
            .read("transport", transport);
        self.0.record(gpu, encoder, &bindings, target, false)
    }
}
