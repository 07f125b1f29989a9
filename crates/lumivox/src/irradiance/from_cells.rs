//! Light that a method keeps in each cell, to the points of an irradiance volume: the mean over the cells around a point.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, PACK, SH, TRANSPORT, linear_groups};

use super::{IrradianceVolume, LATTICE, LatticeUniform};

/// From propagated light, of empty cells where there are any.
pub(crate) const PROPAGATED: Shader = Shader {
    name: "irradiance/from propagated",
    parts: &[
        GRID,
        PACK,
        SH,
        FACE,
        TRANSPORT,
        LATTICE,
        include_str!("from_cells.wgsl"),
        include_str!("from_propagated.wgsl"),
    ],
};
/// From light propagation volumes, which know no surfaces.
pub(crate) const LPV: Shader = Shader {
    name: "irradiance/from lpv",
    parts: &[GRID, PACK, SH, LATTICE, include_str!("from_cells.wgsl"), include_str!("from_lpv.wgsl")],
};

#[derive(Debug)]
pub(crate) struct FromCells {
    pass: ComputePass,
    uniform: Uniform<LatticeUniform>,
}

impl FromCells {
    pub(crate) fn new(gpu: &Gpu, shader: &'static Shader) -> Self {
        let uniform = Uniform::new(gpu, "irradiance/part", &bytemuck::Zeroable::zeroed());
        Self { pass: ComputePass::new(gpu, shader, &[]), uniform }
    }

    /// `light`: three bands of four coefficients for each cell. `transport`: what is known of cells, if that is asked for.
    pub(crate) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, light, transport): (&VolumeBuffer, &Buffer, Option<&Buffer>),
        target: &mut IrradianceVolume,
        part: (u32, u32, u32),
    ) -> Result<(), GpuError> {
        let uniform = target.part(part);
        self.uniform.write(gpu, &uniform);
        let [red, green, blue] = &mut target.textures;
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("lattice", &self.uniform)
            .read("light", light)
            .write_texture("red", red)
            .write_texture("green", green)
            .write_texture("blue", blue);
        let bindings = match transport {
            Some(transport) => bindings.read("transport", transport),
            None => bindings,
        };
        self.pass.record(gpu, encoder, &bindings, linear_groups(uniform.count))
    }
}
