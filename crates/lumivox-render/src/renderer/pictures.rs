//! From light to pictures, and what is asked of a renderer between frames.

use glam::{DVec3, UVec2, Vec3};
use lumivox::VolumeBuffer;
use lumivox::gather::{GatheredLight, SurfelCount};
use lumivox::gpu::StageTimer;
use lumivox::progressive::DirectLight;
use lumivox_scene::Camera;

use super::expected::Expected;
use super::field_objects::FieldObjects;
use super::indirect::Indirect;
use super::{FrameStats, Renderer, RendererError, Settings, Shade};
use crate::composite::{Extras, Layer};
use crate::lobes::Lobes;

/// Gathered light is mirrored no sharper than this.
const GLOSSY_LEAST: f32 = 0.3;

impl Renderer {
    /// Light to picture.
    pub(super) fn compose(&mut self, clock: Option<fn() -> f64>) -> Result<FrameStats, RendererError> {
        let Self { gpu, settings, camera, volume, indirect, irradiance, mirrored, picture, .. } = self;
        let objects = self.objects.as_ref();
        let mut timer = StageTimer::new(gpu, clock);
        timer.stage(gpu, "light/reconstruction", |e| match settings.layer {
            Layer::Leaks => indirect.record_leaks(gpu, e, volume, &camera.input, irradiance),
            Layer::Glossy => {
                let view = &camera.input;
                indirect.record_glossy(gpu, e, volume, view, irradiance, settings.roughness)
            }
            _ => indirect.record_reconstruction(gpu, e, volume, &camera.input, irradiance),
        })?;
        if let (Some(mirrored), Some(polish)) = (mirrored.as_mut(), settings.polish) {
            let roughness = polish.reflections.roughness.max(GLOSSY_LEAST);
            timer.stage(gpu, "light/glossy", |e| {
                indirect.record_glossy(gpu, e, volume, &camera.input, mirrored, roughness)
            })?;
        }
        let extras = Extras {
            occlusion: objects.and_then(|o| o.factor(Shade::Occlusion)),
            reflection: objects.and_then(FieldObjects::reflection),
            mirrored: mirrored.as_ref(),
        };
        if settings.layer == Layer::Lobes {
            let lobes = match &mut self.lobes {
                Some(lobes) => lobes,
                none => none.insert(Lobes::new(gpu, volume.grid())?),
            };
            timer.stage(gpu, "debug/lobes", |e| {
                indirect.record_irradiance_volume(gpu, e, volume, lobes.lattice_mut())
            })?;
        }
        timer.stage(gpu, "composite", |e| match settings.layer {
            Layer::Voxels => {
                let expected = self.expected.as_ref().map(Expected::volume);
                let compared = (expected, self.voxelizer.ages());
                self.voxel_view.record(gpu, e, camera, (volume, &self.direct_light), compared, picture)
            }
            Layer::Lobes => match &self.lobes {
                Some(lobes) => lobes.record(gpu, e, camera, picture),
                None => Ok(()),
            },
            _ => self.composite_pass.record(gpu, e, camera, irradiance, extras, picture),
        })?;
        if let (Some(glass), Layer::Final | Layer::Thickness) = (&mut self.glass, settings.layer) {
            glass.update(gpu, &camera.view, &self.bounds);
            glass.record(gpu, &mut timer, &camera.input, picture)?;
        }
        Ok(FrameStats { stages: timer.finish(gpu)? })
    }

    /// Makes a picture of the volume as the last frame left it, from any camera, without the cells above a height.
    pub fn show_voxels(&mut self, camera: &Camera, cut_height: f32) -> Result<(), RendererError> {
        self.set_camera(camera);
        let Self { gpu, camera, volume, picture, .. } = self;
        self.voxel_view.cut(gpu, cut_height);
        camera.update(gpu, self.scale);
        let mut timer = StageTimer::new(gpu, None);
        timer.stage(gpu, "debug/voxels", |e| {
            self.voxel_view.record(gpu, e, camera, (volume, &self.direct_light), (None, None), picture)
        })?;
        timer.finish(gpu)?;
        let Settings { voxel_channel, voxel_slice, .. } = self.settings;
        self.voxel_view.show(gpu, self.volume.grid(), voxel_channel, voxel_slice);
        Ok(())
    }

    /// The gathered light, if that is how light is found.
    pub fn gathered(&self) -> Option<&GatheredLight> {
        match &self.indirect {
            Indirect::Gathered(gathered) => Some(gathered),
            Indirect::Lpv(_) | Indirect::Propagated(_) => None,
        }
    }

    /// How many surfels gathered light has, and how many found no room. Waits.
    pub fn surfels(&self) -> Result<Option<SurfelCount>, RendererError> {
        Ok(self.gathered().map(|light| light.count(&self.gpu)).transpose()?)
    }

    /// What light there still is to settle, as far as a step tells: flux under way
    /// ([`IndirectLight::flux_under_way`](lumivox::light::IndirectLight::flux_under_way)), or for gathered light, all the irradiance
    /// that there is, which grows until it has settled.
    pub fn light_in_volume(&self) -> Result<f64, RendererError> {
        Ok(match &self.indirect {
            Indirect::Lpv(light) => light.flux_under_way(&self.gpu)?,
            Indirect::Propagated(light) => light.flux_under_way(&self.gpu)?,
            Indirect::Gathered(light) => light.total_irradiance(&self.gpu)?,
        })
    }

    /// The picture, linear radiance, row 0 on top. Waits.
    pub fn read_picture(&self) -> Result<Vec<Vec3>, RendererError> {
        let pixels = self.settings.size.element_product() as usize;
        if self.settings.layer == Layer::Transmittance {
            let left = self.leaves.as_ref().map(|leaves| leaves.read_first(&self.gpu)).transpose()?;
            return Ok(left.flatten().unwrap_or_else(|| vec![Vec3::ONE; pixels]));
        }
        if self.settings.layer == Layer::Thickness {
            let metres = self.glass.as_ref().map(|glass| glass.thickness(&self.gpu)).transpose()?;
            let grey = |metres: Vec<f32>| metres.into_iter().map(Vec3::splat).collect();
            return Ok(metres.map_or_else(|| vec![Vec3::ZERO; pixels], grey));
        }
        let texels: Vec<[half::f16; 4]> = lumivox::gpu::read_texture(&self.gpu, &self.picture)?;
        Ok(texels.iter().map(|t| Vec3::new(t[0].to_f32(), t[1].to_f32(), t[2].to_f32())).collect())
    }

    /// The place in the world that each pixel shows, row 0 on top; none for the sky, and glass that is seen through is not there. Waits.
    pub fn read_places(&self) -> Result<Vec<Option<DVec3>>, RendererError> {
        let size = self.settings.size;
        let depths: Vec<f32> = lumivox::gpu::read_texture(&self.gpu, &self.camera.input.textures.depth)?;
        let world_from_clip = self.camera.view.clip_from_world.as_dmat4().inverse();
        let place = |(n, depth): (u32, f32)| {
            // Reversed: what is far away has none.
            let uv = (UVec2::new(n % size.x, n / size.x).as_dvec2() + 0.5) / size.as_dvec2();
            let ndc = DVec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, f64::from(depth));
            (depth > 0.0).then(|| world_from_clip.project_point3(ndc))
        };
        Ok((0..).zip(depths).map(place).collect())
    }

    /// The volume.
    pub fn volume(&self) -> &VolumeBuffer {
        &self.volume
    }

    /// The direct light of the volume's cells.
    pub fn direct_light(&self) -> &DirectLight {
        &self.direct_light
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
}
