//! Direct light against its closed form, pixel by pixel, and shadows.

use std::f32::consts::PI;

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Layer, Settings};
use lumivox_scene::{Camera, Light, Material, Scene, SpotFalloff};

use crate::Check;
use crate::camera::{Ray, rays};
use crate::scenes::{Quad, add, picture, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("a sun on a plane is its closed form", |gpu| check(gpu, SUN, None)),
    ("a point light on a plane is its closed form", |gpu| check(gpu, POINT, None)),
    ("a point light is its closed form wherever it hangs", point_lights),
    ("a spot light on a plane is its closed form", |gpu| check(gpu, SPOT, None)),
    ("a glTF spot light on a plane is its closed form", |gpu| check(gpu, GLTF_SPOT, None)),
    ("a sun's shadow is black and lies where it must", |gpu| check(gpu, SUN, Some(SHADE))),
    ("a point light's shadow is black and lies where it must", |gpu| check(gpu, POINT, Some(SHADE))),
    ("a spot light's shadow is black and lies where it must", |gpu| check(gpu, SPOT, Some(SHADE))),
    ("a sun's shadow by volumes is black and sharp", |gpu| check_sharp(gpu, SUN)),
    ("a point light's shadow by volumes is black and sharp", |gpu| check_sharp(gpu, POINT)),
    ("a spot light's shadow by volumes is black and sharp", |gpu| check_sharp(gpu, SPOT)),
    ("lights add up", lights_add_up),
];

/// What the albedo target's eight bits hold exactly: sRGB 188, 219 and 149.
const ALBEDO: Vec3 = Vec3::new(0.5028865, 0.7083758, 0.3005438);
const SUN: Light =
    Light::Directional { direction: Vec3::new(0.36, -0.8, 0.48), irradiance: Vec3::new(3.0, 2.0, 1.0) };
const POINT: Light =
    Light::Point { position: Vec3::new(0.3, 1.9, -0.2), intensity: Vec3::new(4.0, 5.0, 6.0) };
const SPOT: Light = Light::Spot {
    position: Vec3::new(-0.4, 2.0, 0.3),
    direction: Vec3::new(0.28, -0.96, 0.0),
    intensity: Vec3::new(9.0, 6.0, 7.0),
    beam: 0.3,
    cutoff: 0.75,
    falloff: SpotFalloff::LinearAngle,
};
const GLTF_SPOT: Light = Light::Spot {
    position: Vec3::new(0.1, 1.5, 0.0),
    direction: Vec3::NEG_Y,
    intensity: Vec3::new(9.0, 6.0, 7.0),
    beam: 0.2,
    cutoff: 0.8,
    falloff: SpotFalloff::Gltf,
};

const PLANE_SIDE: f32 = 4.0;
/// Middle and side of the square that shades the plane.
const SHADE: (Vec3, f32) = (Vec3::new(0.1, 0.8, 0.0), 0.9);
/// The filter of a shadow's edge reaches three texels of the shadow map, pushed apart by what lies between; points nearer
/// to an edge, in metres on the plane, are not judged.
const EDGE: f32 = 0.09;
/// Shadow volumes have none, so that a pixel's place is all that is not exact.
const SHARP_EDGE: f32 = 0.01;
/// Nor are those as near, in radians, to the end of a spot's cone, where the relative error of any number is unbounded.
const CONE_EDGE: f32 = 0.02;

fn camera() -> Camera {
    Camera::look("side", Vec3::new(0.0, 2.6, 3.6), Vec3::new(0.0, 0.0, 0.2), 48.0)
}

/// Radiance that the plane reflects at `p`; None where it is not judged.
fn closed_form(light: &Light, p: Vec3) -> Option<Vec3> {
    let lambert = |toward_light: Vec3| toward_light.y.max(0.0) * ALBEDO / PI;
    match *light {
        Light::Directional { direction, irradiance } => Some(lambert(-direction) * irradiance),
        Light::Point { position, intensity } => {
            let way = position - p;
            Some(lambert(way.normalize_or_zero()) * intensity / way.length_squared())
        }
        Light::Spot { position, direction, intensity, beam, cutoff, falloff } => {
            let way = position - p;
            let angle = direction.angle_between(-way);
            let share = match falloff {
                SpotFalloff::LinearAngle => ((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0),
                SpotFalloff::Gltf => {
                    ((angle.cos() - cutoff.cos()) / (beam.cos() - cutoff.cos())).clamp(0.0, 1.0).powi(2)
                }
            };
            let judged = (angle - cutoff).abs() > CONE_EDGE;
            judged.then(|| share * lambert(way.normalize_or_zero()) * intensity / way.length_squared())
        }
        Light::Rect { .. } => None,
    }
}

/// The ray from a point of the plane to the light.
fn shadow_ray(light: &Light, p: Vec3) -> Ray {
    let direction = match *light {
        Light::Directional { direction, .. } => -direction,
        Light::Point { position, .. } | Light::Spot { position, .. } => (position - p).normalize_or_zero(),
        Light::Rect { .. } => Vec3::Y,
    };
    Ray { origin: p, direction }
}

fn check(gpu: &Gpu, light: Light, shade: Option<(Vec3, f32)>) -> Result<(), Failed> {
    check_with(gpu, light, shade, (small(), EDGE))
}

fn check_sharp(gpu: &Gpu, light: Light) -> Result<(), Failed> {
    check_with(gpu, light, Some(SHADE), (Settings { volume_shadows: true, ..small() }, SHARP_EDGE))
}

fn check_with(
    gpu: &Gpu,
    light: Light,
    shade: Option<(Vec3, f32)>,
    (settings, edge): (Settings, f32),
) -> Result<(), Failed> {
    let mut scene = Scene { lights: vec![light], ..Scene::default() };
    let plane = Quad::level(Vec3::ZERO, PLANE_SIDE);
    add(&mut scene, Material::matte("plane", ALBEDO), &[plane]);
    let shade = shade.map(|(middle, side)| Quad::level(middle, side));
    if let Some(shade) = shade {
        add(&mut scene, Material::matte("shade", Vec3::splat(0.2)), &[shade]);
    }
    let settings = Settings { layer: Layer::Direct, ..settings };
    let seen = picture(gpu, &scene, &camera(), settings)?;

    let (mut lit, mut dark, mut faults) = (0, 0, Vec::new());
    for (n, ray) in rays(&camera(), settings.size).into_iter().enumerate() {
        let Some((distance, inside)) = ray.meets(plane.corner, plane.u, plane.v) else { continue };
        let p = ray.origin + distance * ray.direction;
        let hidden = |q: Quad| ray.meets(q.corner, q.u, q.v).is_some_and(|(_, inside)| inside > -edge);
        if inside < edge || shade.is_some_and(hidden) {
            continue;
        }
        let Some(mut expected) = closed_form(&light, p) else { continue };
        if let Some(shade) = shade
            && let Some((_, inside)) = shadow_ray(&light, p).meets(shade.corner, shade.u, shade.v)
        {
            if inside.abs() < edge {
                continue;
            }
            if inside > 0.0 {
                expected = Vec3::ZERO;
            }
        }
        if expected == Vec3::ZERO {
            dark += 1
        } else {
            lit += 1
        }
        let error = (seen[n] - expected).abs();
        if error.cmpgt(0.01 * expected).any() {
            faults.push(format!("at {p:.3}: {:.5} instead of {expected:.5}", seen[n]));
        }
    }
    let enough = if shade.is_some() { 150 } else { 0 };
    if lit < 1000 || dark < enough {
        return Err(format!("only {lit} lit and {dark} dark pixels were judged").into());
    }
    match faults.first() {
        Some(first) => Err(format!("{} of {} pixels, first {first}", faults.len(), lit + dark).into()),
        None => Ok(()),
    }
}

/// The seams between its six views must not show; the coarser its maps, the wider a seam would be.
fn point_lights(gpu: &Gpu) -> Result<(), Failed> {
    for (n, shadow_size) in [(0, 1024), (1, 64), (3, 128), (5, 256), (7, 512)] {
        let n = n as f32;
        let position = Vec3::new(0.17 * n - 0.6, 0.35 + 0.07 * n, 0.5 - 0.11 * n);
        let checked = check_with(
            gpu,
            Light::Point { position, intensity: Vec3::ONE },
            None,
            (Settings { shadow_size, ..small() }, EDGE),
        );
        checked.map_err(|e| format!("map of {shadow_size}: {}", e.message().unwrap_or_default()))?;
    }
    Ok(())
}

fn lights_add_up(gpu: &Gpu) -> Result<(), Failed> {
    let render = |lights: &[Light]| {
        let mut scene = Scene { lights: lights.to_vec(), ..Scene::default() };
        add(&mut scene, Material::matte("plane", ALBEDO), &[Quad::level(Vec3::ZERO, PLANE_SIDE)]);
        picture(gpu, &scene, &camera(), Settings { layer: Layer::Direct, ..small() })
    };
    let alone = [render(&[SUN])?, render(&[POINT])?, render(&[SPOT])?];
    let together = render(&[SUN, POINT, SPOT])?;
    for (n, sum) in together.iter().enumerate() {
        let expected: Vec3 = alone.iter().map(|picture| picture[n]).sum();
        // Three blends of half floats.
        assert!((*sum - expected).abs().cmple(0.002 * expected).all(), "{sum} {expected}");
    }
    Ok(())
}
