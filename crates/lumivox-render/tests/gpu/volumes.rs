//! Shadow volumes of what bends.

use std::path::Path;

use glam::{DVec3, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Layer, Renderer, Settings};
use lumivox_scene::{Camera, Light, Material};

use crate::camera::rays;
use crate::moving::{AssetCheck, load};
use crate::scenes::{Quad, add, small};

pub(crate) const WITH_ASSETS: &[(&str, AssetCheck)] =
    &[("a walking man's shadow by volumes is that of rays", |gpu, assets| {
        man(gpu, &assets.join("animated/CesiumMan.glb"))
    })];

const SUN: Vec3 = Vec3::new(0.0, -0.8, -0.6);
/// What a pixel's place may be off, in metres on the floor: nearer to a shadow's border it is not judged.
const OFF: f64 = 0.005;

/// Whether a ray meets a triangle.
fn meets([a, b, c]: &[DVec3; 3], start: DVec3, along: DVec3) -> bool {
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| (p - start).cross(q - start).dot(along));
    let normal = (b - a).cross(c - a);
    let is_before = (a - start).dot(normal) / along.dot(normal) > 0.0;
    is_before && (sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0))
}

/// He stands on a floor, and is bent as he is in the middle of two steps.
fn man(gpu: &Gpu, path: &Path) -> Result<(), Failed> {
    let mut scene = load(path)?;
    scene.lights = vec![Light::Directional { direction: SUN, irradiance: Vec3::splat(3.0) }];
    let man = scene.instances.len();
    let floor = Quad::level(Vec3::ZERO, 4.0);
    add(&mut scene, Material::matte("floor", Vec3::ONE), &[floor]);
    let settings = Settings { layer: Layer::Direct, volume_shadows: true, clip: Some(0), ..small() };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    let camera = Camera::look("beside", Vec3::new(2.0, 2.2, -0.8), Vec3::new(0.0, 0.0, -0.6), 50.0);
    renderer.set_camera(&camera);
    let mut shadows = Vec::new();
    for time in [0.3, 0.8] {
        let pose = scene.pose(0, time);
        scene.apply(&pose);
        renderer.set_pose(&pose);
        renderer.frame(None)?;
        let seen = renderer.read_picture()?;
        let bent: Vec<[DVec3; 3]> = scene.instances[..man]
            .iter()
            .flat_map(|instance| {
                let mesh = &scene.meshes[instance.mesh];
                let place = |i: u32| {
                    let local = Vec3::from(mesh.positions[i as usize]);
                    instance.world_from_local.transform_point3(local).as_dvec3()
                };
                mesh.indices.iter().map(move |corners| corners.map(place))
            })
            .collect();
        let is_met = |p: DVec3, along: DVec3| bent.iter().any(|t| meets(t, p, along));
        let lit = std::f32::consts::FRAC_1_PI * 3.0 * -SUN.y;
        let (mut shadow, mut judged) = (Vec::new(), 0);
        for (n, ray) in rays(&camera, settings.size).into_iter().enumerate() {
            let Some((distance, inside)) = ray.meets(floor.corner, floor.u, floor.v) else { continue };
            let p = (ray.origin + distance * ray.direction).as_dvec3();
            let around = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|way| p + OFF * way);
            let is_seen = !around.iter().any(|q| is_met(*q, camera.eye.as_dvec3() - q));
            let is_dark = around.map(|q| is_met(q, -SUN.as_dvec3()));
            if inside < 0.05 || !is_seen || is_dark.iter().any(|is| *is != is_dark[0]) {
                continue;
            }
            judged += 1;
            let expected = if is_dark[0] { 0.0 } else { lit };
            assert!(
                (seen[n].y - expected).abs() < 0.01 * lit,
                "{time} s: {} of {expected} at {p}",
                seen[n].y
            );
            shadow.extend(is_dark[0].then_some(n));
        }
        assert!(judged > 1500 && shadow.len() > 80, "{judged} pixels judged, {} in shadow", shadow.len());
        shadows.push(shadow);
    }
    assert!(shadows[0] != shadows[1], "he does not move");
    Ok(())
}
