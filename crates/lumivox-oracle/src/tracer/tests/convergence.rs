//! How fast direct light converges, and whether standard errors say how far it is.

use glam::Vec3;

use super::behaviour::{ROOM_CAMERA, small_room};
use super::{gray, scene};
use crate::closed_form;
use crate::scene::{Light, Scene};
use crate::shapes;
use crate::tracer::{Layer, PixelFilter, Rendering, Settings, Tracer};

type Pick = fn(&Rendering) -> &Layer;

/// Standard error said over scatter seen, of all pixels of one picture taken with many seeds.
fn honesty(scene: &Scene, samples: u32, filter: PixelFilter, layer: Pick) -> f64 {
    let tracer = Tracer::new(scene).unwrap();
    let runs: Vec<_> = (0..24)
        .map(|seed| {
            let settings = Settings { width: 16, height: 12, samples, seed, filter, ..Settings::default() };
            tracer.render(&ROOM_CAMERA, &settings, &|_| {}).unwrap()
        })
        .collect();
    let (mut seen, mut said) = (0.0f64, 0.0f64);
    for pixel in 0..16 * 12 {
        let values: Vec<f64> = runs.iter().map(|r| layer(r).radiance.pixels[pixel].x.into()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        seen += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
        let variance = |r| f64::from(layer(r).radiance_error.pixels[pixel].x).powi(2);
        said += runs.iter().map(variance).sum::<f64>() / values.len() as f64;
    }
    (said / seen).sqrt()
}

#[test]
fn standard_errors_are_those_of_repeated_pictures() {
    let layers: [Pick; 3] = [|r| &r.direct, |r| &r.first_bounce, |r| &r.indirect];
    // 53 is not a number that the sequences like: five of them have one path more than the others.
    for (samples, filter) in [(64, PixelFilter::Box), (53, PixelFilter::Center), (512, PixelFilter::Center)] {
        for layer in layers {
            let ratio = honesty(&small_room(), samples, filter, layer);
            assert!((ratio - 1.0).abs() < 0.08, "{samples}: {ratio}");
        }
    }
}

/// A sphere before an open sky: what it hides has a closed form, and all of the error is at its edge.
fn hidden_sky() -> (Scene, f64) {
    let center = Vec3::new(0.5, 1.2, 0.3);
    let sphere: Vec<_> = shapes::sphere(0.8, 5).view().iter().map(|t| t.map(|p| p + center)).collect();
    let scene = scene([(sphere, gray(0.0))], vec![Light::Constant { radiance: Vec3::ONE }]);
    let distance = f64::from(center.length());
    let hidden = closed_form::sphere_occlusion(0.8, distance, f64::from(center.y) / distance);
    (scene, std::f64::consts::PI * (1.0 - hidden))
}

/// A blocked panel, its light at a point from many paths: there is no closed form for its penumbra.
fn hidden_panel() -> (Scene, f64) {
    let panel =
        Light::Rect { origin: Vec3::new(-0.5, 2.0, -0.5), u: Vec3::X, v: Vec3::Z, radiance: Vec3::ONE };
    let block = shapes::cuboid(Vec3::new(-0.1, 0.9, -0.35), Vec3::new(0.6, 1.0, 0.2));
    let scene = scene([(block, gray(0.0))], vec![panel]);
    let long = Tracer::new(&scene).unwrap().irradiance(Vec3::ZERO, Vec3::Y, Some(0), 1 << 20, 99);
    (scene, long.direct.x.into())
}

/// RMS of the true errors of many seeds, and of the errors they say.
fn errors((scene, expected): &(Scene, f64), samples: u32) -> (f64, f64) {
    let tracer = Tracer::new(scene).unwrap();
    let (mut seen, mut said) = (0.0, 0.0);
    let seeds = 200;
    for seed in 0..seeds {
        let e = tracer.irradiance(Vec3::ZERO, Vec3::Y, Some(0), samples, seed);
        seen += (f64::from(e.direct.x) - expected).powi(2);
        said += f64::from(e.errors[0].x).powi(2);
    }
    ((seen / seeds as f64).sqrt(), (said / seeds as f64).sqrt())
}

#[test]
fn direct_light_converges_faster_than_random_numbers_and_says_how_far_it_is() {
    for case in [hidden_sky(), hidden_panel()] {
        let [(coarse, coarse_said), (fine, fine_said)] = [256, 4096].map(|samples| errors(&case, samples));
        // Random numbers make 4 of it, even ones 8 where edges are the error. 200 seeds know each to 5 %.
        let gain = coarse / fine;
        assert!(gain > 5.5, "{coarse} {fine}: {gain}");
        for (seen, said) in [(coarse, coarse_said), (fine, fine_said)] {
            assert!((said / seen - 1.0).abs() < 0.2, "{seen} seen, {said} said");
        }
    }
}
