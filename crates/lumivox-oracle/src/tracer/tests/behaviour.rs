//! Lights, sides, pictures, seeds and errors.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{floor, gray, scene};
use crate::closed_form;
use crate::scene::{Camera, Light, Scene, SceneError, SpotFalloff, Texture, Triangle, Wrap};
use crate::shapes;
use crate::tracer::{PixelFilter, Settings, Tracer};

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

pub(super) fn small_room() -> Scene {
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

pub(super) const ROOM_CAMERA: Camera =
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
fn rounds_add_up_to_one_long_exposure() {
    let scene = small_room();
    let tracer = Tracer::new(&scene).unwrap();
    for filter in [PixelFilter::Box, PixelFilter::Center] {
        let settings = Settings { width: 16, height: 12, samples: 13, filter, ..Settings::default() };
        let mut film = tracer.film(&ROOM_CAMERA, &settings).unwrap();
        assert_eq!(film.rendering().direct.radiance.mean(), Vec3::ZERO);
        let mut heard = Vec::new();
        for round in [1, 4, 8] {
            let most = std::sync::Mutex::new(0.0f64);
            film.expose(round, &|share| {
                let mut most = most.lock().unwrap();
                *most = most.max(share);
            });
            heard.push(most.into_inner().unwrap());
        }
        assert_eq!((film.samples(), heard), (13, vec![1.0; 3]));
        assert_eq!(film.rendering(), tracer.render(&ROOM_CAMERA, &settings, &|_| {}).unwrap());
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

/// A wall before the camera with a picture on it: row 0 on top, u to the right, v down.
#[test]
fn pictures_and_textures_are_the_right_way_up() {
    let wall =
        shapes::quad([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)));
    let sun = Light::Directional { direction: -Vec3::Z, irradiance: Vec3::splat(PI) };
    let mut scene = scene([(wall.to_vec(), gray(0.5))], vec![sun]);
    // Red, green above blue, black.
    let texels = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [0, 0, 0]];
    let pixels = texels.into_iter().flat_map(|[r, g, b]| [r, g, b, 255]).collect();
    scene.textures.push(Texture { width: 2, height: 2, srgb: true, pixels, wrap: [Wrap::Clamp; 2] });
    let material = &mut scene.materials[0];
    material.albedo_texture = Some(0);
    material.emission_texture = Some(0);
    material.emission = Vec3::splat(3.0);
    for t in &mut scene.triangles {
        t.uvs = t.positions.map(|p| Vec2::new(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y));
        t.colors = [glam::Vec4::splat(0.4); 3];
    }
    let camera = Camera { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, fov_y: 1.5 };
    let filter = PixelFilter::Center;
    let settings =
        Settings { width: 8, height: 8, samples: 2, bounces: Some(0), filter, ..Settings::default() };
    let picture = Tracer::new(&scene).unwrap().render(&camera, &settings, &|_| {}).unwrap();
    for (x, y, color) in [(0, 0, Vec3::X), (7, 0, Vec3::Y), (0, 7, Vec3::Z), (7, 7, Vec3::ZERO)] {
        assert!((picture.albedo.at(x, y) - 0.2 * color).abs().max_element() < 1e-6, "{x} {y}");
        assert!((picture.direct.radiance.at(x, y) - 0.2 * color).abs().max_element() < 1e-5);
        assert!((picture.emitted.at(x, y) - 3.0 * color).abs().max_element() < 1e-5);
    }
    assert!((picture.direct.irradiance.mean() - PI).abs().max_element() < 1e-4, "no albedo in it");
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

/// Points, lines and copies among the triangles, thousands in one place: no ray meets the former, and the tree must stand
/// all.
#[test]
fn triangles_without_area_and_copies_are_passed_over() {
    let mut triangles = floor(4.0, 0.0);
    let p = Vec3::new(0.1, 1.0, 0.1);
    for n in 0..3000 {
        let q = p + 1e-3 * (n % 7) as f32 * Vec3::X;
        triangles.push([p, p, q]);
        triangles.push([q, q, q]);
    }
    triangles.extend(vec![[Vec3::ZERO, Vec3::X, Vec3::Z].map(|p| p - 9.0 * Vec3::Y); 10_000]);
    let scene = scene([(triangles, gray(0.5))], vec![Light::Constant { radiance: Vec3::ONE }]);
    let e = Tracer::new(&scene).unwrap().irradiance(Vec3::new(0.1, 0.5, 0.1), Vec3::Y, None, 4000, 5);
    assert!((e.direct.x - std::f32::consts::PI).abs() < 1e-3, "{}", e.direct);
}
