//! Light with known answers. Beside a relative tolerance, five of the tracer's own standard errors are checked, so that
//! neither a generous tolerance nor a generous estimate hides a fault.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{floor, glowing, gray, scene};
use crate::closed_form;
use crate::scene::{Camera, Environment, Light, Material, Scene, Texture, Triangle, Wrap};
use crate::shapes;
use crate::tracer::{Irradiance, Settings, Tracer};

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

/// Radiance 1 plus a direction's coordinate gives pi plus two thirds of pi times the normal's.
#[test]
fn an_environment_is_the_right_way_round() {
    let (width, height) = (64u32, 32u32);
    let direction = |n: u32| {
        let (x, y) = ((n % width) as f32 + 0.5, (n / width) as f32 + 0.5);
        let (sin, cos) = (std::f32::consts::TAU * (x / width as f32 - 0.5)).sin_cos();
        let (sin_down, cos_down) = (std::f32::consts::PI * y / height as f32).sin_cos();
        Vec3::new(sin * sin_down, cos_down, -cos * sin_down)
    };
    let pixels = (0..width * height).map(|n| Vec3::ONE + direction(n)).collect();
    let mut scene = scene([], vec![]);
    scene.environment = Some(Environment { width, height, pixels });
    for n in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let e = Tracer::new(&scene).unwrap().irradiance(Vec3::ZERO, n, None, 20_000, 5);
        let expected = std::f32::consts::PI * (Vec3::ONE + 2.0 / 3.0 * n);
        assert!((e.direct - expected).abs().max_element() < 0.02, "{n}: {} for {expected}", e.direct);
    }
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
    // Layer n has 2^n pairs of a closed and an open stripe, so each halves what the others let through.
    let mut scene = scene([], vec![Light::Directional { direction: -Vec3::Y, irradiance: Vec3::ONE }]);
    for layer in 0..3u32 {
        let stripes = 2 << layer;
        let pixels = (0..stripes).flat_map(|n| [255, 255, 255, if n % 2 == 0 { 255 } else { 0 }]).collect();
        // Filtered opacity passes the cutoff of one half just where two texels meet.
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
