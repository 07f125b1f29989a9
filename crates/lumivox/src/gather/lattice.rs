//! Light at the points of an [`IrradianceVolume`]: from each, rays all around through the sub-cells, to the surfels that they meet.
//!
//! The directions of a point are the same in each frame, so at rest its light stands still. Points inside of something
//! take the nearest free place around them, up to a spacing away; those that find none stay dark.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::irradiance::{IrradianceVolume, LATTICE, LatticeUniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, OCTAHEDRON, PACK, SH, linear_groups};

use super::{FREE_POINT, MARCH, MET, SEEN, SURFEL, Store};

pub(super) const SHADER: Shader = Shader {
    name: "gather/lattice",
    parts: &[
        GRID,
        FACE,
        PACK,
        SH,
        OCTAHEDRON,
        SURFEL,
        MARCH,
        LATTICE,
        FREE_POINT,
        MET,
        SEEN,
        include_str!("lattice.wgsl"),
    ],
};

#[derive(Debug)]
pub(super) struct Lattice {
    pass: ComputePass,
    uniform: Uniform<LatticeUniform>,
}

impl Lattice {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let uniform = Uniform::new(gpu, "gather/lattice", &bytemuck::Zeroable::zeroed());
        Self { pass: ComputePass::new(gpu, &SHADER, &[]), uniform }
    }

    /// Asks the `slice`-th of `slices` parts of the lattice.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        store: &Store,
        target: &mut IrradianceVolume,
        (rays, slice, slices): (u32, u32, u32),
    ) -> Result<(), GpuError> {
        let uniform = target.part((rays, slice, slices));
        self.uniform.write(gpu, &uniform);
        let [red, green, blue] = &mut target.textures;
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("sky", &store.sky)
            .read("lattice", &self.uniform)
            .read("mask", &store.mask)
            .read("blocks", &store.blocks)
            .read("table", &store.table)
            .read("surfels", &store.surfels)
            .read("shown", &store.shown)
            .write_texture("red", red)
            .write_texture("green", green)
            .write_texture("blue", blue);
        self.pass.record(gpu, encoder, &bindings, linear_groups(uniform.count))
    }
}
