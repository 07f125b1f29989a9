//! Where triangles are voxelized: the one place that knows which voxelizers there are.

use anyhow::{Result, bail};
use lumivox_voxels::{Model, SparseVolume, VoxelizeError, VoxelizeOptions};
use serde::Serialize;

use super::args::DeviceArg;

/// A chosen device.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Device {
    kind: &'static str,
    threads: usize,
}

impl Device {
    /// The device that was asked for, if it is there.
    pub(super) fn choose(asked: DeviceArg) -> Result<Self> {
        match asked {
            DeviceArg::Gpu => {
                bail!("--device gpu: meshes are voxelized on the CPU alone so far; leave it out")
            }
            DeviceArg::Auto | DeviceArg::Cpu => {
                Ok(Self { kind: "cpu", threads: rayon::current_num_threads() })
            }
        }
    }

    /// The device in words.
    pub(super) fn name(&self) -> String {
        format!("the CPU ({} threads)", self.threads)
    }

    /// Makes the volume.
    pub(super) fn voxelize(
        &self,
        model: &Model<'_>,
        options: &VoxelizeOptions<'_>,
    ) -> Result<SparseVolume, VoxelizeError> {
        lumivox_voxels::voxelize(model, options)
    }
}
