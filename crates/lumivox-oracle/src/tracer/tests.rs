//! The path tracer against closed forms. A tolerance of `z` standard errors is checked with the tracer's own estimate,
//! next to a relative one, so that an estimate that is too large does not hide a fault.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::*;
use crate::closed_form;
use crate::scene::{Camera, Light, Material, SpotFalloff, Texture, Triangle, Wrap};
use crate::shapes;

fn scene(parts: impl IntoIterator<Item = (Vec<[Vec3; 3]>, Material)>, lights: Vec<Light>) -> Scene {
    let mut scene = Scene { lights, ..Scene::default() };
    for (n, (triangles, material)) in parts.into_iter().enumerate() {
        scene.materials.push(material);
        scene.triangles.extend(triangles.into_iter().map(|t| Triangle::flat(t, n as u32)));
    }
    scene
}

fn gray(albedo: f32) -> Material {
    Material::matte(Vec3::splat(albedo))
}

fn glowing(albedo: f32, emission: f32) -> Material {
    Material { emission: Vec3::splat(emission), ..gray(albedo) }
}

fn floor(half: f32, y: f32) -> Vec<[Vec3; 3]> {
    let at = |x: f32, z: f32| Vec3::new(half * x, y, half * z);
    shapes::quad([at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0), at(-1.0, -1.0)]).to_vec()
}

/// `value` within `relative` of `expected`, and within five standard errors (and the rounding of `f32`).
#[track_caller]
fn assert_near(value: f32, error: f32, expected: f64, relative: f64) {
    let off = (f64::from(value) - expected).abs();
    assert!(off <= relative * expected.abs().max(1e-9), "{value}, not {expected}: off by {off}");
    let noise = 5.0 * f64::from(error) + 2e-4 * expected.abs();
    assert!(off <= noise, "{value}, not {expected}: off by {off} with an error of {error}");
}

#[test]
fn furnace_of_any_albedo() {
    let room = shapes::cuboid(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.5, 2.0, 1.0));
    let camera = Camera { eye: Vec3::new(0.3, 1.1, 0.2), target: Vec3::ZERO, up: Vec3::Y, fov_y: 1.5 };
    for albedo in [0.0f32, 0.25, 0.5, 0.9] {
        let scene = scene([(room.clone(), glowing(albedo, 1.5))], vec![]);
        let tracer = Tracer::new(&scene).unwrap();
        let settings = Settings { width: 16, height: 12, samples: 256, ..Settings::default() };
        let picture = tracer.render(&camera, &settings, &|_| {}).unwrap();
        assert!(picture.foreground().iter().all(|&seen| seen));
        let part = |n| closed_form::furnace_part(f64::from(albedo), 1.5, n) as f32;
        let total = closed_form::furnace(f64::from(albedo), 1.5) as f32;
        let near = |value: &crate::picture::Picture, expected: f32| {
            let off = (value.mean() - expected).abs().max_element();
            assert!(off <= 0.01 * expected, "albedo {albedo}: {} instead of {expected}", value.mean());
        };
        near(&picture.emitted, part(0));
        near(&picture.direct.radiance, part(1));
        near(&picture.first_bounce.radiance, part(2));
        near(&picture.indirect.radiance, total - part(0) - part(1));
        near(&picture.total(), total);
        near(&picture.direct.irradiance, 1.5 * PI);
    }
}

#[test]
fn bounces_end_where_they_are_told_to() {
    let room = shapes::cuboid(Vec3::splat(-1.0), Vec3::ONE);
    let scene = scene([(room, glowing(0.8, 1.0))], vec![]);
    let tracer = Tracer::new(&scene).unwrap();
    for bounces in [0, 1, 2, 7] {
        let e = tracer.irradiance(Vec3::ZERO, Vec3::Y, Some(bounces), 4000, 1);
        let expected: f32 = (1..=bounces).map(|n| PI * 0.8f32.powi(n as i32)).sum();
        assert!((e.indirect.x - expected).abs() <= 0.01 * expected, "{bounces}: {e:?}");
        assert!((e.direct.x - PI).abs() < 0.01 * PI);
    }
}

#[test]
fn inside_of_a_sphere_around_a_point_light() {
    let sphere: Vec<_> = shapes::sphere(1.0, 5).view().iter().collect();
    let light = Light::Point { position: Vec3::ZERO, intensity: Vec3::splat(PI) };
    let scene = scene([(sphere, gray(0.5))], vec![light]);
    let tracer = Tracer::new(&scene).unwrap();
    let camera = Camera { eye: Vec3::new(0.2, 0.1, 0.0), target: Vec3::Z, up: Vec3::Y, fov_y: 1.8 };
    let settings = Settings { width: 24, height: 24, samples: 128, ..Settings::default() };
    let picture = tracer.render(&camera, &settings, &|_| {}).unwrap();
    // The facets lie up to 0.05 % inside of the sphere.
    assert!((picture.direct.radiance.mean().x - 0.5).abs() < 0.002);
    assert!((picture.first_bounce.radiance.mean().x - 0.25).abs() < 0.002);
    let total = picture.total().mean().x;
    assert!(
        (f64::from(total) - closed_form::lit_sphere(1.0, 0.5, std::f64::consts::PI)).abs() < 0.004,
        "{total}"
    );
}

#[test]
fn white_object_under_a_white_sky_vanishes() {
    let sphere: Vec<_> = shapes::sphere(1.0, 3).view().iter().collect();
    let scene = scene([(sphere, gray(1.0))], vec![Light::Constant { radiance: Vec3::splat(2.0) }]);
    let tracer = Tracer::new(&scene).unwrap();
    let camera = Camera { eye: Vec3::Z * 4.0, target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.8 };
    let settings = Settings { width: 16, height: 16, samples: 16, ..Settings::default() };
    let total = tracer.render(&camera, &settings, &|_| {}).unwrap().total();
    assert!(total.pixels.iter().all(|p| (*p - 2.0).abs().max_element() < 1e-5));
}

#[test]
fn rectangle_and_emissive_quad_light_a_point_below_their_corner() {
    let (a, b, c) = (0.7f32, 1.3, 0.9);
    let origin = Vec3::new(0.0, c, 0.0);
    let (u, v) = (Vec3::X * a, Vec3::Z * b);
    let rect = Light::Rect { origin, u, v, radiance: Vec3::splat(3.0) };
    let back = Light::Rect { origin, u: v, v: u, radiance: Vec3::splat(3.0) };
    let quad = shapes::quad([origin, origin + u, origin + u + v, origin + v]).to_vec();
    let e = |scene: Scene| Tracer::new(&scene).unwrap().irradiance(Vec3::ZERO, Vec3::Y, None, 40_000, 5);
    let factor = closed_form::element_below_corner(a.into(), b.into(), c.into());
    let expected = 3.0 * std::f64::consts::PI * factor;
    for e in [e(scene([], vec![rect])), e(scene([(quad, glowing(0.0, 3.0))], vec![]))] {
        assert_near(e.direct.x, e.errors[0].x, expected, 0.01);
        assert_eq!(e.indirect, Vec3::ZERO);
    }
    // From behind it is dark, and it hides the sky that it covers.
    let sky = Light::Constant { radiance: Vec3::ONE };
    let behind = e(scene([], vec![back, sky]));
    assert_near(behind.direct.x, behind.errors[0].x, std::f64::consts::PI * (1.0 - factor), 0.01);
}

#[test]
fn a_rectangle_so_close_that_it_fills_the_sky() {
    let corner = Vec3::new(-1.0, 0.001, -1.0);
    let light = Light::Rect { origin: corner, u: 2.0 * Vec3::X, v: 2.0 * Vec3::Z, radiance: Vec3::ONE };
    let scene = scene([], vec![light]);
    let e = Tracer::new(&scene).unwrap().irradiance(Vec3::ZERO, Vec3::Y, None, 20_000, 5);
    let quarter = closed_form::element_below_corner(1.0, 1.0, 0.001);
    assert_near(e.direct.x, e.errors[0].x, 4.0 * std::f64::consts::PI * quarter, 0.005);
}

/// Mean over a rectangle of a part of the irradiance, with its standard error.
fn mean_over(
    tracer: &Tracer<'_>,
    place: impl Fn(Vec2) -> Vec3,
    normal: Vec3,
    part: impl Fn(&Irradiance) -> (Vec3, Vec3),
) -> (f32, f32) {
    let n = 24;
    let (mut sum, mut variance) = (0.0, 0.0);
    for i in 0..n * n {
        let uv = (Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32;
        let (value, error) = part(&tracer.irradiance(place(uv), normal, Some(1), 256, i as u64));
        sum += value.x;
        variance += error.x * error.x;
    }
    let count = (n * n) as f32;
    (sum / count, variance.sqrt() / count)
}

#[test]
fn facing_squares_exchange_their_form_factor() {
    let light = Light::Rect { origin: Vec3::Y, u: Vec3::X, v: Vec3::Z, radiance: Vec3::ONE };
    let scene = scene([], vec![light]);
    let tracer = Tracer::new(&scene).unwrap();
    let (mean, error) =
        mean_over(&tracer, |p| Vec3::new(p.x, 0.0, p.y), Vec3::Y, |e| (e.direct, e.errors[0]));
    assert_near(mean, error, std::f64::consts::PI * closed_form::facing_rectangles(1.0, 1.0, 1.0), 0.005);
}

#[test]
fn first_bounce_between_perpendicular_plates() {
    // The sun straight above lights the floor alone; the wall gets what the floor reflects.
    let floor = shapes::quad([Vec3::ZERO, Vec3::Z, Vec3::X + Vec3::Z, Vec3::X]).to_vec();
    let sun = Light::Directional { direction: -Vec3::Y, irradiance: Vec3::splat(2.0) };
    let scene = scene([(floor, gray(0.6))], vec![sun]);
    let tracer = Tracer::new(&scene).unwrap();
    let wall = |p: Vec2| Vec3::new(p.x, p.y, 0.0);
    let (mean, error) = mean_over(&tracer, wall, Vec3::Z, |e| (e.first_bounce, e.errors[1]));
    let factor = closed_form::perpendicular_rectangles(1.0, 1.0, 1.0);
    assert_near(mean, error, 2.0 * 0.6 * factor, 0.01);
    let on_floor = tracer.irradiance(Vec3::new(0.5, 1e-3, 0.5), Vec3::Y, None, 16, 0);
    assert_eq!((on_floor.direct.x, on_floor.indirect.x), (2.0, 0.0));
}

#[test]
fn endless_facing_planes() {
    let (e, a) = ([1.0, 0.25], [0.5, 0.8]);
    let planes = [
        (floor(2000.0, 0.0), glowing(a[0] as f32, e[0] as f32)),
        (floor(2000.0, 1.0), glowing(a[1] as f32, e[1] as f32)),
    ];
    let scene = scene(planes, vec![]);
    let got = Tracer::new(&scene).unwrap().irradiance(Vec3::Y * 1e-3, Vec3::Y, None, 60_000, 2);
    let [_, above] = closed_form::facing_planes(e, a);
    let error = (got.errors[0] + got.errors[2]).x;
    assert_near(got.direct.x + got.indirect.x, error, std::f64::consts::PI * above, 0.01);
}

#[test]
fn black_sphere_hides_its_share_of_the_sky() {
    let center = Vec3::new(0.5, 1.2, 0.3);
    let sphere: Vec<_> = shapes::sphere(0.8, 5).view().iter().map(|t| t.map(|p| p + center)).collect();
    let scene = scene([(sphere, gray(0.0))], vec![Light::Constant { radiance: Vec3::ONE }]);
    let e = Tracer::new(&scene).unwrap().irradiance(Vec3::ZERO, Vec3::Y, None, 60_000, 0);
    let distance = f64::from(center.length());
    let hidden = closed_form::sphere_occlusion(0.8, distance, f64::from(center.y) / distance);
    assert_near(e.direct.x, e.errors[0].x, std::f64::consts::PI * (1.0 - hidden), 0.005);
}

#[test]
fn masked_layers_absorb_as_a_stack_of_half_open_planes() {
    // Layer n has a slot open in every other of 2^n pairs of stripes, so each halves what the others let through.
    let mut scene = scene([], vec![Light::Directional { direction: -Vec3::Y, irradiance: Vec3::ONE }]);
    for layer in 0..3u32 {
        let stripes = 2 << layer;
        let pixels = (0..stripes).flat_map(|n| [255, 255, 255, if n % 2 == 0 { 255 } else { 0 }]).collect();
        // Many copies of each texel, so that filtering is exact but for the narrow ramps between.
        scene.textures.push(Texture {
            width: stripes,
            height: 1,
            srgb: false,
            pixels,
            wrap: [Wrap::Clamp; 2],
        });
        let material =
            Material { alpha_cutoff: Some(0.5), albedo_texture: Some(layer), ..Material::matte(Vec3::ZERO) };
        scene.materials.push(material);
        for mut t in floor(0.5, 1.0 + layer as f32).into_iter().map(|t| Triangle::flat(t, layer)) {
            t.uvs = t.positions.map(|p| Vec2::new(p.x + 0.5, p.z + 0.5));
            scene.triangles.push(t);
        }
    }
    let tracer = Tracer::new(&scene).unwrap();
    let n = 4096;
    let open = (0..n).filter(|&i| {
        let x = (i as f32 + 0.5) / n as f32 - 0.5;
        tracer.irradiance(Vec3::new(x, 0.0, 0.1), Vec3::Y, None, 1, 0).direct.x > 0.5
    });
    let share = open.count() as f64 / f64::from(n);
    assert!((share - closed_form::stack_transmittance([0.5; 3])).abs() < 0.002, "{share}");
}

#[test]
fn point_spot_and_directional_lights_fall_as_they_say() {
    let at = Vec3::new(0.4, 0.0, -0.3);
    let direct = |light| {
        let scene = scene([], vec![light]);
        Tracer::new(&scene).unwrap().irradiance(at, Vec3::Y, None, 1, 0).direct.x
    };
    let position = Vec3::new(0.0, 2.0, 0.0);
    let offset = position - at;
    let (d2, cos) = (offset.length_squared(), offset.y / offset.length());
    let point = 5.0 * cos / d2;
    let intensity = Vec3::splat(5.0);
    assert!((direct(Light::Point { position, intensity }) - point).abs() < 1e-6);
    let angle = cos.acos();
    for share in [0.0, 0.25, 0.75, 1.0] {
        let falloff =
            SpotFalloff::LinearAngle { beam: angle - 0.1 * (1.0 - share), cutoff: angle + 0.1 * share };
        let spot = Light::Spot { position, direction: -3.0 * Vec3::Y, intensity, falloff };
        assert!((direct(spot) - share * point).abs() < 1e-4, "{share}");
    }
    let sun = Light::Directional { direction: Vec3::new(3.0, -4.0, 0.0), irradiance: intensity };
    assert!((direct(sun) - 4.0).abs() < 1e-5);
    let below = Light::Directional { direction: Vec3::Y, irradiance: intensity };
    assert_eq!(direct(below), 0.0);
}

#[test]
fn rectangles_are_not_seen_but_cast_shadows() {
    let light = Light::Rect {
        origin: Vec3::new(-0.5, 1.0, -0.5),
        u: Vec3::X,
        v: Vec3::Z,
        radiance: Vec3::splat(9.0),
    };
    let sun = Light::Directional { direction: -Vec3::Y, irradiance: Vec3::ONE };
    let scene = scene([(floor(3.0, 0.0), gray(0.5))], vec![sun, light]);
    let tracer = Tracer::new(&scene).unwrap();
    // From above, through the light's black side, onto the floor in its shadow.
    let camera = Camera { eye: Vec3::Y * 3.0, target: Vec3::ZERO, up: Vec3::Z, fov_y: 0.1 };
    let settings = Settings { width: 4, height: 4, samples: 2000, ..Settings::default() };
    let picture = tracer.render(&camera, &settings, &|_| {}).unwrap();
    assert!(picture.coverage.iter().all(|&c| c == 1.0));
    assert_eq!(picture.emitted.mean(), Vec3::ZERO);
    let factor = 4.0 * closed_form::element_below_corner(0.5, 0.5, 1.0);
    let expected = 9.0 * std::f64::consts::PI * factor;
    let got = f64::from(picture.direct.irradiance.mean().x);
    assert!((got - expected).abs() < 0.02 * expected, "{got} {expected}");
    assert!(tracer.irradiance(Vec3::new(2.0, 1e-3, 0.0), Vec3::Y, None, 1, 0).direct.x >= 1.0);
}

#[test]
fn both_sides_reflect_and_interpolated_normals_count() {
    let sun = Light::Directional { direction: -Vec3::Y, irradiance: Vec3::ONE };
    let mut scene = scene([(floor(5.0, 0.0), gray(0.5))], vec![sun]);
    let tilted = Vec3::new(0.6, 0.8, 0.0);
    for (winding, normal, expected) in
        [(false, Vec3::Y, 1.0), (true, Vec3::Y, 1.0), (false, tilted, 0.8), (true, -tilted, 0.8)]
    {
        scene.triangles = floor(5.0, 0.0).into_iter().map(|t| Triangle::flat(t, 0)).collect();
        for t in &mut scene.triangles {
            if winding {
                t.positions.reverse();
            }
            t.normals = Some([normal; 3]);
        }
        let camera = Camera { eye: Vec3::Y, target: Vec3::ZERO, up: Vec3::Z, fov_y: 0.5 };
        let settings = Settings { width: 2, height: 2, samples: 4, ..Settings::default() };
        let tracer = Tracer::new(&scene).unwrap();
        let picture = tracer.render(&camera, &settings, &|_| {}).unwrap();
        assert!((picture.direct.irradiance.mean().x - expected).abs() < 1e-5, "{winding} {normal}");
        assert!((picture.direct.radiance.mean().x - expected * 0.5 / PI).abs() < 1e-5);
        let from_below = Camera { eye: -Vec3::Y, ..camera };
        let dark = tracer.render(&from_below, &settings, &|_| {}).unwrap();
        assert_eq!(dark.direct.irradiance.mean(), Vec3::ZERO);
    }
}

fn small_room() -> Scene {
    let ceiling = Light::Rect {
        origin: Vec3::new(-0.3, 1.9, -0.3),
        u: 0.6 * Vec3::X,
        v: 0.6 * Vec3::Z,
        radiance: Vec3::new(5.0, 4.0, 3.0),
    };
    let room = shapes::cuboid(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
    let block = shapes::cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.1, 0.7, 0.1));
    scene([(room, gray(0.7)), (block, gray(0.4))], vec![ceiling])
}

const ROOM_CAMERA: Camera =
    Camera { eye: Vec3::new(0.8, 1.0, 0.9), target: Vec3::new(0.0, 0.6, 0.0), up: Vec3::Y, fov_y: 1.2 };

#[test]
fn same_seed_same_bits_whatever_the_number_of_threads() {
    let scene = small_room();
    let tracer = Tracer::new(&scene).unwrap();
    let settings = Settings { width: 20, height: 15, samples: 8, seed: 3, ..Settings::default() };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| tracer.render(&ROOM_CAMERA, &settings, &|_| {}).unwrap())
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let other = Settings { seed: 4, ..settings };
    assert_ne!(one, tracer.render(&ROOM_CAMERA, &other, &|_| {}).unwrap());
    let point = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| tracer.irradiance(Vec3::Y, Vec3::Y, None, 3000, 1))
    };
    assert_eq!(point(1), point(3));
}

#[test]
fn standard_errors_are_those_of_repeated_pictures() {
    let scene = small_room();
    let tracer = Tracer::new(&scene).unwrap();
    let runs: Vec<_> = (0..24)
        .map(|seed| {
            let settings = Settings { width: 16, height: 12, samples: 64, seed, ..Settings::default() };
            tracer.render(&ROOM_CAMERA, &settings, &|_| {}).unwrap()
        })
        .collect();
    type Pick = fn(&Rendering) -> &Layer;
    let layers: [Pick; 3] = [|r| &r.direct, |r| &r.first_bounce, |r| &r.indirect];
    for layer in layers {
        let (mut seen, mut said) = (0.0f64, 0.0f64);
        for pixel in 0..16 * 12 {
            let values: Vec<f64> = runs.iter().map(|r| layer(r).radiance.pixels[pixel].x.into()).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            seen += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
            let variance = |r| f64::from(layer(r).radiance_error.pixels[pixel].x).powi(2);
            said += runs.iter().map(variance).sum::<f64>() / values.len() as f64;
        }
        let ratio = (said / seen).sqrt();
        assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
    }
}

#[test]
fn light_is_linear_and_progress_ends_at_one() {
    let mut scene = small_room();
    let settings = Settings { width: 12, height: 9, samples: 4, ..Settings::default() };
    let most = std::sync::Mutex::new((0, 0.0f64));
    let once = {
        let tracer = Tracer::new(&scene).unwrap();
        let progress = |share: f64| {
            let mut most = most.lock().unwrap();
            *most = (most.0 + 1, most.1.max(share));
        };
        tracer.render(&ROOM_CAMERA, &settings, &progress).unwrap()
    };
    assert_eq!(*most.lock().unwrap(), (9, 1.0));
    for light in &mut scene.lights {
        if let Light::Rect { radiance, .. } = light {
            *radiance *= 2.0;
        }
    }
    let twice = Tracer::new(&scene).unwrap().render(&ROOM_CAMERA, &settings, &|_| {}).unwrap();
    for (a, b) in once.total().pixels.iter().zip(&twice.total().pixels) {
        assert!((2.0 * *a - *b).abs().max_element() <= 1e-5 * b.max_element());
    }
}

#[test]
fn an_empty_scene_shows_its_sky_and_no_pixels_are_refused() {
    let scene = scene([], vec![Light::Constant { radiance: Vec3::new(1.0, 2.0, 3.0) }]);
    let tracer = Tracer::new(&scene).unwrap();
    let settings = Settings { width: 3, height: 2, samples: 2, ..Settings::default() };
    let picture = tracer.render(&ROOM_CAMERA, &settings, &|_| {}).unwrap();
    assert_eq!(picture.total().mean(), Vec3::new(1.0, 2.0, 3.0));
    assert!(picture.foreground().iter().all(|&seen| !seen));
    let none = Settings { samples: 0, ..settings };
    assert_eq!(tracer.render(&ROOM_CAMERA, &none, &|_| {}), Err(SceneError::EmptyPicture));
}
