//! What can be wrong with what a voxelizer is given.

use crate::gpu::GpuError;

/// Why a mesh or a voxelizer cannot be made. Recording returns plain [`GpuError`]s.
#[derive(Clone, Debug, thiserror::Error)]
pub enum VoxelizeError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A view of a mesh's buffers does not fit.
    #[error("the {what} of a mesh: {reason}")]
    Mesh {
        /// Which attribute.
        what: &'static str,
        /// What does not fit.
        reason: String,
    },
    /// A channel cannot be.
    #[error("channel {name}: {reason}")]
    Channel {
        /// Its name.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// More per cell than there may be.
    #[error("channels of {bits} bits a cell were asked for, there may be {}", super::MAX_CELL_BITS)]
    TooManyBits {
        /// Bits asked for.
        bits: u64,
    },
    /// A method cannot do what is asked of it.
    #[error("{method:?}: {reason}")]
    Method {
        /// Which.
        method: super::Method,
        /// What it cannot do.
        reason: String,
    },
}
