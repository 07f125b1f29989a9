//! What a polished floor mirrors, on the device (Figures 46 and 47).

use anyhow::Result;
use glam::Vec3;
use half::f16;
use image::{Rgb, RgbImage};
use lumivox::gpu::read_texture;
use lumivox::visibility::{HitLamp, HitLight, ReflectionSettings, Reflections};
use lumivox_field::{Baker, Ray, Settings};
use rayon::prelude::*;

use super::corner::rms;
use super::lobe;
use super::models::Model;
use super::surface::{Placed, Surface, TRUE_RAYS, baker_of, row, side};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;
use crate::clock;
use crate::sheet::contact_sheet;

/// Figures 46 and 47: bits of each, milliseconds, RMS error; and the reference's milliseconds.
const FIGURE_46: [[f64; 2]; 2] = [[440.0, 4.555], [441.0, 4.480]];
const FIGURE_47: [[f64; 2]; 2] = [[1897.0, 9.392], [1900.0, 8.137]];
const REFERENCES: [f64; 2] = [5530.0, 112_910.0];
/// The papers' rays per reflective pixel.
const RAYS: u32 = 4;
/// Of brushed metal.
const ROUGHNESS: f32 = 0.25;
/// Pixels along a side of the pictures.
const SHOWN: u32 = 240;

/// The light on what is mirrored, by the object's size.
fn light(center: Vec3, radius: f32) -> HitLight {
    let position = center + radius * Vec3::new(2.5, 1.5, 3.0);
    let lamp = HitLamp::Point { position, intensity: Vec3::splat(18.0 * radius * radius) };
    HitLight { above: Vec3::splat(0.5), below: Vec3::splat(0.2), lamps: vec![lamp], shadows: true }
}

/// Radiance that true rays find along a way from a point of the floor.
fn seen(baker: &Baker, light: &HitLight, ray: &Ray) -> f32 {
    let Some((distance, normal)) = baker.trace_with_normal(ray) else { return 0.0 };
    let p = ray.at(distance) + 1e-4 * baker.sphere().radius * normal;
    let mut radiance = light.below.lerp(light.above, 0.5 + 0.5 * normal.y).x;
    for lamp in &light.lamps {
        let HitLamp::Point { position, intensity } = *lamp else { continue };
        let way = position - p;
        let facing = normal.dot(way).max(0.0) / way.length().powi(3);
        if facing > 0.0 && baker.trace(&Ray::new(p, way)).is_none_or(|d| d > 1.0) {
            radiance += facing * intensity.x / std::f32::consts::PI;
        }
    }
    radiance
}

/// What true rays find that a pixel of the floor mirrors.
fn mirrored(baker: &Baker, light: &HitLight, floor: &Surface, n: usize, rays: u32, roughness: f32) -> f64 {
    let p = floor.points[n];
    let way = (p - floor.eye).normalize_or(Vec3::NEG_Y);
    let (mut sum, mut sent) = (0.0, 0.0);
    for unit in lobe::square(rays, n as u32) {
        let (out, weight) = lobe::ray(Vec3::Y, way, roughness, unit);
        sent += weight;
        sum += if weight > 0.0 { weight * seen(baker, light, &Ray::new(p, out)) } else { 0.0 };
    }
    f64::from(sum / sent.max(1e-20))
}

/// Red of all pixels, and milliseconds.
fn looked_up(
    timer: &Timer<'_>,
    placed: &Placed,
    floor: &Surface,
    light: &HitLight,
    denoise: bool,
) -> Result<(f64, Vec<f64>)> {
    let gpu = timer.gpu;
    let settings = ReflectionSettings { rays: RAYS, roughness: ROUGHNESS, denoise, blended: false };
    let mut reflections = Reflections::new(gpu, floor.size, &placed.objects, settings)?;
    reflections.update(gpu, &placed.objects, light);
    let (fields, objects, receiver) = (&placed.fields, &placed.objects, floor.receiver());
    let time =
        timer.median(|| timer.submit(|e| reflections.record(gpu, e, fields, objects, &receiver, None)))?;
    let texels: Vec<[f16; 4]> = read_texture(gpu, reflections.color())?;
    Ok((time.ms, texels.iter().map(|t| t[0].to_f64()).collect()))
}

fn grey(values: &[f64]) -> RgbImage {
    RgbImage::from_fn(SHOWN, SHOWN, |x, y| {
        let value = values.get((x + SHOWN * y) as usize).copied().unwrap_or(0.0);
        Rgb([(255.0 * value.clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8; 3])
    })
}

/// Figures 46 and 47.
pub(super) fn reflections(
    timer: &Timer<'_>,
    models: &[Model],
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    report.head("Polished reflections on the device (Figures 46 and 47)");
    let side = side(quick);
    report.say(&format!(
        "A floor of roughness {ROUGHNESS} below each model, {RAYS} rays for each of {side} x {side} pixels; what is met has the field's normals and is lit by \
         a sky and a lamp with shadows. Milliseconds, and RMS error in grey levels of 255 (a white surface under the sky alone has \
         128) beside {TRUE_RAYS} true rays of the same lobe: of {RAYS} rays as they come, as the papers show them, and denoised; beside \
         a perfect mirror by true rays; and of {RAYS} true rays, with the milliseconds that they take on the CPU's threads. In \
         parentheses the papers', whose primary rays are in the time, and whose fields keep floats."
    ));
    let sizes = if quick { [(290, 32), (1090, 64)] } else { [(4226, 32), (4226, 64)] };
    let (mut lines, mut rows) = (Vec::new(), Vec::new());
    let is_shown = |model: &&Model| ["Bunny", "Elephant"].contains(&model.name.as_str());
    let chosen = models.iter().filter(is_shown).count();
    for model in models.iter().filter(|model| chosen == 0 || is_shown(model)).take(2) {
        let baker = baker_of(model)?;
        let sphere = baker.sphere();
        let light = light(sphere.center, sphere.radius);
        let floor = Surface::floor(timer.gpu, sphere, side)?;
        let chosen = floor.chosen();
        let true_ones = |rays: u32, roughness: f32| -> Vec<f64> {
            chosen.par_iter().map(|&n| mirrored(&baker, &light, &floor, n, rays, roughness)).collect()
        };
        let truth = true_ones(TRUE_RAYS, ROUGHNESS);
        let begun = clock::millis();
        let few = true_ones(RAYS, ROUGHNESS);
        let true_ms = (clock::millis() - begun) * floor.points.len() as f64 / chosen.len().max(1) as f64;
        let mirror = true_ones(1, 0.0);
        let paper = match model.name.as_str() {
            "Bunny" => Some(("Figure 46", FIGURE_46, REFERENCES[0])),
            "Elephant" => Some(("Figure 47", FIGURE_47, REFERENCES[1])),
            _ => None,
        };
        let mut shown = Vec::new();
        for (n, (points, directions)) in sizes.into_iter().enumerate() {
            let (_, field, _) =
                model.baked(Settings { points, directions, normals: true, ..Settings::default() })?;
            let placed = Placed::new(timer.gpu, &[&field])?;
            let of_chosen = |all: &[f64]| -> Vec<f64> { chosen.iter().map(|&n| all[n]).collect() };
            let (time, noisy) = looked_up(timer, &placed, &floor, &light, false)?;
            let (smooth_time, smooth) = looked_up(timer, &placed, &floor, &light, true)?;
            let (noisy, smooth) = (of_chosen(&noisy), of_chosen(&smooth));
            let errors =
                [rms(&noisy, &truth), rms(&smooth, &truth), rms(&smooth, &mirror), rms(&few, &truth)];
            let theirs = paper.map(|(_, values, _)| values[n]);
            let beside = |value: String, n: usize| match theirs {
                Some(theirs) => format!("{value} ({})", theirs[n]),
                None => value,
            };
            let mib = field.bytes() as f64 / f64::from(1 << 20);
            let reference = paper.map_or(String::new(), |(.., reference)| format!(" ({reference})"));
            lines.push(vec![
                format!("{}, {points} x {directions} x {directions}", model.title()),
                format!("{mib:.1}"),
                format!("{} / {}", beside(ms(time), 0), ms(smooth_time)),
                format!("{} / {:.2}", beside(format!("{:.2}", errors[0]), 1), errors[1]),
                format!("{:.2}", errors[2]),
                format!("{}{reference} / {:.2}", ms(true_ms), errors[3]),
            ]);
            let figure = paper.map_or("Figure 46", |(figure, ..)| figure);
            let case = format!("{}, {points} x {directions} x {directions}", model.title());
            let numbers = [
                ("time", time, "ms", theirs.map(|p| p[0])),
                ("time, denoised", smooth_time, "ms", None),
                ("RMS", errors[0], "grey levels", theirs.map(|p| p[1])),
                ("RMS, denoised", errors[1], "grey levels", None),
                ("RMS beside a mirror", errors[2], "grey levels", None),
                ("RMS of as many true rays", errors[3], "grey levels", None),
                ("time of as many true rays, CPU", true_ms, "ms", paper.map(|(.., reference)| reference)),
            ];
            for (metric, value, unit, paper) in numbers {
                report.push(row(figure, case.clone(), metric, value, unit, paper));
            }
            if n + 1 == sizes.len() {
                let small = Surface::floor(timer.gpu, sphere, SHOWN)?;
                let all: Vec<usize> = (0..small.points.len()).collect();
                let traced = |rays: u32, roughness: f32| -> Vec<f64> {
                    let of = |&n: &usize| mirrored(&baker, &light, &small, n, rays, roughness);
                    all.par_iter().map(of).collect()
                };
                shown.push(grey(&looked_up(timer, &placed, &small, &light, false)?.1));
                shown.push(grey(&looked_up(timer, &placed, &small, &light, true)?.1));
                shown.push(grey(&traced(if quick { 16 } else { 64 }, ROUGHNESS)));
                shown.push(grey(&traced(1, 0.0)));
            }
        }
        rows.push((model.name.as_str(), shown));
    }
    let header = [
        "field",
        "MiB with normals",
        "ms / denoised",
        "RMS / denoised",
        "RMS beside a mirror",
        "true rays: ms / RMS",
    ];
    report.table(&header.map(str::to_owned), &lines);
    let titles = ["4 rays", "denoised", "true rays", "true mirror"];
    report.picture("reflections", "What polished floors mirror", &contact_sheet(&rows, &titles))
}
