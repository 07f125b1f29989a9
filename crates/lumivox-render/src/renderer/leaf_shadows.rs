//! Transmittance shadow maps: masked surfaces, such as leaves, and absorbers let a part of a lamp's light through, so that foliage has depth in
//! place of one black shadow (Eisemann and Decoret 2006, 3.1). For the sun, spots and point lights; area lights have shadow maps of everything.
//!
//! A light's slicemap holds these surfaces alone; they are left out of its shadow map, and what comes through that is
//! multiplied by what the slicemap leaves. A point light has six.

use glam::{Mat4, UVec2, Vec3};
use lumivox::core::{Bounds, View};
use lumivox::gpu::{Gpu, GpuError, StageTimer, Texture};
use lumivox::light::IRRADIANCE_FORMAT;
use lumivox::progressive::ViewInput;
use lumivox::slicemap::{
    MAX_KINDS, Slicemap, SlicemapSettings, Slicing, Transmittance, TransmittanceSettings,
};
use lumivox::voxelize::Mesh;
use lumivox_scene::Scene;

use super::RendererError;
use super::absorbers::Absorbers;
use crate::gpu_scene::GpuScene;
use crate::lights::{self, LightSample, ViewShape};
use crate::material_textures::MaterialTextures;

/// How leaves shade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafShadowSettings {
    /// The part of the light that a leaf takes, 0 to 1: more make darker shadows.
    pub sigma: f32,
    /// Columns a side of a light's slicemap; each of a point light's six has half as many.
    pub size: u32,
    /// Slices of each column.
    pub slices: u32,
    /// Where slices lie.
    pub slicing: Slicing,
    /// Whether bits are made and counted by tables, as the paper does.
    pub uses_tables: bool,
    /// Whether light takes the colour of the leaves that it comes through: of their brightest colour `1 - sigma` is left, of
    /// others less. Four materials have bits of their own, further ones those of the fourth.
    pub is_colored: bool,
    /// Whether light goes on in even steps within a slice, in place of one at its end.
    pub interpolates: bool,
}

impl Default for LeafShadowSettings {
    fn default() -> Self {
        Self {
            sigma: 0.3,
            size: 512,
            slices: 96,
            slicing: Slicing::Local,
            uses_tables: false,
            is_colored: false,
            interpolates: false,
        }
    }
}

/// The masked surfaces of a scene, and what they leave of each light.
#[derive(Debug)]
pub(super) struct LeafShadows {
    settings: LeafShadowSettings,
    absorbers: Absorbers,
    /// With the number of their instance and their kind.
    meshes: Vec<(usize, Mesh, u32)>,
    lights: Vec<LeafLight>,
}

#[derive(Debug)]
struct LeafLight {
    /// Number of the light.
    source: usize,
    /// One for each of its views, with its pass.
    maps: Vec<(Slicemap, Transmittance)>,
    factor: Texture,
}

impl LeafShadows {
    /// None where nothing is masked or absorbs, or no light has one view or six.
    pub(super) fn new(
        gpu: &Gpu,
        scenes: [&Scene; 2],
        (gpu_scene, textures): (&GpuScene, &MaterialTextures),
        samples: &[LightSample],
        (settings, size): (LeafShadowSettings, UVec2),
    ) -> Result<Option<Self>, RendererError> {
        let absorbers = Absorbers::new(scenes[0], settings.is_colored);
        let all = gpu_scene.voxel_meshes(gpu, scenes, textures)?;
        let kind = |n: usize| {
            let instance = scenes[0].instances.get(n)?;
            absorbers.kind(scenes[0].meshes[instance.mesh].material)
        };
        let meshes: Vec<_> =
            all.into_iter().enumerate().filter_map(|(n, mesh)| Some((n, mesh, kind(n)?))).collect();
        if meshes.is_empty() {
            return Ok(None);
        }
        let light = |sample: &LightSample| -> Result<Option<LeafLight>, GpuError> {
            let Some(source) = sample.source.filter(|_| is_point_like(sample)) else { return Ok(None) };
            let views = sample.shape.count();
            let columns = SlicemapSettings {
                size: UVec2::splat(side(&settings, views)),
                slices: settings.slices,
                kinds: absorbers.kinds(),
                slicing: settings.slicing,
                uses_table: settings.uses_tables,
                ..SlicemapSettings::default()
            };
            let map = |_| Ok((Slicemap::new(gpu, columns)?, Transmittance::new(gpu, settings.uses_tables)?));
            Ok(Some(LeafLight {
                source,
                maps: (0..views).map(map).collect::<Result<_, GpuError>>()?,
                factor: Texture::target(gpu, "leaves/factor", size.to_array(), IRRADIANCE_FORMAT)?,
            }))
        };
        let lights: Vec<LeafLight> =
            samples.iter().filter_map(|sample| light(sample).transpose()).collect::<Result<_, _>>()?;
        Ok((!lights.is_empty()).then_some(Self { settings, absorbers, meshes, lights }))
    }

    /// Whether a light has one.
    pub(super) fn has(&self, source: usize) -> bool {
        self.lights.iter().any(|light| light.source == source)
    }

    /// Changes what a leaf takes.
    pub(super) fn set_sigma(&mut self, sigma: f32) {
        self.settings.sigma = sigma;
    }

    /// Moves the leaves.
    pub(super) fn set_places(&mut self, gpu: &Gpu, places: &[Mat4]) {
        for (instance, mesh, _) in &mut self.meshes {
            if let Some(place) = places.get(*instance) {
                mesh.set_transform(gpu, place);
            }
        }
    }

    /// Says where the lights' slicemaps stand. Once a frame.
    pub(super) fn update(&self, gpu: &Gpu, samples: &[LightSample], bounds: &Bounds, camera: &View) {
        let receivers = lights::visible_part(camera, bounds);
        let through = self.absorbers.through(self.settings.sigma);
        for light in &self.lights {
            let found = |s: &&LightSample| s.source == Some(light.source) && is_point_like(s);
            let Some(sample) = samples.iter().find(found) else { continue };
            let side = side(&self.settings, light.maps.len());
            let views = lights::light_views(sample, bounds, &receivers, side);
            for (n, ((map, pass), view)) in light.maps.iter().zip(views).enumerate() {
                let distance = |p: Vec3| -view.eye_from_world.transform_point3(p).z;
                let (near, far) = bounds
                    .corners()
                    .map(distance)
                    .into_iter()
                    .fold((f32::MAX, 0f32), |(near, far), d| (near.min(d), far.max(d)));
                map.set_view(gpu, &view, [near.max(0.0), far]);
                // A column's width in the middle of the scene: leaves are not as thin as columns.
                let scale = view.clip_from_world.row(0).truncate().length()
                    / (view.clip_from_world * bounds.center().extend(1.0)).w.abs().max(1e-6);
                let counted = TransmittanceSettings {
                    through,
                    bias: 2.0 / (scale.max(1e-20) * side as f32),
                    interpolates: self.settings.interpolates,
                    // The first says of all pixels what is left, the others of those that they see.
                    only_inside: n > 0,
                };
                pass.update(gpu, &counted);
            }
        }
    }

    /// Slices the leaves for each light, and finds what they leave at each pixel.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        timer: &mut StageTimer,
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        let meshes: Vec<(&Mesh, u32)> = self.meshes.iter().map(|(_, mesh, kind)| (mesh, *kind)).collect();
        for LeafLight { maps, factor, .. } in &mut self.lights {
            for (n, (map, pass)) in maps.iter_mut().enumerate() {
                timer.stage(gpu, "slicemap/extents", |e| map.record_extents(gpu, e, &meshes))?;
                timer.stage(gpu, "slicemap/bits", |e| map.record_bits(gpu, e, &meshes))?;
                timer.stage(gpu, "slicemap/transmittance", |e| {
                    pass.record(gpu, e, map, camera, factor, n > 0)
                })?;
            }
        }
        Ok(())
    }

    /// What is left of the first of its lights at each pixel. Waits.
    pub(super) fn read_first(&self, gpu: &Gpu) -> Result<Option<Vec<Vec3>>, GpuError> {
        let Some(light) = self.lights.first() else { return Ok(None) };
        let texels: Vec<[half::f16; 4]> = lumivox::gpu::read_texture(gpu, &light.factor)?;
        Ok(Some(texels.iter().map(|t| Vec3::new(t[0].to_f32(), t[1].to_f32(), t[2].to_f32())).collect()))
    }

    /// What is left of a light at each pixel.
    pub(super) fn factor(&self, source: usize) -> Option<&Texture> {
        self.lights.iter().find(|light| light.source == source).map(|light| &light.factor)
    }
}

/// Columns a side of each of a light's maps.
fn side(settings: &LeafShadowSettings, views: usize) -> u32 {
    if views > 1 { settings.size.div_ceil(2) } else { settings.size }
}

fn is_point_like(sample: &LightSample) -> bool {
    !sample.is_area && matches!(sample.shape, ViewShape::Parallel | ViewShape::Cone { .. } | ViewShape::All)
}

/// As many as a slicemap has.
pub(super) const KINDS: usize = MAX_KINDS as usize;
