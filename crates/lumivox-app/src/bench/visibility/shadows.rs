//! Soft shadows on a floor, on the device (Figures 42 to 45).

use anyhow::Result;
use glam::Vec3;
use lumivox::visibility::ShadowLight;
use lumivox_field::{Ray, Settings, Sphere};

use super::corner::rms;
use super::floor::{Floor, Placed, TRUE_RAYS, baker_of, row, side, sizes};
use super::models::Model;
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

/// Figure 42: three lights, 20 rays each.
const FIGURE_42: [(u32, u32, [f64; 2]); 8] = [
    (1090, 32, [347.0, 6.00]),
    (1090, 64, [347.7, 4.85]),
    (1090, 128, [348.1, 4.66]),
    (4226, 32, [348.0, 5.95]),
    (4226, 64, [348.5, 4.82]),
    (4226, 128, [348.7, 4.44]),
    (16642, 32, [348.5, 5.94]),
    (16642, 64, [348.6, 4.80]),
];

/// Figures 42 to 44.
pub(super) fn shadows(timer: &Timer<'_>, model: &Model, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Soft shadows on the device (Figures 42 to 44)");
    let side = side(quick);
    report.say(&format!(
        "{} under a ball of light of a fifth of its radius, 20 rays per pixel, denoised, {side} x {side} pixels: milliseconds / RMS error in grey \
         levels of 255 beside {TRUE_RAYS} true rays. In parentheses the papers' bunny, three lights, with primary rays that take most of \
         the time.",
        model.title()
    ));
    let baker = baker_of(model)?;
    let Sphere { center, radius } = baker.sphere();
    let floor = Floor::new(timer.gpu, baker.sphere(), side)?;
    let (position, size) = (center + radius * Vec3::new(1.5, 4.0, 1.0), 0.2 * radius);
    let to_light = |n: usize, p: Vec3| {
        let way = position - p;
        let (x, y) = way.normalize_or(Vec3::Y).any_orthonormal_pair();
        (0..TRUE_RAYS).map(move |i| {
            let out = size * ((i as f32 + 0.5) / TRUE_RAYS as f32).sqrt();
            let (sin, cos) = (2.399_963 * i as f32 + n as f32).sin_cos();
            (Ray::new(p, way + out * (cos * x + sin * y)), 1.0)
        })
    };
    let truth = floor.truth(&baker, to_light);
    let light = ShadowLight::Ball { position, radius: size };
    let mut lines = Vec::new();
    for &(points, directions) in sizes(quick) {
        let (_, field, _) = model.baked(Settings { points, directions, ..Settings::default() })?;
        let (time, found) = Placed::new(timer.gpu, &[&field])?.shadow(timer, &floor, light, 20)?;
        let error = rms(&found, &truth);
        let case = format!("{points} x {directions} x {directions}");
        let paper = FIGURE_42.iter().find(|(p, d, _)| (*p, *d) == (points, directions)).map(|(.., v)| *v);
        let beside = paper.map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
        lines.push(vec![case.clone(), format!("{} / {error:.3}{beside}", ms(time.ms))]);
        report.push(row("Figure 42", case.clone(), "time", time.ms, "ms", paper.map(|p| p[0])));
        report.push(row("Figure 42", case, "RMS", error, "grey levels", paper.map(|p| p[1])));
    }
    report.table(&["field", "ms / RMS"].map(str::to_owned), &lines);
    Ok(())
}
