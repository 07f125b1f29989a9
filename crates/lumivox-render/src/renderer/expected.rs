//! The volume that there would be if all surfaces had been seen, to show which have not.

use lumivox::VolumeBuffer;
use lumivox::gpu::{Gpu, GpuError, StageTimer};
use lumivox::progressive::CHANNELS;
use lumivox_scene::{Pose, Scene};

use super::RendererError;
use crate::gpu_scene::GpuScene;
use crate::material_textures::MaterialTextures;
use crate::triangle_voxelizer::TriangleVoxelizer;

/// All surfaces of the scene's triangles, over the grid of the volume that views fill.
#[derive(Debug)]
pub(super) struct Expected {
    triangles: TriangleVoxelizer,
    volume: VolumeBuffer,
}

impl Expected {
    pub(super) fn new(
        gpu: &Gpu,
        scenes: (&Scene, &Scene),
        uploaded: (&GpuScene, &MaterialTextures),
        of: &VolumeBuffer,
    ) -> Result<Self, RendererError> {
        let volume = VolumeBuffer::new(gpu, *of.grid(), &CHANNELS)?;
        Ok(Self { triangles: TriangleVoxelizer::new(gpu, scenes, uploaded, &volume, false)?, volume })
    }

    pub(super) fn set_pose(&mut self, gpu: &Gpu, pose: &Pose) {
        self.triangles.set_pose(gpu, pose);
    }

    /// Follows what has moved.
    pub(super) fn record(&mut self, gpu: &Gpu, timer: &mut StageTimer) -> Result<(), GpuError> {
        let Self { triangles, volume } = self;
        if !triangles.is_stale() {
            return Ok(());
        }
        triangles.make_layers(gpu)?;
        timer.stage(gpu, "debug/expected", |e| triangles.record(gpu, e, volume, None))
    }

    pub(super) fn volume(&self) -> &VolumeBuffer {
        &self.volume
    }
}
