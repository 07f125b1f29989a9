//! Stencil shadow volumes: hard shadows of opaque surfaces, exact to the pixel, in the light of suns, spots and points.
//!
//! Opaque surfaces are left out of such a light's shadow maps, and what comes through these is multiplied by a mask. Masked
//! surfaces, whose holes a volume cannot have, stay in the maps.

use glam::Mat4;
use lumivox::core::{Bounds, TriangleView, View};
use lumivox::gpu::{Gpu, GpuError, StageTimer, Texture};
use lumivox::progressive::ViewInput;
use lumivox::shadow_volumes::{CullSettings, ShadowVolumes, Topology, VolumeLight, VolumeSettings};
use lumivox::voxelize::Mesh;
use lumivox_scene::{AlphaMode, Scene};

use super::{RendererError, Settings};
use crate::gpu_scene::GpuScene;
use crate::lights::{self, LightSample, ViewShape};
use crate::material_textures::MaterialTextures;

/// Of the scene's diagonal the distance behind a surface at which its shadow begins.
const BIAS: f32 = 1e-4;
/// Texels a side of the views that say what a light reaches; they are not drawn.
const VIEW_TEXELS: u32 = 1024;

/// The opaque surfaces of a scene, and their shadows.
#[derive(Debug)]
pub(super) struct VolumeShadows {
    /// With the number of their instance.
    meshes: Vec<(usize, Mesh)>,
    /// Numbers of the lights.
    sources: Vec<usize>,
    volumes: ShadowVolumes,
}

impl VolumeShadows {
    /// None where nothing is opaque, or no light is a sun, a spot or a point.
    pub(super) fn new(
        gpu: &Gpu,
        scenes: [&Scene; 2],
        (gpu_scene, textures): (&GpuScene, &MaterialTextures),
        samples: &[LightSample],
        (bounds, settings): (&Bounds, &Settings),
    ) -> Result<Option<Self>, RendererError> {
        let sources: Vec<usize> =
            samples.iter().filter(|s| has_volumes(s)).filter_map(|sample| sample.source).collect();
        let scene = scenes[0];
        let is_opaque = |n: &usize| {
            let instance = scene.instances.get(*n);
            instance
                .is_some_and(|i| scene.materials[scene.meshes[i.mesh].material].alpha == AlphaMode::Opaque)
        };
        let all = gpu_scene.voxel_meshes(gpu, scenes, textures)?;
        let meshes: Vec<_> = all.into_iter().enumerate().filter(|(n, _)| is_opaque(n)).collect();
        if sources.is_empty() || meshes.is_empty() {
            return Ok(None);
        }
        let topology = |mesh: &lumivox_scene::Mesh| {
            Topology::new(&TriangleView { positions: &mesh.positions, indices: &mesh.indices })
        };
        let topologies: Vec<_> = scene.meshes.iter().map(topology).collect();
        let of_instances: Vec<_> =
            meshes.iter().map(|(n, _)| &topologies[scene.instances[*n].mesh]).collect();
        let settings = VolumeSettings {
            size: settings.size,
            bias: BIAS * bounds.size().length(),
            culling: settings.culls_volumes.then(CullSettings::default),
        };
        let volumes = ShadowVolumes::new(gpu, &of_instances, sources.len(), settings)?;
        Ok(Some(Self { meshes, sources, volumes }))
    }

    /// Whether a light has them.
    pub(super) fn has(&self, source: usize) -> bool {
        self.sources.contains(&source)
    }

    /// Moves what casts.
    pub(super) fn set_places(&mut self, gpu: &Gpu, places: &[Mat4]) {
        for (instance, mesh) in &mut self.meshes {
            if let Some(place) = places.get(*instance) {
                mesh.set_transform(gpu, place);
            }
        }
    }

    /// Says where the camera and the lights stand. Once a frame.
    pub(super) fn update(&mut self, gpu: &Gpu, samples: &[LightSample], bounds: &Bounds, camera: &View) {
        let receivers = lights::visible_part(camera, bounds);
        let samples: Vec<_> = self
            .sources
            .iter()
            .filter_map(|&source| samples.iter().find(|s| s.source == Some(source) && has_volumes(s)))
            .collect();
        let views: Vec<_> =
            samples.iter().map(|s| lights::light_views(s, bounds, &receivers, VIEW_TEXELS)).collect();
        let lights: Vec<_> =
            samples.iter().zip(&views).map(|(sample, views)| (volume_light(sample), &views[..])).collect();
        self.volumes.update(gpu, camera, &lights);
    }

    /// Finds what is in shadow at each pixel.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        timer: &mut StageTimer,
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        let Self { meshes, volumes, .. } = self;
        let meshes: Vec<&Mesh> = meshes.iter().map(|(_, mesh)| mesh).collect();
        timer.stage(gpu, "volumes", |e| volumes.record(gpu, e, &camera.textures.depth, &meshes))
    }

    /// What is left of a light at each pixel.
    pub(super) fn factor(&self, source: usize) -> Option<&Texture> {
        let light = self.sources.iter().position(|s| *s == source)?;
        self.volumes.mask(light)
    }
}

fn has_volumes(sample: &LightSample) -> bool {
    !sample.is_area && matches!(sample.shape, ViewShape::Parallel | ViewShape::Cone { .. } | ViewShape::All)
}

fn volume_light(sample: &LightSample) -> VolumeLight {
    match sample.shape {
        ViewShape::Parallel => VolumeLight::Directional { direction: sample.uniform.direction },
        _ => VolumeLight::Point { position: sample.uniform.position },
    }
}
