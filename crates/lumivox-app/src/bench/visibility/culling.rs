//! What pixels cost that no object reaches, and many objects.

use anyhow::Result;
use glam::{Mat4, Vec3};
use lumivox::visibility::{
    Fields, HitLight, Objects, Occlusion, OcclusionSettings, Placement, ReflectionSettings, Reflections,
    ShadowLight, ShadowSettings, SoftShadows,
};
use lumivox_field::Settings;

use super::models::Model;
use super::surface::{Surface, row, side};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// A few objects of some size, spread over the floor's picture.
fn spread(model_center: Vec3, radius: f32, floor: &Surface, count: u32, scale: f32) -> Vec<Placement> {
    let size = floor.size;
    let per_side = (count as f32).sqrt().ceil() as u32;
    let cell = size / per_side.max(1);
    (0..count)
        .map(|n| {
            let place = cell * glam::UVec2::new(n % per_side, n / per_side) + cell / 2;
            let p = floor.points[(place.x + size.x * place.y) as usize];
            let middle = p + 1.02 * scale * radius * Vec3::Y;
            let world = Mat4::from_translation(middle)
                * Mat4::from_scale(Vec3::splat(scale))
                * Mat4::from_translation(-model_center);
            Placement::new(0, world, n)
        })
        .collect()
}

/// Tiles and milliseconds by number and size of objects.
pub(super) fn culling(timer: &Timer<'_>, model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Pixels that no object reaches");
    let gpu = timer.gpu;
    let side = side(quick);
    let tiles = (side / 8) * (side / 8);
    report.say(&format!(
        "{} at several sizes and numbers over a floor of {side} x {side} pixels, 16 rays each for occlusion and for a lamp's shadow and 4 for a polished \
         floor (roughness 0.1), denoised: tiles that are drawn, of {tiles}, and milliseconds. Scale 1 is that of the figures. The papers \
         drew every pixel for every object.",
        model.title()
    ));
    let points = if quick { 290 } else { 4226 };
    let (_, field, _) = model.baked(Settings { points, normals: true, ..Settings::default() })?;
    let sphere = field.sphere();
    let Some(packed) = field.packed() else { return Ok(()) };
    let fields = Fields::new(gpu, &[&packed])?;
    let floor = Surface::floor(gpu, sphere, side)?;
    let receiver = floor.receiver();
    let mut objects = Objects::new(gpu, 256)?;
    // What covers less than 1 % of a hemisphere is left out.
    let settings = OcclusionSettings { least_share: 0.01, ..OcclusionSettings::default() };
    let mut occlusion = Occlusion::new(gpu, floor.size, &objects, settings)?;
    let mut shadows = SoftShadows::new(gpu, floor.size, &objects, 1, ShadowSettings::default())?;
    let polished = ReflectionSettings { roughness: 0.1, ..ReflectionSettings::default() };
    let mut reflections = Reflections::new(gpu, floor.size, &objects, polished)?;
    let lamp = ShadowLight::Ball {
        position: sphere.center + sphere.radius * Vec3::new(1.0, 4.0, 1.0),
        radius: 0.1 * sphere.radius,
    };
    let light = HitLight { above: Vec3::ONE, below: Vec3::splat(0.3), lamps: Vec::new(), shadows: false };
    let cases: &[(u32, f32)] =
        &[(0, 1.0), (1, 1.0), (1, 0.5), (1, 0.2), (1, 0.05), (16, 0.05), (64, 0.05), (256, 0.05)];
    let mut lines = Vec::new();
    for &(count, scale) in cases {
        let placements = spread(sphere.center, sphere.radius, &floor, count, scale);
        objects.update(gpu, &fields, &placements)?;
        occlusion.update(gpu, &objects);
        shadows.update(gpu, &objects, &[lamp]);
        reflections.update(gpu, &objects, &light);
        let times = [
            timer.median(|| timer.submit(|e| occlusion.record(gpu, e, &fields, &objects, &receiver)))?,
            timer.median(|| timer.submit(|e| shadows.record(gpu, e, &fields, &objects, &receiver)))?,
            timer.median(|| {
                timer.submit(|e| reflections.record(gpu, e, &fields, &objects, &receiver, None))
            })?,
        ];
        let drawn = [
            occlusion.read_drawn_tiles(gpu)?,
            shadows.read_drawn_tiles(gpu, 0)?,
            reflections.read_drawn_tiles(gpu)?,
        ];
        let case = format!("{count} of scale {scale}");
        let mut line = vec![case.clone()];
        for ((what, drawn), time) in ["occlusion", "shadow", "reflection"].into_iter().zip(drawn).zip(times) {
            line.push(format!("{drawn} / {}", ms(time.ms)));
            report.push(row("culling", case.clone(), what, time.ms, "ms", None));
            report.push(row("culling", case.clone(), what, f64::from(drawn), "tiles", None));
        }
        lines.push(line);
    }
    let header = ["objects", "occlusion: tiles / ms", "shadow: tiles / ms", "reflection: tiles / ms"];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}
