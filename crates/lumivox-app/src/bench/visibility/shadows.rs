//! Soft shadows on a floor, on the device (Figures 42 to 44).

use std::f32::consts::TAU;

use anyhow::{Context, Result};
use glam::Vec3;
use lumivox::visibility::{ShadowLight, ShadowSettings};
use lumivox_field::{Baker, Ray, Settings, Sphere};

use super::corner::rms;
use super::lobe;
use super::models::Model;
use super::surface::{Placed, Surface, TRUE_RAYS, baker_of, row, side};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;
use crate::clock;

/// The papers' rays per pixel and light.
const RAYS: u32 = 20;

/// Figure 42: three lights.
const FIGURE_42: [(u32, u32, [f64; 2]); 9] = [
    (1090, 32, [347.0, 6.00]),
    (1090, 64, [347.7, 4.85]),
    (1090, 128, [348.1, 4.66]),
    (1090, 256, [348.5, 4.59]),
    (4226, 32, [348.0, 5.95]),
    (4226, 64, [348.5, 4.82]),
    (4226, 128, [348.7, 4.44]),
    (16642, 32, [348.5, 5.94]),
    (16642, 64, [348.6, 4.80]),
];
/// Figure 43: milliseconds of its reference.
const FIGURE_43: f64 = 913_210.0;
/// Figure 44: a horse and one light.
const FIGURE_44: [(u32, u32, [f64; 2]); 4] = [
    (1090, 64, [321.6, 4.701]),
    (1090, 128, [321.7, 4.212]),
    (4226, 64, [321.8, 4.364]),
    (4226, 128, [322.7, 3.815]),
];

/// A figure: its fields with the papers' numbers, and its lights.
struct Figure<'m> {
    name: &'static str,
    model: &'m Model,
    lights: &'m [ShadowLight],
    fields: Vec<(u32, u32, Option<[f64; 2]>)>,
}

/// Figures 42 to 44, and lights of other shapes.
pub(super) fn shadows(timer: &Timer<'_>, models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Soft shadows on the device (Figures 42 to 44)");
    let model = models.first().context("a model")?;
    let side = side(quick);
    report.say(&format!(
        "A floor of {side} x {side} pixels below a model and lamps of a fifth of its radius, {RAYS} rays per pixel and lamp: milliseconds / RMS \
         error in grey levels of 255 beside {TRUE_RAYS} true rays to each lamp. In parentheses the papers', which show the models' own \
         surfaces close up, with primary rays that take most of the time."
    ));
    let few = [(290, 32, None), (1090, 64, None)];
    let lights = |model: &Model| -> Result<[ShadowLight; 3]> { Ok(lamps(baker_of(model)?.sphere())) };
    let all = lights(model)?;
    let theirs =
        |figure: &[(u32, u32, [f64; 2])]| figure.iter().map(|(p, d, v)| (*p, *d, Some(*v))).collect();
    let fields = if quick { few.to_vec() } else { theirs(&FIGURE_42) };
    figure(timer, side, report, &Figure { name: "Figure 42", model, lights: &all, fields })?;
    if let Some(horse) = models.iter().find(|m| m.name == "Horse") {
        let one = &lights(horse)?[..1];
        figure(
            timer,
            side,
            report,
            &Figure { name: "Figure 44", model: horse, lights: one, fields: theirs(&FIGURE_44) },
        )?;
    }
    report.say("Lamps of other shapes: a rectangle, and a sun of 3 degrees. Spot lights are balls whose cone the host's light has.");
    let Sphere { center, radius } = baker_of(model)?.sphere();
    let rect = ShadowLight::Rect {
        origin: center + radius * Vec3::new(0.7, 4.0, 0.4),
        u: 0.8 * radius * Vec3::X,
        v: 0.4 * radius * Vec3::Z,
    };
    let sun = ShadowLight::Sun { direction: Vec3::new(-0.4, -1.0, -0.3), angle: 1.5f32.to_radians() };
    for (name, light) in [("rectangle", rect), ("sun", sun)] {
        let size = if quick { (1090, 64) } else { (4226, 64) };
        let fields = vec![(size.0, size.1, None)];
        figure(timer, side, report, &Figure { name, model, lights: &[light], fields })?;
    }
    Ok(())
}

/// Three lamps above an object.
fn lamps(Sphere { center, radius }: Sphere) -> [ShadowLight; 3] {
    let at = |x: f32, y: f32, z: f32| ShadowLight::Ball {
        position: center + radius * Vec3::new(x, y, z),
        radius: 0.2 * radius,
    };
    [at(1.5, 4.0, 1.0), at(-2.0, 3.5, 0.5), at(0.3, 4.5, -2.0)]
}

fn figure(timer: &Timer<'_>, side: u32, report: &mut Report, figure: &Figure<'_>) -> Result<()> {
    let Figure { name, model, lights, fields } = figure;
    let baker = baker_of(model)?;
    let surface = Surface::floor(timer.gpu, baker.sphere(), side)?;
    let begun = clock::millis();
    let truth = truth(&baker, &surface, lights);
    let shown = surface.points.len() as f64 / truth.len().max(1) as f64;
    let true_ms = (clock::millis() - begun) * shown * 256.0 / f64::from(TRUE_RAYS);
    let mut lines = Vec::new();
    for (points, directions, paper) in fields {
        let settings = Settings { points: *points, directions: *directions, ..Settings::default() };
        let (_, field, _) = model.baked(settings)?;
        let placed = Placed::new(timer.gpu, &[&field])?;
        let settings = ShadowSettings { rays: RAYS, blended: false, denoise: false };
        let (time, found) = placed.shadow(timer, &surface, lights, settings)?;
        let denoised = ShadowSettings { denoise: true, ..settings };
        let (smooth_time, smooth) = placed.shadow(timer, &surface, lights, denoised)?;
        let (error, smooth) = (rms(&found, &truth), rms(&smooth, &truth));
        let case = format!("{}, {points} x {directions} x {directions}", model.name);
        let beside = paper.map_or(String::new(), |[a, b]| format!(" ({a} / {b})"));
        let mib = field.bytes() as f64 / f64::from(1 << 20);
        lines.push(vec![
            case.clone(),
            format!("{mib:.2}"),
            format!("{} / {error:.3}{beside}", ms(time.ms)),
            format!("{} / {smooth:.3}", ms(smooth_time.ms)),
        ]);
        report.push(row(name, case.clone(), "time", time.ms, "ms", paper.map(|p| p[0])));
        report.push(row(name, case.clone(), "RMS", error, "grey levels", paper.map(|p| p[1])));
        report.push(row(name, case, "RMS, denoised", smooth, "grey levels", None));
    }
    let paper = (*name == "Figure 42" && model.name == "Bunny").then_some(FIGURE_43);
    let beside = paper.map_or(String::new(), |paper| format!(" ({paper})"));
    lines.push(vec![
        "256 true rays, CPU".to_owned(),
        String::new(),
        format!("{}{beside}", ms(true_ms)),
        String::new(),
    ]);
    report.push(row(name, format!("{}, 256 true rays", model.name), "time", true_ms, "ms", paper));
    let count = lights.len();
    let plural = if count == 1 { "" } else { "s" };
    let header = [
        format!("{name}: {count} lamp{plural}"),
        "MiB".to_owned(),
        "ms / RMS".to_owned(),
        "denoised".to_owned(),
    ];
    report.table(&header, &lines);
    Ok(())
}

/// What true rays find of all lights, as the device weights them.
fn truth(baker: &Baker, surface: &Surface, lights: &[ShadowLight]) -> Vec<f64> {
    let mut mean = vec![0.0; surface.chosen().len()];
    for light in lights {
        let found = surface.truth(baker, |n, p, normal| {
            lobe::square(TRUE_RAYS, n as u32).map(move |unit| light_ray(light, p, normal, unit))
        });
        mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / lights.len() as f64);
    }
    mean
}

/// A ray to a point of a light, where it ends, and what it counts.
fn light_ray(light: &ShadowLight, p: Vec3, normal: Vec3, [s, t]: [f32; 2]) -> (Ray, f32, f32) {
    let disk = |toward: Vec3, radius: f32| {
        let (x, y) = toward.normalize_or(Vec3::Y).any_orthonormal_pair();
        let (sin, cos) = (TAU * t).sin_cos();
        toward + radius * s.sqrt() * (cos * x + sin * y)
    };
    let (way, ends, weight) = match *light {
        ShadowLight::Ball { position, radius } => (disk(position - p, radius), 1.0, 1.0),
        ShadowLight::Sun { direction, angle } => {
            (disk(-direction.normalize_or(Vec3::NEG_Y), angle.tan()), f32::INFINITY, 1.0)
        }
        ShadowLight::Rect { origin, u, v } => {
            let way = origin + s * u + t * v - p;
            let facing = u.cross(v).normalize_or(Vec3::Y).dot(-way).max(0.0) * normal.dot(way).max(0.0);
            (way, 1.0, facing / way.length_squared().powi(2))
        }
    };
    (Ray::new(p, way), ends, if normal.dot(way) > 0.0 { weight } else { 0.0 })
}
