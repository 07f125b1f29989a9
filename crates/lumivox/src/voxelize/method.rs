//! What methods have in common, and what each of them must do.

use super::direct::Direct;
use super::raster::Expansion;
use super::slice_per_pass::SlicePerPass;
use super::slicemap::Slicemap;
use super::text::{Layout, Phase};
use super::{Channel, Mesh, VoxelizeError, clipping, slicing};
use crate::gpu::{Gpu, GpuError};
use lumivox_core::Grid;

/// Which cells a triangle marks; the cells are those of `lumivox-voxels` but for those whose verdict hangs on a
/// ten-thousandth of a cell.
///
/// **Boundaries.** Cells are half-open: along an axis a triangle marks the cells from `floor(min)` to `floor(max)` of its own
/// coordinates. A wall that lies on a cell boundary marks the cells above it alone, and on the grid's upper face the last
/// cells. Between these bounds tests are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coverage {
    /// Every cell that the closed triangle touches. No path of face, edge or corner neighbours leads through the cells of a
    /// closed surface (26-separating).
    #[default]
    Exact = 0,
    /// Schwarz and Seidel's set, through which no path of face neighbours leads (6-separating); about 0.6 times as many cells.
    Thin = 1,
    /// One cell per column along the axis that the triangle faces most, where the line through the column's centre meets
    /// it. Slivers and dust leave gaps.
    Sampled = 2,
}

/// How triangles become cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// One pass over the triangles, any coverage: see [`direct`](super::direct).
    #[default]
    Direct,
    /// Triangles cut into strips, a strip for each slice: see [`slicing`](super::slicing).
    Slicing {
        /// The papers' limit on the vertices that a triangle may become. Without one there are no holes.
        output_vertices: Option<u32>,
    },
    /// Triangles drawn whole into each slice, and clipped by fragment: see [`clipping`](super::clipping).
    Clipping {
        /// The papers' limit on the vertices that a triangle may become, 3 for each slice. Without one there are no holes.
        output_vertices: Option<u32>,
    },
    /// All triangles anew for every slice: see [`slice_per_pass`](super::slice_per_pass).
    SlicePerPass,
    /// A bit per cell from the depth of fragments: see [`slicemap`](super::slicemap).
    Slicemap(Directions),
}

/// The directions that a [`Method::Slicemap`] is seen from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Directions {
    /// All three axes, merged.
    #[default]
    Three,
    /// Only x, y or z (0, 1, 2). Surfaces that are steep along it have gaps, or are missed.
    One(u32),
}

/// What becomes of surfaces with an [`alpha_cutoff`](super::Material::alpha_cutoff): masks such as leaves, and veils. A surface
/// of one opacity below its cutoff is not there, whichever is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeeThrough {
    /// What is below the cutoff in the middle of a piece is a hole, the rest is solid.
    #[default]
    Cut = 0,
    /// A cell takes them as a veil: the fourth number of [`Channel::normal`] is their mean opacity over the area of all surfaces in
    /// the cell, in place of 1, and surfaces without a cutoff make it 1 however small they are, so that no wall lets light through.
    /// Opacity is that of the texture where it is as coarse as the piece: of a mask, the part that is not cut out.
    /// Several veils in one cell count as one.
    Opacity = 1,
    /// A cell is marked by chance, with a number that depends on the cell alone: in cells finer than a mask its holes, in coarser ones
    /// and in veils a pattern that lets through about the same part of light from a hemisphere.
    Dithered = 2,
}

/// Most cells along an axis for the methods that expand triangles: of a batch of the largest there would be more corners than a draw
/// may have.
const MAX_EXPANDED: u32 = 4096;

/// What a [`Voxelizer`](super::Voxelizer) is made for, beside its channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Which cells a triangle marks; methods that know only one take that.
    pub coverage: Coverage,
    /// By how many cells surfaces are moved against their visible side first, so that one on a cell boundary belongs to the
    /// cell behind it; pieces of less than a ten-thousandth of a cell face then do not count, unless the whole triangle is
    /// as small. Zero, or [`SURFACE_SHIFT`](crate::progressive::SURFACE_SHIFT) for volumes that views keep up too.
    pub shift: f32,
    /// What becomes of surfaces with a cutoff.
    pub see_through: SeeThrough,
}

/// Refuses what a method cannot do.
pub(super) fn check(grid: &Grid, channels: &[Channel], options: &Options) -> Result<(), VoxelizeError> {
    let method = options.method;
    let wrong = |reason: String| Err(VoxelizeError::Method { method, reason });
    let side = grid.dims.max_element();
    match method {
        Method::Direct | Method::SlicePerPass => Ok(()),
        Method::Slicing { .. } | Method::Clipping { .. } if side > MAX_EXPANDED => {
            wrong(format!("a grid of {side} cells along an axis was asked for, {MAX_EXPANDED} are possible"))
        }
        Method::Slicing { .. } | Method::Clipping { .. } => Ok(()),
        Method::Slicemap(_) if !channels.is_empty() => {
            wrong(format!("a slicemap holds a bit a cell, and no channels such as {}", channels[0].name()))
        }
        Method::Slicemap(Directions::One(axis)) if axis > 2 => {
            wrong(format!("there is no axis {axis}; 0, 1 and 2 are x, y and z"))
        }
        Method::Slicemap(_) => Ok(()),
    }
}

/// What one recording of a method is about.
pub(crate) struct Job<'a> {
    pub(crate) meshes: &'a [&'a Mesh],
    /// Group 0 for triangles that face x, y or z most, and for all.
    pub(crate) groups: &'a [wgpu::BindGroup; 4],
    /// Group 2, if functions bind anything.
    pub(crate) functions: Option<&'a wgpu::BindGroup>,
    /// Only triangles that face this axis most.
    pub(crate) axis: Option<usize>,
}

/// The stages of a method for one phase: from triangles to occupancy and sums.
pub(crate) trait Stages: std::fmt::Debug + Send + Sync {
    /// Records them. Nothing is cleared; what the meshes mark is added to what is there.
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError>;
}

/// Compiles the stages of a method.
pub(crate) fn stages(
    gpu: &Gpu,
    grid: &Grid,
    layout: &Layout,
    options: &Options,
    phase: Phase,
) -> Result<Box<dyn Stages>, GpuError> {
    let expansion = |geometry| Expansion::new(gpu, grid, layout, options, phase, &geometry);
    Ok(match options.method {
        Method::Direct => Box::new(Direct::new(gpu, grid, layout, options, phase)?),
        Method::Slicing { output_vertices } => Box::new(expansion(slicing::geometry(output_vertices))?),
        Method::Clipping { output_vertices } => Box::new(expansion(clipping::geometry(output_vertices))?),
        Method::SlicePerPass => Box::new(SlicePerPass::new(gpu, grid, layout, options, phase)?),
        Method::Slicemap(directions) => {
            Box::new(Slicemap::new(gpu, grid, layout, options, phase, directions)?)
        }
    })
}
