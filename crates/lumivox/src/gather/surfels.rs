//! The surfels: which sides the surface in a cell has, by its sub-cells.
//!
//! A sub-cell is open on a side where its neighbour is empty; a cell has a surfel on each side on which any of its sub-cells is.
//! Where the normals in a cell agree, the surfel takes their mean, and sides that the mean only grazes are the steps of
//! a slanted surface and get none. Elsewhere, in corners and in thin walls, a surfel faces straight along its axis.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::{NORMAL, VolumeBuffer};
use crate::wgsl::{FACE, GRID, OCTAHEDRON, PACK, linear_groups};

use super::{GatherUniform, SURFEL, Store, TURN};

pub(super) const SHADER: Shader = Shader {
    name: "gather/surfels",
    parts: &[GRID, PACK, FACE, OCTAHEDRON, SURFEL, TURN, include_str!("surfels.wgsl")],
};

/// Length of a mean normal from which all surfaces of the cell count as one; two at right angles have 0.71.
const STEADY: f64 = 0.9;
/// Cosine between that normal and a side, below which the side is none.
const GRAZING: f64 = 0.35;

#[derive(Debug)]
pub(super) struct Surfels(ComputePass);

impl Surfels {
    /// The pass that gives out places, or the one that gives back those of surfels that are no more, which follows: so what is new can
    /// look at what was there.
    pub(super) fn new(gpu: &Gpu, frees: bool) -> Self {
        let constants = [("FREES", f64::from(u8::from(frees))), ("STEADY", STEADY), ("GRAZING", GRAZING)];
        Self(ComputePass::new(gpu, &SHADER, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, settings): (&VolumeBuffer, &Uniform<GatherUniform>),
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("normal", volume.require(SHADER.name, NORMAL)?)
            .read("mask", &store.mask)
            .write("table", &mut store.table)
            .write("surfels", &mut store.surfels)
            .write("free_places", &mut store.free_places)
            .write("counts", &mut store.counts)
            .write("light", &mut store.light)
            .write("hits", &mut store.hits)
            .read("settings", settings);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
