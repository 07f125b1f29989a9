//! What pictures look up in fields: `--ao`, `--shadows` and `--reflections`.

use anyhow::{Result, bail};
use lumivox::visibility::{Combine, OcclusionSettings, ReflectionSettings, ShadowSettings};
use lumivox_render::{LeafShadowSettings, ObjectFields, Polish, Settings};
use lumivox_scene::Scene;

use super::casters;
use crate::args::{AoArg, ByArg, ObjectArgs, ReflectionsArg};

/// Smoother than this a surface is a mirror.
const MIRROR: f32 = 0.05;

/// The fields that pictures look things up in; none where nobody asks.
pub(crate) fn object_fields(args: &ObjectArgs, scene: &Scene) -> Result<ObjectFields> {
    if !(0.0..=1.0).contains(&args.sigma) {
        bail!("--sigma must be 0 to 1");
    }
    let normals = args.reflections == ReflectionsArg::Field;
    if args.ao == AoArg::Maps && args.shadows != ByArg::Field && !normals {
        return Ok(ObjectFields::default());
    }
    if !(0.0..=1.0).contains(&args.polish) || !(0.0..=1.0).contains(&args.reflectance) {
        bail!("--polish and --reflectance must be 0 to 1");
    }
    if !(0.0..=1e6).contains(&args.light_radius) {
        bail!("--light-radius must be 0 to 1e6 metres");
    }
    if args.ao != AoArg::Maps && scene.sky == glam::Vec3::ZERO && scene.sky_map.is_none() {
        tracing::warn!("there is no sky: --ao field has no light to take from");
    }
    let (points, directions) = (args.field_points, args.field_directions);
    let settings = lumivox_field::Settings { points, directions, normals, ..Default::default() };
    settings.check()?;
    casters::fields(scene, &args.casters, settings)
}

/// The settings with what is looked up in fields.
pub(crate) fn with_objects(settings: Settings, args: &ObjectArgs, still: bool) -> Settings {
    let rays = args.field_rays.unwrap_or(if still { 64 } else { 16 });
    let shadows = args.shadows == ByArg::Field;
    let combine = match args.ao {
        AoArg::Maps => None,
        AoArg::Field => Some(Combine::Nearest),
        AoArg::Subtract => Some(Combine::Subtract),
    };
    let polish = Polish {
        reflections: ReflectionSettings {
            rays,
            roughness: args.polish,
            blended: true,
            // A mirror stays sharp.
            denoise: args.polish >= MIRROR,
        },
        reflectance: args.reflectance,
    };
    Settings {
        occlusion: combine.map(|combine| OcclusionSettings {
            rays,
            blended: true,
            combine,
            ..OcclusionSettings::default()
        }),
        soft_shadows: shadows.then(|| ShadowSettings { rays, blended: true, ..ShadowSettings::default() }),
        leaf_shadows: (args.shadows == ByArg::Transmittance)
            .then(|| LeafShadowSettings { sigma: args.sigma, ..LeafShadowSettings::default() }),
        light_radius: args.light_radius,
        polish: (args.reflections == ReflectionsArg::Field).then_some(polish),
        ..settings
    }
}
