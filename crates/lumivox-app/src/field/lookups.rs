//! What pictures look up in fields: `--ao`, `--shadows` and `--reflections`.

use anyhow::{Result, bail};
use lumivox::visibility::{Combine, OcclusionSettings, ReflectionSettings, ShadowSettings};
use lumivox_render::{LeafShadowSettings, ObjectFields, Polish, Settings};
use lumivox_scene::Scene;

use super::casters;
use crate::args::{AoArg, ByArg, FieldMapsArg, ObjectArgs, ReflectionsArg};

/// Smoother than this a surface is a mirror.
const MIRROR: f32 = 0.05;
/// Roughness, mirrored part and metres, unless said otherwise.
const POLISH: f32 = 0.15;
const REFLECTANCE: f32 = 0.1;
const LIGHT_RADIUS: f32 = 0.1;

/// The fields that pictures look things up in; none where nobody asks.
pub(crate) fn object_fields(args: &ObjectArgs, scene: &Scene) -> Result<ObjectFields> {
    if !(0.0..=1.0).contains(&args.sigma) {
        bail!("--sigma must be 0 to 1");
    }
    let normals = args.reflections == ReflectionsArg::Field;
    if args.ao == AoArg::Maps && args.shadows != ByArg::Field && !normals {
        return Ok(ObjectFields::default());
    }
    if [args.polish, args.reflectance].into_iter().flatten().any(|part| !(0.0..=1.0).contains(&part)) {
        bail!("--polish and --reflectance must be 0 to 1");
    }
    if args.light_radius.is_some_and(|radius| !(0.0..=1e6).contains(&radius)) {
        bail!("--light-radius must be 0 to 1e6 metres");
    }
    if args.ao_reach.is_some_and(|reach| !(reach > 0.0 && reach.is_finite())) {
        bail!("--ao-reach must be more than 0 metres");
    }
    if args.ao_exponent.is_some_and(|exponent| !(1e-3..=1e3).contains(&exponent)) {
        bail!("--ao-exponent must be 0.001 to 1000");
    }
    if args.ao != AoArg::Maps && scene.sky == glam::Vec3::ZERO && scene.sky_map.is_none() {
        tracing::warn!("there is no sky: --ao field has no light to take from");
    }
    let usual = lumivox_field::Settings::default();
    let settings = lumivox_field::Settings {
        points: args.field_points.unwrap_or(usual.points),
        directions: args.field_directions.unwrap_or(usual.directions),
        normals,
        ..usual
    };
    settings.check()?;
    casters::fields(scene, &args.casters, settings)
}

/// The settings with what is looked up in fields.
pub(crate) fn with_objects(settings: Settings, args: &ObjectArgs, still: bool) -> Settings {
    let rays = args.field_rays.unwrap_or(if still { 64 } else { 16 });
    let shadows = args.shadows == ByArg::Field;
    let blended = args.field_maps != Some(FieldMapsArg::Nearest);
    let roughness = args.polish.unwrap_or(POLISH);
    let usual = OcclusionSettings::default();
    let combine = match args.ao {
        AoArg::Maps => None,
        AoArg::Field => Some(Combine::Nearest),
        AoArg::Subtract => Some(Combine::Subtract),
    };
    let polish = Polish {
        reflections: ReflectionSettings {
            rays,
            roughness,
            blended,
            // A mirror stays sharp.
            denoise: roughness >= MIRROR,
        },
        reflectance: args.reflectance.unwrap_or(REFLECTANCE),
    };
    Settings {
        occlusion: combine.map(|combine| OcclusionSettings {
            rays,
            reach: args.ao_reach.unwrap_or(usual.reach),
            exponent: args.ao_exponent.unwrap_or(usual.exponent),
            blended,
            combine,
            ..usual
        }),
        soft_shadows: shadows.then(|| ShadowSettings { rays, blended, ..ShadowSettings::default() }),
        leaf_shadows: (args.shadows == ByArg::Transmittance)
            .then(|| LeafShadowSettings { sigma: args.sigma, ..LeafShadowSettings::default() }),
        volume_shadows: args.shadows == ByArg::Volumes,
        light_radius: args.light_radius.unwrap_or(LIGHT_RADIUS),
        polish: (args.reflections == ReflectionsArg::Field).then_some(polish),
        ..settings
    }
}
