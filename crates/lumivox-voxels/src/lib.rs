//! Triangles to voxels on the CPU, with every core, for any triangle soup; sparse volumes; and the file formats of the
//! tools that take them.
//!
//! ```
//! use lumivox_core::TriangleView;
//! use lumivox_voxels::{Channel, Coverage, Model, VoxelizeOptions, voxelize};
//!
//! let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let indices = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let model = Model::from(TriangleView { positions: &positions, indices: &indices });
//! let options = VoxelizeOptions {
//!     coverage: Coverage::Thin,
//!     channels: vec![Channel::albedo(), Channel::normal()],
//!     solid: true,
//!     ..VoxelizeOptions::resolution(32)
//! };
//! let volume = voxelize(&model, &options)?;
//! assert!(volume.len() > volume.surface_len());
//! # Ok::<(), lumivox_voxels::VoxelizeError>(())
//! ```
//!
//! - [`voxelize`] takes a [`Model`] of borrowed meshes and [`VoxelizeOptions`], and makes a [`SparseVolume`].
//! - [`Coverage`] says which cells a triangle marks, [`Channel`] what is stored of the surface in a cell.
//! - [`files`] writes the volume for NumPy, MagicaVoxel, OpenVDB and others.
//!
//! Conventions are those of [`lumivox_core`]: right-handed, Y up, metres, linear Rec. 709, cell `(i, j, k)` at index
//! `i + nx * (j + ny * k)`.

mod areas;
mod binning;
mod boundary;
mod cells;
mod channels;
mod coverage;
mod error;
pub mod files;
mod fill;
mod flat;
mod fragment;
mod job;
mod model;
mod options;
mod packet;
mod placement;
mod plan;
mod report;
mod sparse;
mod surface;
mod voxelize;

pub use channels::{Channel, ChannelFn, Format, Rule, SurfacePoint, Values};
pub use coverage::Coverage;
pub use error::VoxelizeError;
pub use model::{Material, MaterialOf, MeshView, Model, TextureFn};
pub use options::{GridSpec, Progress, ProgressFn, Stage, VoxelizeOptions};
pub use plan::check_memory;
pub use report::{Hole, SolidReport, VoxelizeReport};
pub use sparse::{ChannelData, DenseError, SparseBuilder, SparseVolume};
pub use voxelize::voxelize;
