//! Ambient occlusion of balls over a floor, against its closed forms.

use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::glam::{DVec3, Mat4, UVec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, GpuError, Tier, read_texture};
use lumivox::visibility::{Combine, Fields, Objects, Occlusion, OcclusionSettings, Placement, Receiver};
use lumivox_field::Settings;
use lumivox_oracle::closed_form::sphere_occlusion;

use super::objects::{Soup, ball};
use crate::picture::{Paint, Shape, Thing, lifted, ndc_of_texel};
use crate::support::{Shot, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("visibility: a ball over a floor takes its closed form", one_ball),
    ("visibility: two balls take their closed forms, and subtraction takes more", two_balls),
    ("visibility: an object takes light of itself", own),
    ("visibility: the falloff takes less from afar", falloff),
    ("visibility: pixels that no object reaches cost nothing", culling),
    ("visibility: a few of thousands of objects count as if they were alone", crowd),
    ("visibility: frames make nothing new, and the same picture every time", contract),
];

pub(super) const SIZE: UVec2 = UVec2::new(96, 72);

/// The floor y = 0 from above, without anything on it.
pub(super) fn floor(gpu: &Gpu) -> Result<Shot, GpuError> {
    let view = View::perspective(Vec3::new(0.0, 9.0, 7.0), Vec3::ZERO, Vec3::Y, 0.9, 96.0 / 72.0, 0.1, 60.0)
        .with_reversed_depth();
    let plane = Shape::Plane { point: DVec3::ZERO, normal: DVec3::Y };
    Shot::take(gpu, view, SIZE, &[Thing(plane, |_| Paint::default())])
}

/// The points that the pixels of the floor show.
pub(super) fn points(shot: &Shot) -> Vec<DVec3> {
    let texels = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| UVec2::new(x, y)));
    texels
        .zip(&shot.picture.depth)
        .map(|(texel, depth)| lifted(&shot.view, ndc_of_texel(texel, SIZE), *depth))
        .collect()
}

/// Balls: centre and radius.
type Balls<'b> = &'b [(Vec3, f32)];

struct Scene {
    fields: Fields,
    objects: Objects,
}

impl Scene {
    fn new(gpu: &Gpu, balls: Balls<'_>) -> Result<Self, GpuError> {
        let packed = ball().packed().expect("a field that fits");
        let fields = Fields::new(gpu, &[&packed])?;
        let mut objects = Objects::new(gpu, balls.len() as u32)?;
        let place = |(n, (center, radius)): (usize, &(Vec3, f32))| {
            let world_from_object = Mat4::from_translation(*center) * Mat4::from_scale(Vec3::splat(*radius));
            Placement::new(0, world_from_object, n as u32)
        };
        let all: Vec<_> = balls.iter().enumerate().map(place).collect();
        objects.update(gpu, &fields, &all)?;
        Ok(Self { fields, objects })
    }

    /// The factor of each pixel, and the tiles drawn.
    fn factors(
        &self,
        gpu: &Gpu,
        shot: &Shot,
        settings: OcclusionSettings,
    ) -> Result<(Vec<f64>, u32), GpuError> {
        let mut occlusion = Occlusion::new(gpu, SIZE, &self.objects, settings)?;
        occlusion.update(gpu, &self.objects);
        let receiver = Receiver::from(&shot.input);
        run(gpu, |e| occlusion.record(gpu, e, &self.fields, &self.objects, &receiver))?;
        let texels: Vec<half::f16> = read_texture(gpu, occlusion.factor())?;
        Ok((texels.iter().map(|t| t.to_f64()).collect(), occlusion.read_drawn_tiles(gpu)?))
    }
}

/// What a ball above the floor takes of a point's light.
fn taken(p: DVec3, (center, radius): (Vec3, f32)) -> f64 {
    let way = center.as_dvec3() - p;
    sphere_occlusion(f64::from(radius), way.length(), way.y / way.length())
}

/// Root mean square and largest difference.
fn differences(found: &[f64], expected: impl Iterator<Item = f64>) -> [f64; 2] {
    let all: Vec<f64> = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).collect();
    let square: f64 = all.iter().map(|d| d * d).sum();
    [(square / all.len() as f64).sqrt(), all.iter().copied().fold(0.0, f64::max)]
}

fn one_ball(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let ball = (Vec3::new(0.4, 1.6, -0.2), 1.3);
    let scene = Scene::new(gpu, &[ball])?;
    let points = points(&shot);
    let expected = || points.iter().map(|p| 1.0 - taken(*p, ball));
    let mut last = f64::INFINITY;
    for (rays, denoise, blended) in [(16, false, false), (16, true, false), (64, true, true)] {
        let settings = OcclusionSettings { rays, denoise, blended, ..OcclusionSettings::default() };
        let [rms, most] = differences(&scene.factors(gpu, &shot, settings)?.0, expected());
        eprintln!("{rays} rays, denoised {denoise}, blended {blended}: RMS {rms:.4}, most {most:.4}");
        assert!(rms < last, "{rms} after {last}");
        last = rms;
    }
    // Of light that goes from all to a third.
    assert!(last < 0.006, "{last}");
    let darkest = expected().fold(1.0, f64::min);
    assert!(darkest < 0.4, "{darkest}");
    Ok(())
}

fn two_balls(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let points = points(&shot);
    // Without denoising, which takes the mean over a good part of so small a picture's shadows.
    let settings =
        OcclusionSettings { rays: 256, blended: true, denoise: false, ..OcclusionSettings::default() };
    // Side by side, neither hides the other from the floor: both ways are the sum.
    let apart = [(Vec3::new(-1.6, 1.1, 0.0), 0.9), (Vec3::new(1.7, 1.3, 0.3), 0.8)];
    let scene = Scene::new(gpu, &apart)?;
    let near = |p: &DVec3| p.x.abs() < 4.0 && p.z.abs() < 3.0;
    for combine in [Combine::Nearest, Combine::Subtract] {
        let (found, _) = scene.factors(gpu, &shot, OcclusionSettings { combine, ..settings })?;
        let expected = points.iter().map(|p| 1.0 - apart.iter().map(|b| taken(*p, *b)).sum::<f64>());
        // Seen from far to the side one does hide the other.
        let pairs: Vec<_> = found.iter().zip(expected).zip(&points).filter(|(_, p)| near(p)).collect();
        let square: f64 = pairs.iter().map(|((a, b), _)| (*a - b).powi(2)).sum();
        let rms = (square / pairs.len() as f64).sqrt();
        eprintln!("side by side, {combine:?}: RMS {rms:.4} over {} pixels", pairs.len());
        assert!(rms < 0.012 && pairs.len() > 1500, "{rms}");
    }
    // Above each other, the lower one hides the upper from the floor beneath: the nearest hit is the lower ball's alone.
    let stacked = [(Vec3::new(0.0, 1.2, 0.0), 1.0), (Vec3::new(0.0, 4.0, 0.0), 1.2)];
    let scene = Scene::new(gpu, &stacked)?;
    let beneath: Vec<bool> = points.iter().map(|p| p.length() < 0.5).collect();
    let inside = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(&beneath).filter(|(_, inside)| **inside).map(|(v, _)| *v).collect()
    };
    let expected = |balls: Balls<'_>| -> Vec<f64> {
        let all: Vec<f64> = points
            .iter()
            .map(|p| (1.0 - balls.iter().map(|b| taken(*p, *b)).sum::<f64>()).max(0.0))
            .collect();
        inside(&all)
    };
    for (combine, counted) in [(Combine::Nearest, &stacked[..1]), (Combine::Subtract, &stacked[..])] {
        let (found, _) = scene.factors(gpu, &shot, OcclusionSettings { combine, ..settings })?;
        let [rms, most] = differences(&inside(&found), expected(counted).into_iter());
        eprintln!("stacked, {combine:?}: RMS {rms:.4}, most {most:.4}");
        assert!(rms < 0.012, "{combine:?}: {rms}");
    }
    let [apart, _] = differences(&expected(&stacked[..1]), expected(&stacked).into_iter());
    assert!(apart > 0.05, "{apart}");
    Ok(())
}

/// Rays that start within the sphere: the lower of two balls that are one object, in the upper one's shadow.
fn own(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let view = View::perspective(Vec3::new(0.0, 3.0, 5.0), Vec3::ZERO, Vec3::Y, 0.6, 96.0 / 72.0, 0.1, 60.0)
        .with_reversed_depth();
    let lower = Shape::Sphere { center: DVec3::ZERO, radius: 1.0 };
    let shot = Shot::take(gpu, view, SIZE, &[Thing(lower, |_| Paint::default())])?;
    let upper = (Vec3::new(0.0, 2.2, 0.0), 0.8);
    let field = Soup::pair().baked(Settings { points: 4226, directions: 64, ..Settings::default() });
    let packed = field.packed().expect("a field that fits");
    let fields = Fields::new(gpu, &[&packed])?;
    let mut objects = Objects::new(gpu, 1)?;
    objects.update(gpu, &fields, &[Placement::new(0, Mat4::IDENTITY, 0)])?;
    let scene = Scene { fields, objects };
    for blended in [false, true] {
        let settings =
            OcclusionSettings { rays: 256, blended, denoise: false, ..OcclusionSettings::default() };
        let (found, _) = scene.factors(gpu, &shot, settings)?;
        let (mut apart, mut count, mut darkest) = (0.0, 0, 1.0f64);
        for ((p, factor), depth) in points(&shot).iter().zip(found).zip(&shot.picture.depth) {
            let way = upper.0.as_dvec3() - p;
            let cos = way.normalize().dot(p.normalize());
            // Where the upper ball lies wholly above the horizon its closed form holds.
            if *depth > 0.0 && way.length() * cos > 0.8 {
                let expected = 1.0 - sphere_occlusion(0.8, way.length(), cos);
                apart += (factor - expected).powi(2);
                darkest = darkest.min(factor);
                count += 1;
            }
        }
        let rms = (apart / f64::from(count)).sqrt();
        eprintln!("blended {blended}: RMS {rms:.4} over {count} pixels, darkest {darkest:.3}");
        assert!(count > 150 && darkest < 0.6 && rms < 0.02, "{rms} {count} {darkest}");
    }
    Ok(())
}

fn falloff(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let scene = Scene::new(gpu, &[(Vec3::new(0.0, 2.0, 0.0), 1.0)])?;
    let points = points(&shot);
    let middle =
        points.iter().enumerate().min_by(|a, b| a.1.length().total_cmp(&b.1.length())).map_or(0, |m| m.0);
    let at = |reach: f32, exponent: f32| -> Result<f64, GpuError> {
        let settings = OcclusionSettings { rays: 256, reach, exponent, ..OcclusionSettings::default() };
        Ok(1.0 - scene.factors(gpu, &shot, settings)?.0[middle])
    };
    let all = at(f32::INFINITY, 1.0)?;
    assert!((all - 0.25).abs() < 0.01, "{all}");
    // Integrated over the ball's disk of directions: between the share left at the nearest and at the farthest hit.
    let (linear, square) = (at(4.0, 1.0)?, at(4.0, 2.0)?);
    let least = 1.0 - 3f64.sqrt() / 4.0;
    assert!(linear / all > least && linear / all < 0.76, "{linear} of {all}");
    assert!(square / all > least * least && square < linear, "{square} {linear}");
    assert_eq!(at(0.9, 1.0)?, 0.0);
    Ok(())
}

fn culling(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let points = points(&shot);
    let ball = (Vec3::new(-2.0, 0.3, 0.0), 0.25);
    let scene = Scene::new(gpu, &[ball])?;
    let coarse = OcclusionSettings { least_share: 0.02, ..OcclusionSettings::default() };
    let fine = OcclusionSettings { least_share: 1e-6, ..coarse };
    let ((culled, drawn), (whole, all)) =
        (scene.factors(gpu, &shot, coarse)?, scene.factors(gpu, &shot, fine)?);
    assert_eq!(all, 12 * 9);
    assert!(drawn > 0 && drawn < 30, "{drawn} tiles");
    // Beyond the ball's reach of 0.25 / sqrt(0.02) m and a tile nothing is touched; what is left out is less than the share.
    let reach = 0.25 / 0.02f64.sqrt();
    for ((p, a), b) in points.iter().zip(&culled).zip(&whole) {
        let away = p.distance(ball.0.as_dvec3());
        if away > reach + 2.5 {
            assert_eq!(*a, 1.0, "{p}");
        }
        assert!((a - b).abs() <= 0.02 + 1e-3, "{a} {b} at {p}");
    }
    // Without objects, or with reach that ends before the floor, nothing is drawn.
    let none = Scene::new(gpu, &[])?;
    let (factors, drawn) = none.factors(gpu, &shot, fine)?;
    assert!(drawn == 0 && factors.iter().all(|f| *f == 1.0));
    let short = OcclusionSettings { reach: 0.02, ..fine };
    assert_eq!(scene.factors(gpu, &shot, short)?.1, 0);
    Ok(())
}

fn crowd(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let shot = floor(gpu)?;
    let near =
        [(Vec3::new(-1.6, 1.1, 0.0), 0.9), (Vec3::new(1.7, 1.3, 0.3), 0.8), (Vec3::new(0.2, 0.7, 1.4), 0.5)];
    // Too far away for any tile, with the three among them.
    let mut all: Vec<_> = (0..3100).map(|n| (Vec3::new(1000.0, n as f32, 0.0), 0.01)).collect();
    for (number, ball) in [7, 1500, 3099].into_iter().zip(near) {
        all[number] = ball;
    }
    let settings = OcclusionSettings::default();
    let alone = Scene::new(gpu, &near)?.factors(gpu, &shot, settings)?;
    let among = Scene::new(gpu, &all)?.factors(gpu, &shot, settings)?;
    assert!(alone == among);
    assert!(alone.0.iter().any(|factor| *factor < 0.5));
    Ok(())
}

fn contract(_: &Labs) -> Result<(), Failed> {
    // A device of its own: other tests make objects meanwhile.
    let gpu = &Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let shot = floor(gpu)?;
    let mut scene = Scene::new(gpu, &[(Vec3::new(0.0, 1.0, 0.0), 0.9), (Vec3::new(1.0, 2.0, 0.0), 0.5)])?;
    let mut occlusion = Occlusion::new(gpu, SIZE, &scene.objects, OcclusionSettings::default())?;
    let receiver = Receiver::from(&shot.input);
    let mut pictures: Vec<Vec<half::f16>> = Vec::new();
    let mut made = Vec::new();
    for frame in 0..4 {
        let place = Mat4::from_translation(Vec3::new(0.1 * (frame % 2) as f32, 1.0, 0.0));
        scene.objects.update(gpu, &scene.fields, &[Placement::new(0, place, 0)])?;
        occlusion.update(gpu, &scene.objects);
        run(gpu, |e| occlusion.record(gpu, e, &scene.fields, &scene.objects, &receiver))?;
        pictures.push(read_texture(gpu, occlusion.factor())?);
        made.push(gpu.created_objects());
    }
    assert_eq!(made[1], made[3]);
    assert!(pictures[0] == pictures[2] && pictures[1] == pictures[3] && pictures[0] != pictures[1]);
    let mut other = Occlusion::new(gpu, SIZE + 1, &scene.objects, OcclusionSettings::default())?;
    let refused = run(gpu, |e| other.record(gpu, e, &scene.fields, &scene.objects, &receiver));
    assert!(matches!(refused, Err(GpuError::Validation(_))));
    Ok(())
}
