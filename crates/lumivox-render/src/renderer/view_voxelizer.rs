//! Views to volume, in whichever form was asked for.

use lumivox::VolumeBuffer;
use lumivox::gpu::{Buffer, Gpu, GpuError};
use lumivox::progressive::{CellAges, DirectLight, Progressive, Rules, SinglePass, ViewInput};
use lumivox::wgpu::CommandEncoder;

use super::VoxelSource;
use super::injected_lights::InjectedLight;

/// The stages that keep the volume up, and what they are given.
#[derive(Debug)]
pub(super) enum ViewVoxelizer {
    /// Cleanup and injection.
    TwoPhase { progressive: Box<Progressive>, source: VoxelSource, ages: Option<CellAges> },
    /// Both at once.
    SinglePass(Box<SinglePass>),
}

/// What all stages of a frame write.
pub(super) struct Target<'a> {
    pub(super) volume: &'a mut VolumeBuffer,
    pub(super) light: &'a mut DirectLight,
}

impl ViewVoxelizer {
    pub(super) fn new(
        gpu: &Gpu,
        volume: &VolumeBuffer,
        source: VoxelSource,
        rules: Rules,
        shows_ages: bool,
    ) -> Result<Self, GpuError> {
        Ok(match source {
            VoxelSource::SinglePass => {
                Self::SinglePass(Box::new(SinglePass::with_rules(gpu, volume, rules)?))
            }
            _ => Self::TwoPhase {
                progressive: Box::new(Progressive::with_rules(gpu, volume, rules)?),
                source,
                ages: shows_ages.then(|| CellAges::new(gpu, volume)).transpose()?,
            },
        })
    }

    /// Begins a frame, and clears what the camera proves empty.
    pub(super) fn record_begin(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        camera: &ViewInput,
        Target { volume, light }: Target<'_>,
    ) -> Result<(), GpuError> {
        match self {
            Self::SinglePass(single) => single.record_begin(encoder, light),
            Self::TwoPhase { progressive, source, .. } => {
                if *source == VoxelSource::SingleFrame {
                    volume.record_clear(encoder);
                }
                progressive.record_begin(encoder, light);
                if source.keeps_cells() {
                    progressive.record_cleanup(gpu, encoder, camera, volume)?;
                }
            }
        }
        Ok(())
    }

    /// Clears what a light's views prove empty.
    pub(super) fn record_cleanup(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        source: &InjectedLight,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        match self {
            Self::TwoPhase { progressive, source: from, .. } if from.keeps_cells() && source.is_full => {
                let mut views = source.views.iter().map(|v| &v.input);
                views.try_for_each(|view| progressive.record_cleanup(gpu, encoder, view, volume))
            }
            _ => Ok(()),
        }
    }

    /// Injects what a light's views show.
    pub(super) fn record_light(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        source: &InjectedLight,
        Target { volume, light }: Target<'_>,
    ) -> Result<(), GpuError> {
        let views = source.views.iter().map(|v| &v.input);
        match self {
            Self::SinglePass(single) => single.record_light(gpu, encoder, views, volume, light),
            Self::TwoPhase { progressive, .. } if source.is_full => {
                progressive.record_light(gpu, encoder, views, volume, light)
            }
            Self::TwoPhase { progressive, .. } => {
                progressive.record_light_only(gpu, encoder, views, volume, light)
            }
        }
    }

    /// Injects what the camera shows, and ends the frame.
    pub(super) fn record_camera(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        camera: &ViewInput,
        Target { volume, light }: Target<'_>,
    ) -> Result<(), GpuError> {
        match self {
            Self::SinglePass(single) => single.record_camera(gpu, encoder, camera, volume, light),
            Self::TwoPhase { progressive, ages, .. } => {
                progressive.record_camera(gpu, encoder, camera, volume, light)?;
                progressive.record_end(gpu, encoder, camera, volume, light)?;
                ages.as_mut().map_or(Ok(()), |ages| ages.record(gpu, encoder, progressive, volume))
            }
        }
    }

    /// Ages of cells, where they are to be shown.
    pub(super) fn ages(&self) -> Option<&Buffer> {
        match self {
            Self::TwoPhase { ages, .. } => ages.as_ref().map(CellAges::ages),
            Self::SinglePass(_) => None,
        }
    }
}
