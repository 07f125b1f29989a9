//! Pictures by the small ray tracer, with true secondary rays and with look-ups (4.5.2, Figure 45).

use anyhow::Result;
use glam::{Affine3A, Vec3};
use image::{Rgb, RgbImage};
use lumivox_field::{Baker, Field, Ray, Settings};
use rayon::prelude::*;

use super::models::Model;
use super::surface::{STRIDE, row};
use super::tracer::{Body, Counts, Lamp, Met, Rays, Secondary, World};
use crate::bench::report::{Report, ms};
use crate::clock;
use crate::sheet::contact_sheet;

/// The papers' milliseconds per shadow ray: by look-ups, and by their tree.
const PAPER_MS_PER_RAY: [f64; 2] = [1.9323e-4, 5.682e-2];

const PAINTS: [Vec3; 3] = [Vec3::new(0.75, 0.62, 0.5), Vec3::new(0.45, 0.6, 0.75), Vec3::new(0.6, 0.7, 0.45)];

/// The papers' rays, and those of the reference.
const RAYS: Rays = Rays { shadow: 20, polish: 4 };
const REFERENCE: Rays = Rays { shadow: 256, polish: 64 };

/// A pixel's first hit and the way to it.
type Pixel = Option<(Met, Vec3)>;

/// The colours of all pixels, milliseconds, and the rays.
fn shaded(world: &World<'_>, pixels: &[Pixel], by: Secondary) -> (Vec<Vec3>, f64, Counts) {
    let begun = clock::millis();
    let at = |(n, pixel): (usize, &Pixel)| {
        let mut counts = Counts::default();
        let color = pixel
            .map_or(Vec3::splat(world.sky), |(met, way)| world.shaded(&met, way, n as u32, by, &mut counts));
        (color, counts)
    };
    let all: Vec<_> = pixels.par_iter().enumerate().with_min_len(64).map(at).collect();
    let time = clock::millis() - begun;
    let sum = all.iter().fold(Counts::default(), |sum, (_, c)| Counts {
        shadow: sum.shadow + c.shadow,
        reflected: sum.reflected + c.reflected,
    });
    (all.into_iter().map(|(color, _)| color).collect(), time, sum)
}

fn encoded(color: Vec3) -> Rgb<u8> {
    Rgb(color.clamp(Vec3::ZERO, Vec3::ONE).powf(1.0 / 2.2).to_array().map(|v| (255.0 * v) as u8))
}

/// Grey levels of 255 as shown.
fn rms(a: &[Vec3], b: &[Vec3]) -> f64 {
    let shown = |v: &Vec3| Vec3::from(encoded(*v).0.map(f32::from));
    let sum: f64 =
        a.iter().zip(b).map(|(a, b)| f64::from((shown(a) - shown(b)).length_squared()) / 3.0).sum();
    (sum / a.len().max(1) as f64).sqrt()
}

/// A model's tree and field, and where it stands: its lowest point on the floor, of radius 1.
fn placed(model: &Model, settings: Settings, at: Vec3, turned: f32) -> Result<(Baker, Field, Affine3A)> {
    let (baker, field, _) = model.baked(settings)?;
    let sphere = baker.sphere();
    let mesh = model.object.mesh();
    let low = mesh.triangles.bounds().min.y;
    let foot = Vec3::new(sphere.center.x, low, sphere.center.z);
    let world_from_object = Affine3A::from_translation(at)
        * Affine3A::from_rotation_y(turned)
        * Affine3A::from_scale(Vec3::splat(1.0 / sphere.radius))
        * Affine3A::from_translation(-foot);
    Ok((baker, field, world_from_object.inverse()))
}

/// The picture, its errors and its rays.
pub(super) fn traced(models: &[Model], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Secondary rays of a ray tracer (4.5.2 and Figure 45)");
    let size = if quick { [160, 100] } else { [420, 260] };
    let points = if quick { 290 } else { 4226 };
    let settings = Settings { points, normals: true, ..Settings::default() };
    let places = [Vec3::new(-1.5, 0.0, 0.1), Vec3::new(0.35, 0.0, -0.9), Vec3::new(1.5, 0.0, 0.7)];
    let turns = [0.4, -0.7, 0.9];
    let mut bodies = Vec::new();
    for ((model, at), turned) in models.iter().cycle().zip(places).zip(turns) {
        bodies.push(placed(model, settings, at, turned)?);
    }
    let lamp = |x: f32, y: f32, z: f32| Lamp { position: Vec3::new(x, y, z), radius: 0.25, intensity: 14.0 };
    let mut world = World {
        bodies: bodies
            .iter()
            .zip(PAINTS)
            .map(|((baker, field, object_from_world), albedo)| Body {
                baker,
                field,
                object_from_world: *object_from_world,
                albedo,
            })
            .collect(),
        lamps: vec![lamp(-3.0, 4.0, 3.0), lamp(3.5, 4.5, 2.0), lamp(0.5, 5.0, -3.5)],
        floor: Vec3::splat(0.55),
        reflectance: 0.35,
        sky: 0.25,
        rays: RAYS,
    };
    let (eye, target) = (Vec3::new(0.2, 1.9, 5.2), Vec3::new(0.05, 0.55, 0.0));
    let forward = (target - eye).normalize_or(Vec3::NEG_Z);
    let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(forward);
    let ways: Vec<Vec3> = (0..size[0] * size[1])
        .map(|n| {
            let [x, y] = [n % size[0], n / size[0]].map(|v| v as f32 + 0.5);
            let half = 0.36 / size[1] as f32;
            let across = (2.0 * x - size[0] as f32) * half;
            let upwards = (size[1] as f32 - 2.0 * y) * half;
            (forward + across * right + upwards * up).normalize_or(forward)
        })
        .collect();
    let begun = clock::millis();
    let pixels: Vec<Pixel> = ways
        .par_iter()
        .with_min_len(64)
        .map(|way| world.primary(&Ray::new(eye, *way)).map(|met| (met, *way)))
        .collect();
    let primary = clock::millis() - begun;
    let (exact, true_ms, counts) = shaded(&world, &pixels, Secondary::True);
    let (looked, look_ms, same) = shaded(&world, &pixels, Secondary::LookedUp);
    let rays = [counts.shadow + counts.reflected, same.shadow + same.reflected];
    // Of every few pixels only, since each takes hundreds of thousands of rays.
    let is_chosen = |n: &usize| {
        let [x, y] = [*n as u32 % size[0], *n as u32 / size[0]];
        x.is_multiple_of(STRIDE) && y.is_multiple_of(STRIDE)
    };
    let chosen: Vec<usize> = (0..pixels.len()).filter(is_chosen).collect();
    world.rays = if quick { Rays { shadow: 256, polish: 16 } } else { REFERENCE };
    let of = |pixels: &[Pixel]| chosen.iter().map(|&n| pixels[n]).collect::<Vec<_>>();
    let (reference, ..) = shaded(&world, &of(&pixels), Secondary::True);
    let beside = |colors: &[Vec3]| rms(&chosen.iter().map(|&n| colors[n]).collect::<Vec<_>>(), &reference);
    let errors = [beside(&exact), beside(&looked)];
    let error = rms(&looked, &exact);
    let names: Vec<_> = models.iter().cycle().take(3).map(|m| m.name.as_str()).collect();
    report.say(&format!(
        "{} on a polished floor below three lamps of radius 0.25, {} x {} pixels, on the CPU's threads: primary rays meet triangles in {} ms; then each \
         point has 20 shadow rays to each lamp, and each of the floor 4 reflected rays with 10 more. RMS errors of the picture in \
         grey levels of 255 are beside a reference of true rays, {} to each lamp and {} reflected, in every {STRIDE}th pixel along x and y. Fields of {points} x 64 x 64 bytes \
         with normals. The papers' numbers, of a GPU, in parentheses.",
        names.join(", "),
        size[0],
        size[1],
        ms(primary),
        world.rays.shadow,
        world.rays.polish
    ));
    let of = |time: f64, rays: u64, paper: f64| {
        let each = time / rays.max(1) as f64;
        vec![
            ms(time),
            format!("{:.2}", rays as f64 / 1e6),
            format!("{each:.2e} ({paper:.2e})"),
            format!("{:.2}", 1e-3 / each),
        ]
    };
    let lines = [
        [
            vec!["true rays".to_owned()],
            of(true_ms, rays[0], PAPER_MS_PER_RAY[1]),
            vec![format!("{:.2}", errors[0]), String::new()],
        ]
        .concat(),
        [
            vec!["look-ups".to_owned()],
            of(look_ms, rays[1], PAPER_MS_PER_RAY[0]),
            vec![format!("{:.2}", errors[1]), format!("{error:.2}")],
        ]
        .concat(),
    ];
    let header =
        ["secondary rays", "ms", "million", "ms a ray", "million/s", "RMS", "RMS beside as many true rays"];
    report.table(&header.map(str::to_owned), &lines);
    let case = names.join(", ");
    let numbers = [
        ("primary rays", primary, "ms", None),
        ("true secondary rays", true_ms, "ms", None),
        ("looked-up secondary rays", look_ms, "ms", None),
        ("true rays", true_ms / rays[0].max(1) as f64, "ms/ray", Some(PAPER_MS_PER_RAY[1])),
        ("look-ups", look_ms / rays[1].max(1) as f64, "ms/ray", Some(PAPER_MS_PER_RAY[0])),
        ("RMS of true rays", errors[0], "grey levels", None),
        ("RMS of look-ups", errors[1], "grey levels", None),
        ("RMS beside as many true rays", error, "grey levels", None),
    ];
    for (metric, value, unit, paper) in numbers {
        report.push(row("Figure 45", case.clone(), metric, value, unit, paper));
    }
    let picture = |colors: &dyn Fn(usize) -> Vec3| {
        RgbImage::from_fn(size[0], size[1], |x, y| encoded(colors((x + size[0] * y) as usize)))
    };
    let apart = RgbImage::from_fn(size[0], size[1], |x, y| {
        let n = (x + size[0] * y) as usize;
        let [a, b] = [&looked, &exact].map(|all| encoded(all[n]).0);
        Rgb([0, 1, 2].map(|c| a[c].abs_diff(b[c]).saturating_mul(5)))
    });
    let pictures = vec![picture(&|n| looked[n]), picture(&|n| exact[n]), apart];
    let titles = ["look-ups", "true rays", "apart, x 5"];
    report.picture(
        "traced",
        "A ray tracer with looked-up secondary rays",
        &contact_sheet(&[("4.5.2", pictures)], &titles),
    )
}
