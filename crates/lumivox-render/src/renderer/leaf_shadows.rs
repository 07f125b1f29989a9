//! Transmittance shadow maps: masked surfaces, such as leaves, let a part of a lamp's light through, so that foliage has depth in place of
//! one black shadow (Eisemann and Decoret 2006, 3.1). For the sun and spots; other lights have shadow maps of everything.
//!
//! A light's slicemap holds the masked surfaces alone; they are left out of its shadow map, and what comes through that is
//! multiplied by what the slicemap leaves.

use glam::{Mat4, UVec2, Vec3};
use lumivox::core::{Bounds, View};
use lumivox::gpu::{Gpu, GpuError, StageTimer, Texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::progressive::ViewInput;
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing, Transmittance, TransmittanceSettings};
use lumivox::voxelize::Mesh;
use lumivox_scene::{AlphaMode, Scene};

use super::RendererError;
use crate::gpu_scene::GpuScene;
use crate::lights::{self, LightSample, ViewShape};
use crate::material_textures::MaterialTextures;

/// How leaves shade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafShadowSettings {
    /// The part of the light that a leaf takes, 0 to 1: more make darker shadows.
    pub sigma: f32,
    /// Columns a side of a light's slicemap.
    pub size: u32,
    /// Slices of each column.
    pub slices: u32,
    /// Where slices lie.
    pub slicing: Slicing,
    /// Whether bits are made and counted by tables, as the paper does.
    pub uses_tables: bool,
}

impl Default for LeafShadowSettings {
    fn default() -> Self {
        Self { sigma: 0.3, size: 512, slices: 96, slicing: Slicing::Local, uses_tables: false }
    }
}

/// The masked surfaces of a scene, and what they leave of each light.
#[derive(Debug)]
pub(super) struct LeafShadows {
    settings: LeafShadowSettings,
    /// With the number of their instance.
    meshes: Vec<(usize, Mesh)>,
    lights: Vec<LeafLight>,
}

#[derive(Debug)]
struct LeafLight {
    /// Number of the light.
    source: usize,
    map: Slicemap,
    pass: Transmittance,
    factor: Texture,
}

impl LeafShadows {
    /// None where nothing is masked, or no light is a sun or a spot.
    pub(super) fn new(
        gpu: &Gpu,
        scenes: [&Scene; 2],
        (gpu_scene, textures): (&GpuScene, &MaterialTextures),
        samples: &[LightSample],
        (settings, size): (LeafShadowSettings, UVec2),
    ) -> Result<Option<Self>, RendererError> {
        let is_masked = |n: &usize| {
            let instance = scenes[0].instances.get(*n);
            instance.is_some_and(|i| {
                scenes[0].materials[scenes[0].meshes[i.mesh].material].alpha != AlphaMode::Opaque
            })
        };
        let all = gpu_scene.voxel_meshes(gpu, scenes, textures)?;
        let meshes: Vec<_> = all.into_iter().enumerate().filter(|(n, _)| is_masked(n)).collect();
        let lights: Vec<LeafLight> = samples
            .iter()
            .filter(|sample| has_one_view(sample))
            .filter_map(|sample| sample.source)
            .map(|source| {
                let map = SlicemapSettings {
                    size: UVec2::splat(settings.size),
                    slices: settings.slices,
                    slicing: settings.slicing,
                    uses_table: settings.uses_tables,
                    ..SlicemapSettings::default()
                };
                Ok(LeafLight {
                    source,
                    map: Slicemap::new(gpu, map)?,
                    pass: Transmittance::new(gpu, settings.uses_tables)?,
                    factor: Texture::target(gpu, "leaves/factor", size.to_array(), IRRADIANCE_FORMAT)?,
                })
            })
            .collect::<Result<_, GpuError>>()?;
        let is_needed = !meshes.is_empty() && !lights.is_empty();
        Ok(is_needed.then_some(Self { settings, meshes, lights }))
    }

    /// Whether a light has one.
    pub(super) fn has(&self, source: usize) -> bool {
        self.lights.iter().any(|light| light.source == source)
    }

    /// Moves the leaves.
    pub(super) fn set_places(&mut self, gpu: &Gpu, places: &[Mat4]) {
        for (instance, mesh) in &mut self.meshes {
            if let Some(place) = places.get(*instance) {
                mesh.set_transform(gpu, place);
            }
        }
    }

    /// Says where the lights' slicemaps stand. Once a frame.
    pub(super) fn update(&self, gpu: &Gpu, samples: &[LightSample], bounds: &Bounds, camera: &View) {
        let receivers = lights::visible_part(camera, bounds);
        for light in &self.lights {
            let sample = samples.iter().find(|s| s.source == Some(light.source) && has_one_view(s));
            let view =
                sample.and_then(|s| lights::light_views(s, bounds, &receivers, self.settings.size).pop());
            let Some(view) = view else { continue };
            let distance = |p: Vec3| -view.eye_from_world.transform_point3(p).z;
            let (near, far) = bounds
                .corners()
                .map(distance)
                .into_iter()
                .fold((f32::MAX, 0f32), |(near, far), d| (near.min(d), far.max(d)));
            light.map.set_view(gpu, &view, [near.max(0.0), far]);
            // A column's width in the middle of the scene: leaves are not as thin as columns.
            let scale = view.clip_from_world.row(0).truncate().length()
                / (view.clip_from_world * bounds.center().extend(1.0)).w.abs().max(1e-6);
            let column = 2.0 / (scale.max(1e-20) * self.settings.size as f32);
            let through = Vec3::splat(1.0 - self.settings.sigma.clamp(0.0, 1.0));
            let counted = TransmittanceSettings { through: [through; 4], bias: column, ..Default::default() };
            light.pass.update(gpu, &counted);
        }
    }

    /// Slices the leaves for each light, and finds what they leave at each pixel.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        timer: &mut StageTimer,
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        let meshes: Vec<(&Mesh, u32)> = self.meshes.iter().map(|(_, mesh)| (mesh, 0)).collect();
        for LeafLight { map, pass, factor, .. } in &mut self.lights {
            timer.stage(gpu, "slicemap/extents", |e| map.record_extents(gpu, e, &meshes))?;
            timer.stage(gpu, "slicemap/bits", |e| map.record_bits(gpu, e, &meshes))?;
            timer
                .stage(gpu, "slicemap/transmittance", |e| pass.record(gpu, e, map, camera, factor, false))?;
        }
        Ok(())
    }

    /// What is left of a light at each pixel.
    pub(super) fn factor(&self, source: usize) -> Option<&Texture> {
        self.lights.iter().find(|light| light.source == source).map(|light| &light.factor)
    }
}

fn has_one_view(sample: &LightSample) -> bool {
    !sample.is_area && matches!(sample.shape, ViewShape::Parallel | ViewShape::Cone { .. })
}
