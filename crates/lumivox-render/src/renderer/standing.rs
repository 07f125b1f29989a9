//! What stands still, of triangles, in a volume that views fill: [`VoxelSource::Hybrid`](super::VoxelSource::Hybrid).

use lumivox::VolumeBuffer;
use lumivox::gpu::{Gpu, GpuError, StageTimer};
use lumivox::progressive::StaticCells;
use lumivox::wgpu::CommandEncoder;
use lumivox_scene::{Pose, Scene};

use super::RendererError;
use super::indirect::Indirect;
use crate::gpu_scene::GpuScene;
use crate::material_textures::MaterialTextures;
use crate::triangle_voxelizer::TriangleVoxelizer;

#[derive(Debug)]
pub(super) struct Standing {
    triangles: TriangleVoxelizer,
    cells: StaticCells,
}

impl Standing {
    /// Of a scene that will move by a clip.
    pub(super) fn new(
        gpu: &Gpu,
        (scene, panels): (&Scene, &Scene),
        uploaded: (&GpuScene, &MaterialTextures),
        (volume, gathers): (&VolumeBuffer, bool),
        clip: Option<usize>,
    ) -> Result<Self, RendererError> {
        let mut triangles = TriangleVoxelizer::new(gpu, (scene, panels), uploaded, volume, gathers)?;
        if let Some(clip) = clip {
            triangles.set_moving(&scene.moving_instances(clip));
        }
        Ok(Self { triangles, cells: StaticCells::new(gpu, *volume.grid())? })
    }

    pub(super) fn set_pose(&mut self, gpu: &Gpu, pose: &Pose) {
        self.triangles.set_pose(gpu, pose);
    }

    pub(super) fn set_panels(&mut self, gpu: &Gpu, panels: &Scene) {
        self.triangles.set_panels(gpu, panels);
    }

    /// Voxelizes it, the first time and when some of it has moved after all.
    pub(super) fn voxelize(&mut self, gpu: &Gpu, timer: &mut StageTimer) -> Result<(), GpuError> {
        let Self { triangles, cells } = self;
        if !triangles.still_is_stale() {
            return Ok(());
        }
        timer.stage(gpu, "voxelize/triangles", |e| triangles.record_still(gpu, e, cells.volume_mut()))
    }

    /// Puts it back after what views have cleared and injected.
    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &mut VolumeBuffer,
        indirect: &mut Indirect,
    ) -> Result<(), GpuError> {
        self.cells.record(gpu, encoder, volume)?;
        match indirect.gathered_mut() {
            Some(gathered) => self.triangles.record_still_subcells(gpu, encoder, volume, gathered),
            None => Ok(()),
        }
    }
}
