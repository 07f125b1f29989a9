//! One step of propagation: every cell gathers what its six neighbours send through its five far faces, thirty fluxes in all.
//!
//! From the middle of the sending cell a neighbour's far faces have solid angles that depend on the face alone: 0.4007 sr for
//! the opposite one and 0.4234 sr for each of the four at its sides. Six neighbours together have `4 pi`. The
//! intensity towards a face's middle times its solid angle is the flux through the face, and this leaves as a new cosine lobe
//! about the face's direction.
//!
//! Blockers stand between cells: the potential at the shared face is the mean of its four corners, and `1 - B` of
//! each of the five fluxes passes.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, PACK, SH, linear_groups};

use super::{Blocking, GEOMETRY};

pub(super) const SHADER: Shader = Shader {
    name: "lpv/propagation",
    parts: &[GRID, PACK, SH, FACE, GEOMETRY, include_str!("propagation.wgsl")],
};

#[derive(Debug)]
pub(super) struct Propagation(ComputePass);

impl Propagation {
    pub(super) fn new(gpu: &Gpu, blocking: Blocking) -> Self {
        let blocks = if blocking == Blocking::None { 0.0 } else { 1.0 };
        let reflects = if blocking == Blocking::Reflecting { 1.0 } else { 0.0 };
        Self(ComputePass::new(gpu, &SHADER, &[("BLOCKS", blocks), ("REFLECTS", reflects)]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, geometry): (&VolumeBuffer, &Buffer),
        state: &Buffer,
        (next_state, accumulated): (&mut Buffer, &mut Buffer),
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("state", state)
            .read("geometry", geometry)
            .write("next_state", next_state)
            .write("accumulated", accumulated);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
