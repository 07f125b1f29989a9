//! Rect lights, the sky and many lights in the direct light, against integrals worked out on the CPU.

use std::f32::consts::PI;

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Layer, Renderer, Settings};
use lumivox_scene::{Camera, Light, Material, Scene};

use crate::Check;
use crate::camera::{Ray, rays};
use crate::scenes::{Quad, add, block, picture, radiosities, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("a rect light on a plane is its integral", |gpu| rect_light(gpu, None)),
    ("a rect light's shadow is soft as its integral says", |gpu| rect_light(gpu, Some(SHADE))),
    ("a rect light shines to its front only", rect_light_back),
    ("a rect light is not seen but shades other lights", rect_light_shades),
    ("an open sky is pi times its radiance", open_sky),
    ("a roof takes its part of the sky", |gpu| sky_under_a_roof(gpu)),
    ("sixty-four lights add up in the picture", many_lights),
    ("lights add up in the volume", lights_in_the_volume),
    ("a lamp does not swallow the sky's light", lamp_and_sky),
];

/// sRGB 188.
const ALBEDO: f32 = 0.5028865;
const PLANE_SIDE: f32 = 4.0;
const SHADE: (Vec3, f32) = (Vec3::new(0.1, 0.8, 0.0), 0.9);
/// Points of the CPU's integral along each side of a light.
const POINTS: usize = 64;

const ORIGIN: Vec3 = Vec3::new(-0.5, 2.0, 0.3);
const U: Vec3 = Vec3::new(0.8, 0.0, 0.0);
const V: Vec3 = Vec3::new(0.0, -0.15, 0.7);
const RADIANCE: Vec3 = Vec3::new(5.0, 4.0, 3.0);

fn camera() -> Camera {
    Camera::look("side", Vec3::new(0.0, 2.6, 3.6), Vec3::new(0.0, 0.0, 0.2), 48.0)
}

fn plane_scene(lights: Vec<Light>, shade: Option<(Vec3, f32)>) -> Scene {
    let mut scene = Scene { lights, ..Scene::default() };
    add(&mut scene, Material::matte("plane", Vec3::splat(ALBEDO)), &[Quad::level(Vec3::ZERO, PLANE_SIDE)]);
    if let Some((middle, side)) = shade {
        add(&mut scene, Material::matte("shade", Vec3::splat(0.2)), &[Quad::level(middle, side)]);
    }
    scene
}

fn direct() -> Settings {
    Settings { layer: Layer::Direct, area_samples: 256, shadow_size: 4096, ..small() }
}

/// The points of the plane that pixels show, away from its border and from what hides it.
fn shown_points(settings: &Settings, shade: Option<(Vec3, f32)>) -> Vec<(usize, Vec3)> {
    let plane = Quad::level(Vec3::ZERO, PLANE_SIDE);
    let mut shown = Vec::new();
    for (n, ray) in rays(&camera(), settings.size).into_iter().enumerate() {
        let Some((distance, inside)) = ray.meets(plane.corner, plane.u, plane.v) else { continue };
        let hidden = shade.is_some_and(|(middle, side)| {
            let q = Quad::level(middle, side);
            ray.meets(q.corner, q.u, q.v).is_some_and(|(_, inside)| inside > -0.05)
        });
        if inside > 0.05 && !hidden {
            shown.push((n, ray.origin + distance * ray.direction));
        }
    }
    shown
}

fn is_shaded(p: Vec3, direction: Vec3, shade: Option<(Vec3, f32)>) -> bool {
    shade.is_some_and(|(middle, side)| {
        let q = Quad::level(middle, side);
        Ray { origin: p, direction }.meets(q.corner, q.u, q.v).is_some_and(|(_, inside)| inside > 0.0)
    })
}

/// Mean and largest error over the points, relative to the mean of what is expected.
fn errors(
    seen: &[Vec3],
    points: &[(usize, Vec3)],
    expected: impl Fn(Vec3) -> Vec3,
) -> Result<(f32, f32), Failed> {
    if points.len() < 1000 {
        return Err(format!("only {} pixels were judged", points.len()).into());
    }
    let values: Vec<Vec3> = points.iter().map(|&(_, p)| expected(p)).collect();
    let mean = values.iter().map(|v| v.element_sum()).sum::<f32>() / values.len() as f32;
    let error = |(&(n, _), v): (&(usize, Vec3), &Vec3)| (seen[n] - v).abs().element_sum() / mean;
    let all: Vec<f32> = points.iter().zip(&values).map(error).collect();
    Ok((all.iter().sum::<f32>() / all.len() as f32, all.iter().copied().fold(0.0, f32::max)))
}

fn rect_light(gpu: &Gpu, shade: Option<(Vec3, f32)>) -> Result<(), Failed> {
    // `u x v` points down.
    let light = Light::Rect { origin: ORIGIN, u: U, v: V, radiance: RADIANCE };
    let settings = direct();
    let seen = picture(gpu, &plane_scene(vec![light], shade), &camera(), settings)?;
    let normal = U.cross(V).normalize_or_zero();
    let weight = U.cross(V).length() / (POINTS * POINTS) as f32;
    let expected = |p: Vec3| {
        let mut sum = 0.0;
        for i in 0..POINTS * POINTS {
            let (s, t) = ((i % POINTS) as f32 + 0.5, (i / POINTS) as f32 + 0.5);
            let way = ORIGIN + (s * U + t * V) / POINTS as f32 - p;
            let toward = way.normalize_or_zero();
            if !is_shaded(p, toward, shade) {
                sum += weight * toward.y.max(0.0) * normal.dot(-toward).max(0.0) / way.length_squared();
            }
        }
        ALBEDO / PI * sum * RADIANCE
    };
    let (mean, worst) = errors(&seen, &shown_points(&settings, shade), expected)?;
    // A step of the soft shadow is 1/64 of the light, and the shadow test reaches 0.9 cm into a penumbra half a metre wide: 3.4
    // percent of a light that is up to 1.7 times as bright as on average.
    let (mean_bound, worst_bound) = if shade.is_some() { (0.005, 0.06) } else { (0.003, 0.01) };
    assert!(mean < mean_bound && worst < worst_bound, "mean {mean:.4}, worst {worst:.4}");
    Ok(())
}

fn rect_light_back(gpu: &Gpu) -> Result<(), Failed> {
    let light = Light::Rect { origin: ORIGIN, u: V, v: U, radiance: RADIANCE };
    let seen = picture(gpu, &plane_scene(vec![light], None), &camera(), direct())?;
    assert!(seen.iter().all(|p| *p == Vec3::ZERO));
    Ok(())
}

/// A lamp above a dark rect light: its shadow lies on the plane, and nothing of the rect is in the picture.
fn rect_light_shades(gpu: &Gpu) -> Result<(), Failed> {
    let (origin, u, v) = (Vec3::new(-0.4, 1.0, -0.4), 0.8 * Vec3::X, 0.8 * Vec3::Z);
    let lamp = Light::Point { position: Vec3::new(0.0, 2.0, 0.0), intensity: Vec3::splat(9.0) };
    let rect = Light::Rect { origin, u, v, radiance: Vec3::ZERO };
    let settings = direct();
    let seen = picture(gpu, &plane_scene(vec![lamp, rect], None), &camera(), settings)?;
    let (mut dark, mut lit) = (0, 0);
    for (n, p) in shown_points(&settings, None) {
        // The shadow's half side is 0.8; its edge is not judged.
        let edge = p.x.abs().max(p.z.abs()) - 0.8;
        if edge < -0.1 {
            dark += 1;
            assert_eq!(seen[n], Vec3::ZERO, "in the shadow at {p}");
        } else if edge > 0.1 {
            lit += 1;
            let way = Vec3::new(0.0, 2.0, 0.0) - p;
            let expected = ALBEDO / PI * 9.0 * way.normalize_or_zero().y / way.length_squared();
            assert!((seen[n].x - expected).abs() < 0.01 * expected, "{} {expected} at {p}", seen[n].x);
        }
    }
    assert!(dark > 300 && lit > 300, "{dark} {lit}");
    Ok(())
}

fn open_sky(gpu: &Gpu) -> Result<(), Failed> {
    let settings = direct();
    let radiance = Vec3::new(0.5, 0.75, 1.0);
    let scene = Scene { sky: radiance, ..plane_scene(Vec::new(), None) };
    let seen = picture(gpu, &scene, &camera(), settings)?;
    let (mean, worst) = errors(&seen, &shown_points(&settings, None), |_| ALBEDO * radiance)?;
    assert!(mean < 0.005 && worst < 0.01, "mean {mean:.4}, worst {worst:.4}");
    Ok(())
}

fn sky_under_a_roof(gpu: &Gpu) -> Result<(), Failed> {
    let roof = (Vec3::new(0.0, 0.8, 0.0), 1.2);
    let settings = Settings { area_samples: 1024, ..direct() };
    let scene = Scene { sky: Vec3::ONE, ..plane_scene(Vec::new(), Some(roof)) };
    let seen = picture(gpu, &scene, &camera(), settings)?;
    // The roof's form factor, as an integral over its area.
    let expected = |p: Vec3| {
        let mut factor = 0.0;
        for i in 0..POINTS * POINTS {
            let (s, t) = ((i % POINTS) as f32 + 0.5, (i / POINTS) as f32 + 0.5);
            let at = roof.0 + roof.1 * (Vec3::new(s, 0.0, t) / POINTS as f32 - Vec3::new(0.5, 0.0, 0.5));
            let way = at - p;
            factor += way.y * way.y / (PI * way.length_squared() * way.length_squared());
        }
        Vec3::splat(ALBEDO * (1.0 - factor * roof.1 * roof.1 / (POINTS * POINTS) as f32))
    };
    let (mean, worst) = errors(&seen, &shown_points(&settings, Some(roof)), expected)?;
    assert!(mean < 0.01 && worst < 0.04, "mean {mean:.4}, worst {worst:.4}");
    Ok(())
}

/// Lamps on an 8 x 8 lattice, each of another colour.
fn lattice(count: usize) -> Vec<Light> {
    let lamp = |n: usize| {
        let position =
            Vec3::new((n % 8) as f32 / 2.0 - 1.75, 0.7 + 0.01 * n as f32, (n / 8) as f32 / 2.0 - 1.75);
        let color = Vec3::new(0.2 + (n % 3) as f32, 0.2 + (n % 5) as f32, 0.2 + (n % 7) as f32);
        Light::Point { position, intensity: 0.1 * color }
    };
    (0..count).map(lamp).collect()
}

fn many_lights(gpu: &Gpu) -> Result<(), Failed> {
    let lights = lattice(64);
    let settings = Settings { shadow_size: 512, ..direct() };
    let seen = picture(gpu, &plane_scene(lights.clone(), None), &camera(), settings)?;
    let expected = |p: Vec3| {
        lights.iter().fold(Vec3::ZERO, |sum, light| {
            let Light::Point { position, intensity } = *light else { return sum };
            let way = position - p;
            sum + ALBEDO / PI * intensity * way.normalize_or_zero().y / way.length_squared()
        })
    };
    let (mean, worst) = errors(&seen, &shown_points(&settings, None), expected)?;
    assert!(mean < 0.003 && worst < 0.01, "mean {mean:.4}, worst {worst:.4}");
    Ok(())
}

fn lights_in_the_volume(gpu: &Gpu) -> Result<(), Failed> {
    let lights = lattice(64);
    let render = |lights: &[Light]| -> Result<Vec<f32>, Failed> {
        let settings = Settings { layer: Layer::Voxels, rsm_size: 128, points: 128, ..small() };
        let mut renderer = Renderer::new(gpu, &plane_scene(lights.to_vec(), None), settings)?;
        renderer.set_camera(&crate::scenes::skyward());
        renderer.frame(None)?;
        radiosities(gpu, &renderer)
    };
    let together = render(&lights)?;
    let mut apart = vec![0.0; together.len()];
    for part in lights.chunks(16) {
        apart.iter_mut().zip(render(part)?).for_each(|(sum, r)| *sum += r);
    }
    let (total, expected): (f32, f32) = (together.iter().sum(), apart.iter().sum());
    assert!(expected > 1.0 && (total - expected).abs() < 0.01 * expected, "{total} {expected}");
    let strays = together.iter().zip(&apart).filter(|(a, b)| (**a - **b).abs() > 0.05 * expected / 400.0);
    assert!(strays.count() < together.len() / 100, "cells differ");
    Ok(())
}

/// The light of a volume's cells under a near, bright lamp and a dim sky is the sum of both, on a thin floor as well as on
/// a thick one.
fn lamp_and_sky(gpu: &Gpu) -> Result<(), Failed> {
    let lamp = Light::Point { position: Vec3::new(0.5, 1.0, -0.3), intensity: Vec3::splat(6.0) };
    let thin = plane_scene(Vec::new(), None);
    let mut thick = Scene::default();
    let faces = block(Vec3::new(-2.0, -0.5, -2.0), Vec3::new(2.0, 0.0, 2.0));
    add(&mut thick, Material::matte("floor", Vec3::splat(ALBEDO)), &faces);
    for mut scene in [thin, thick] {
        let mut total = |lights: &[Light], sky: f32| -> Result<f32, Failed> {
            scene.lights = lights.to_vec();
            scene.sky = Vec3::splat(sky);
            let settings = Settings { layer: Layer::Voxels, area_maps: 32, ..small() };
            let mut renderer = Renderer::new(gpu, &scene, settings)?;
            renderer.set_camera(&crate::scenes::skyward());
            renderer.frame(None)?;
            let grid = *renderer.volume().grid();
            let above = grid.cells().filter(|&c| grid.center(c).y > -grid.cell_size);
            let cells = radiosities(gpu, &renderer)?;
            Ok(above.map(|c| cells[grid.index(c)]).sum())
        };
        let (of_lamp, of_sky, of_both) = (total(&[lamp], 0.0)?, total(&[], 0.2)?, total(&[lamp], 0.2)?);
        let sum = of_lamp + of_sky;
        assert!(of_sky > 0.05 * sum && of_lamp > 0.05 * sum, "{of_lamp} {of_sky}");
        assert!((of_both - sum).abs() < 0.03 * sum, "{of_lamp} + {of_sky} gives {of_both}");
    }
    Ok(())
}
