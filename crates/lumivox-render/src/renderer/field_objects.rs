//! Rigid objects with visibility fields: where they stand, what they take of the light at each pixel, and what polished surfaces
//! mirror of them.
//!
//! Light that is looked up in fields needs no shadow map of these objects: they are left out of the maps of such lights, and
//! what comes through the maps of the rest is multiplied by what the objects let through.

use glam::{Mat4, Vec3};
use lumivox::core::PackedField;
use lumivox::gpu::{Gpu, GpuError, StageTimer, Texture};
use lumivox::progressive::ViewInput;
use lumivox::visibility::{
    Fields, Objects, Occlusion, Placement, Receiver, Reflections, ShadowLight, SoftShadows,
};
use lumivox_scene::{Light, Scene};

use super::Settings;
use super::hit_light::{hit_light, mean_albedo};
use crate::lights::Sky;

/// Half of the angle that the sun is seen under, radians.
const SUN_ANGLE: f32 = 0.00465;

/// Which fields belong to which instances of a scene.
#[derive(Clone, Debug, Default)]
pub struct ObjectFields {
    /// The fields.
    pub fields: Vec<PackedField>,
    /// The objects that have any.
    pub casters: Vec<Caster>,
}

/// An instance with fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caster {
    /// Index into [`Scene::instances`].
    pub instance: usize,
    /// Numbers of the fields of its parts, in the space of its mesh.
    pub fields: Vec<usize>,
}

/// Whose light a batch of shadow views brings, as far as objects with fields see it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shade {
    /// Objects are in the shadow maps.
    Maps,
    /// Ambient occlusion stands for them.
    Occlusion,
    /// Their soft shadow in the light of this number.
    Light(usize),
    /// Objects are in the shadow maps, but masked surfaces are not: what their slicemap leaves of the light of this number stands
    /// for them.
    Leaves(usize),
    /// Only masked surfaces are in the shadow maps: the volumes of all others in the light of this number stand for them.
    Volumes(usize),
}

/// The objects of a renderer.
#[derive(Debug)]
pub(super) struct FieldObjects {
    fields: Fields,
    objects: Objects,
    casters: Vec<Caster>,
    occlusion: Option<Occlusion>,
    shadows: Option<SoftShadows>,
    reflections: Option<Reflections>,
    light_radius: f32,
    /// Of each caster.
    albedos: Vec<Vec3>,
    /// Mean radiance.
    sky: Vec3,
}

impl FieldObjects {
    /// None where the settings ask for none, or no instance has a field.
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        settings: &Settings,
        given: &ObjectFields,
    ) -> Result<Option<Self>, GpuError> {
        let (count, size) = (scene.lights.len(), settings.size);
        let Settings { occlusion, soft_shadows, polish, .. } = *settings;
        if given.casters.is_empty() || (occlusion.is_none() && soft_shadows.is_none() && polish.is_none()) {
            return Ok(None);
        }
        let parts: usize = given.casters.iter().map(|c| c.fields.len()).sum();
        let fields = Fields::new(gpu, &given.fields.iter().collect::<Vec<_>>())?;
        let objects = Objects::new(gpu, u32::try_from(parts).unwrap_or(u32::MAX))?;
        let occlusion = occlusion.map(|s| Occlusion::new(gpu, size, &objects, s)).transpose()?;
        let shadows = soft_shadows.map(|s| SoftShadows::new(gpu, size, &objects, count, s));
        let reflections = polish.map(|p| Reflections::new(gpu, size, &objects, p.reflections));
        let albedo = |caster: &Caster| {
            let mesh = scene.instances.get(caster.instance).and_then(|i| scene.meshes.get(i.mesh));
            mesh.map_or(Vec3::ONE, |mesh| mean_albedo(scene, mesh))
        };
        Ok(Some(Self {
            fields,
            objects,
            casters: given.casters.clone(),
            occlusion,
            shadows: shadows.transpose()?,
            reflections: reflections.transpose()?,
            light_radius: settings.light_radius,
            albedos: given.casters.iter().map(albedo).collect(),
            sky: Sky::of(scene).mean(),
        }))
    }

    /// The instances that have fields.
    pub(super) fn instances(&self) -> impl Iterator<Item = usize> + '_ {
        self.casters.iter().map(|c| c.instance)
    }

    /// Who stands for the objects in the light of a source: a light's number, or none for the sky.
    pub(super) fn shade(&self, source: Option<usize>) -> Shade {
        match source {
            None if self.occlusion.is_some() => Shade::Occlusion,
            Some(light) if self.shadows.is_some() => Shade::Light(light),
            _ => Shade::Maps,
        }
    }

    /// Writes where everything stands. Once a frame.
    pub(super) fn update(&mut self, gpu: &Gpu, places: &[Mat4], lights: &[Light]) -> Result<(), GpuError> {
        let mut all = Vec::new();
        for ((n, caster), &albedo) in self.casters.iter().enumerate().zip(&self.albedos) {
            let Some(&place) = places.get(caster.instance) else { continue };
            let part = |&field: &usize| Placement { albedo, ..Placement::new(field, place, n as u32) };
            all.extend(caster.fields.iter().map(part));
        }
        self.objects.update(gpu, &self.fields, &all)?;
        if let Some(occlusion) = &self.occlusion {
            occlusion.update(gpu, &self.objects);
        }
        if let Some(shadows) = &self.shadows {
            let lights: Vec<_> = lights.iter().map(|l| shadow_light(l, self.light_radius)).collect();
            shadows.update(gpu, &self.objects, &lights);
        }
        if let Some(reflections) = &self.reflections {
            reflections.update(gpu, &self.objects, &hit_light(lights, self.sky));
        }
        Ok(())
    }

    /// Finds what objects take of the light at each pixel, and what it mirrors of them.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        timer: &mut StageTimer,
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        let Self { fields, objects, occlusion, shadows, reflections, .. } = self;
        let receiver = Receiver::from(camera);
        if let Some(occlusion) = occlusion {
            timer.stage(gpu, "visibility/occlusion", |e| {
                occlusion.record(gpu, e, fields, objects, &receiver)
            })?;
        }
        if let Some(shadows) = shadows {
            timer.stage(gpu, "visibility/shadow", |e| shadows.record(gpu, e, fields, objects, &receiver))?;
        }
        if let Some(reflections) = reflections {
            timer.stage(gpu, "visibility/reflection", |e| {
                reflections.record(gpu, e, fields, objects, &receiver, None)
            })?;
        }
        Ok(())
    }

    /// What of a batch's light the objects let through.
    pub(super) fn factor(&self, shade: Shade) -> Option<&Texture> {
        match shade {
            Shade::Maps | Shade::Leaves(_) | Shade::Volumes(_) => None,
            Shade::Occlusion => self.occlusion.as_ref().map(Occlusion::factor),
            Shade::Light(light) => self.shadows.as_ref().and_then(|s| s.factor(light)),
        }
    }

    /// What each pixel mirrors of the objects, if surfaces are polished.
    pub(super) fn reflection(&self) -> Option<&Texture> {
        self.reflections.as_ref().map(Reflections::color)
    }
}

/// A light's size: points and spots are balls of one radius.
fn shadow_light(light: &Light, radius: f32) -> ShadowLight {
    match *light {
        Light::Directional { direction, .. } => ShadowLight::Sun { direction, angle: SUN_ANGLE },
        Light::Point { position, .. } | Light::Spot { position, .. } => {
            ShadowLight::Ball { position, radius }
        }
        Light::Rect { origin, u, v, .. } => ShadowLight::Rect { origin, u, v },
    }
}
