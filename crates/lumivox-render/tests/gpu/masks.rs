//! Masked surfaces: holes for the camera, for shadows and for reflective shadow maps.

use glam::{Mat4, Vec3, Vec4};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, LeafShadowSettings, Renderer, Settings};
use lumivox_scene::{AlphaMode, Camera, Instance, Light, Material, Scene, SpotFalloff, Texture, Wrap};

use crate::Check;
use crate::camera::{Ray, rays};
use crate::scenes::{Quad, add, picture, radiosities, skyward, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("the camera sees through the holes of a mask", seen_through),
    ("light passes the holes of a mask", lit_through),
    ("reflective shadow maps have the holes of a mask", injected_through),
    ("a blended surface is solid from one half on", blended),
    ("leaves take a part of the sun, one after the other", leaves_let_through),
    ("volumes shade for opaque surfaces, and maps for those with holes", volumes_and_maps),
    ("leaves take a part of point lights, in their colours", |gpu| leaves_before_a_lamp(gpu, false)),
    ("leaves take a part of spots, in their colours", |gpu| leaves_before_a_lamp(gpu, true)),
];

/// Albedos of sRGB 124 and 231.
const FLOOR: f32 = 0.2015563;
const LEAF: f32 = 0.7991027;
/// Half a texel of the mask, where it may end a little to either side.
const BORDER: f32 = 0.08;

/// A floor, and over it a leaf that is a hole for x < 0.
fn leaf_scene(alpha: AlphaMode, opacity: [u8; 2]) -> (Scene, Quad, Quad) {
    let mut scene = Scene::default();
    scene.lights.push(Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(3.0) });
    let texel = |n: u32| [255, 255, 255, opacity[usize::from(n % 16 >= 8)]];
    scene.textures.push(Texture {
        name: "leaf".to_owned(),
        width: 16,
        height: 16,
        srgb: true,
        pixels: (0..256).flat_map(texel).collect(),
        wrap: [Wrap::Clamp; 2],
    });
    let (floor, leaf) = (Quad::level(Vec3::ZERO, 3.0), Quad::level(Vec3::Y, 1.0));
    add(&mut scene, Material::matte("floor", Vec3::splat(FLOOR)), &[floor]);
    let base_color = Vec4::new(LEAF, LEAF, LEAF, 1.0);
    let material = Material {
        name: "leaf".to_owned(),
        base_color,
        base_color_texture: Some(0),
        alpha,
        ..Material::default()
    };
    add(&mut scene, material, &[leaf]);
    (scene, floor, leaf)
}

const MASK: AlphaMode = AlphaMode::Mask { cutoff: 0.5 };

fn from_above() -> Camera {
    Camera::look("above", Vec3::new(0.0, 3.0, 0.6), Vec3::ZERO, 40.0)
}

/// What a ray meets in the scene: true for the solid half of the leaf. None near a border.
fn meets_leaf(ray: Ray, leaf: Quad, solid_from: f32) -> Option<bool> {
    let Some((distance, inside)) = ray.meets(leaf.corner, leaf.u, leaf.v) else { return Some(false) };
    let x = (ray.origin + distance * ray.direction).x;
    if inside.abs() < BORDER || (inside > 0.0 && (x - solid_from).abs() < BORDER) {
        return None;
    }
    Some(inside > 0.0 && x > solid_from)
}

fn check_seen(gpu: &Gpu, alpha: AlphaMode, opacity: [u8; 2]) -> Result<(), Failed> {
    let (scene, floor, leaf) = leaf_scene(alpha, opacity);
    let settings = Settings { layer: Layer::Albedo, ..small() };
    let seen = picture(gpu, &scene, &from_above(), settings)?;
    let mut counts = [0; 2];
    for (ray, seen) in rays(&from_above(), settings.size).into_iter().zip(seen) {
        let on_floor = ray.meets(floor.corner, floor.u, floor.v).is_some_and(|(_, inside)| inside > BORDER);
        let Some(on_leaf) = meets_leaf(ray, leaf, 0.0).filter(|_| on_floor) else { continue };
        let expected = if on_leaf { LEAF } else { FLOOR };
        counts[usize::from(on_leaf)] += 1;
        assert!((seen - expected).abs().max_element() < 0.01, "{seen} instead of {expected}");
    }
    assert!(counts[0] > 500 && counts[1] > 500, "{counts:?}");
    Ok(())
}

fn seen_through(gpu: &Gpu) -> Result<(), Failed> {
    check_seen(gpu, MASK, [0, 255])
}

fn blended(gpu: &Gpu) -> Result<(), Failed> {
    check_seen(gpu, AlphaMode::Blend, [110, 145])
}

fn lit_through(gpu: &Gpu) -> Result<(), Failed> {
    let (scene, floor, leaf) = leaf_scene(MASK, [0, 255]);
    let settings = Settings { layer: Layer::Direct, ..small() };
    // Low enough to look under the leaf.
    let camera = Camera::look("low", Vec3::new(0.0, 0.7, 2.2), Vec3::new(0.0, 0.0, 0.0), 50.0);
    let seen = picture(gpu, &scene, &camera, settings)?;
    let mut counts = [0; 2];
    for (ray, seen) in rays(&camera, settings.size).into_iter().zip(seen) {
        let Some((distance, inside)) = ray.meets(floor.corner, floor.u, floor.v) else { continue };
        if inside < BORDER {
            continue;
        }
        let point = ray.origin + distance * ray.direction;
        let up = Ray { origin: point, direction: Vec3::Y };
        let Some(shaded) = meets_leaf(up, leaf, 0.0) else { continue };
        let expected = if shaded { 0.0 } else { FLOOR * 3.0 / std::f32::consts::PI };
        counts[usize::from(shaded)] += 1;
        assert!((seen - expected).abs().max_element() <= 0.01 * expected, "{seen} at {point}: {expected}");
    }
    assert!(counts[0] > 500 && counts[1] > 150, "{counts:?}");
    Ok(())
}

fn injected_through(gpu: &Gpu) -> Result<(), Failed> {
    let (scene, _, leaf) = leaf_scene(MASK, [0, 255]);
    let settings = Settings { gi: GiMethod::Propagation, grid: 32, ..small() };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&skyward());
    renderer.frame(None)?;
    let light = radiosities(gpu, &renderer)?;
    let grid = *renderer.volume().grid();
    let mut counts = [0; 2];
    // The floor's cells lie under its plane.
    for cell in grid.cells().filter(|&c| (grid.center(c).y + 0.5 * grid.cell_size).abs() < 1e-3) {
        let p = grid.center(cell);
        let shaded = meets_leaf(Ray { origin: p, direction: Vec3::Y }, leaf, 0.0);
        // A cell that is shaded in part has the mean of its lit part: judge whole ones.
        let reach = 0.5 * grid.cell_size + 0.04;
        let apart = [p.x - 0.0, p.x - 0.5, p.x + 0.5, p.z - 0.5, p.z + 0.5].map(f32::abs);
        if apart.iter().any(|&d| d < reach) || p.x.abs().max(p.z.abs()) > 1.4 {
            continue;
        }
        let Some(shaded) = shaded else { continue };
        let expected = if shaded { 0.0 } else { 3.0 * FLOOR * 3.0 };
        counts[usize::from(shaded)] += 1;
        let light = light[grid.index(cell)];
        assert!((light - expected).abs() <= 0.02 * expected, "{light} at {p}: {expected}");
    }
    assert!(counts[0] > 200 && counts[1] > 10, "{counts:?}");
    Ok(())
}

/// Angle from a spot's axis up to which it is full.
const BEAM: f32 = 0.9;

/// A lamp over a leaf, near and far to its side: each of its six maps is asked, or the one of a spot that looks at the floor's middle, light takes the leaf's colour, and what is said to be
/// an absorber takes what it says. What a leaf takes changes from frame to frame.
fn leaves_before_a_lamp(gpu: &Gpu, is_spot: bool) -> Result<(), Failed> {
    let (mut scene, ..) = leaf_scene(MASK, [0, 255]);
    let camera = Camera::look("below", Vec3::new(0.0, 0.3, 0.0), Vec3::new(0.0, 0.0, 0.001), 100.0);
    for (lamp, stated) in [(Vec3::new(0.0, 1.6, 0.0), false), (Vec3::new(1.2, 3.0, 0.0), true)] {
        let intensity = Vec3::splat(3.0);
        scene.lights = vec![if is_spot {
            let falloff = SpotFalloff::default();
            Light::Spot { position: lamp, direction: -lamp, intensity, beam: BEAM, cutoff: 1.1, falloff }
        } else {
            Light::Point { position: lamp, intensity }
        }];
        scene.materials[1].base_color = Vec4::new(0.4, 0.8, 0.0, 1.0);
        scene.materials[1].absorber = stated.then_some(Vec3::new(0.9, 0.2, 0.5));
        let leaves =
            LeafShadowSettings { sigma: 0.3, size: 512, slices: 64, is_colored: true, ..Default::default() };
        let settings = Settings { layer: Layer::Direct, leaf_shadows: Some(leaves), ..small() };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&camera);
        for sigma in [0.3f32, 0.6] {
            renderer.set_leaf_sigma(sigma);
            renderer.frame(None)?;
            let left =
                if stated { Vec3::new(0.9, 0.2, 0.5) } else { (1.0 - sigma) * Vec3::new(0.5, 1.0, 0.0) };
            let mut counts = [0; 2];
            for (ray, seen) in rays(&camera, settings.size).into_iter().zip(renderer.read_picture()?) {
                let p = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
                // Where the way to the lamp crosses the leaf's height, a metre up.
                let at = p + (lamp - p) / lamp.y;
                let border = [at.x, at.x.abs() - 0.5, at.z.abs() - 0.5].map(f32::abs);
                if border.iter().any(|b| *b < BORDER) || p.abs().max_element() > 0.8 {
                    continue;
                }
                if is_spot && (p - lamp).angle_between(-lamp) > BEAM - 0.01 {
                    continue;
                }
                let is_shaded = at.x > 0.0 && at.x < 0.5 && at.z.abs() < 0.5;
                let way = lamp - p;
                let lit = FLOOR / std::f32::consts::PI * 3.0 * way.y / way.length().powi(3);
                let expected = if is_shaded { lit * left } else { Vec3::splat(lit) };
                counts[usize::from(is_shaded)] += 1;
                assert!((seen - expected).abs().max_element() < 0.02 * lit, "{seen} of {expected} at {p}");
            }
            assert!(counts[1] > 100 && counts[0] > 100, "{counts:?}");
        }
    }
    Ok(())
}

/// With transmittance shadow maps the solid half of the leaf takes a part of the sun, and two leaves that part of the rest.
fn leaves_let_through(gpu: &Gpu) -> Result<(), Failed> {
    let (mut scene, ..) = leaf_scene(MASK, [0, 255]);
    scene.meshes.push(scene.meshes[1].clone());
    let place = Mat4::from_translation(0.5 * Vec3::Y);
    scene.instances.push(Instance { mesh: 2, world_from_local: place });
    let camera = Camera::look("below", Vec3::new(0.0, 0.3, 0.0), Vec3::new(0.0, 0.0, 0.001), 100.0);
    let sun = FLOOR * 3.0 / std::f32::consts::PI;
    for (sigma, moved, left) in [(0.3, 0.5, 0.49), (0.3, 5.0, 0.7), (1.0, 0.5, 0.0)] {
        let leaf_shadows =
            Some(LeafShadowSettings { sigma, size: 256, slices: 64, ..LeafShadowSettings::default() });
        scene.instances[2].world_from_local =
            Mat4::from_translation(moved * (Vec3::Y + Vec3::X * f32::from(moved > 1.0)));
        let settings = Settings { layer: Layer::Direct, leaf_shadows, ..small() };
        let seen = picture(gpu, &scene, &camera, settings)?;
        let mut counts = [0; 2];
        for (ray, seen) in rays(&camera, settings.size).into_iter().zip(seen) {
            let p = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
            if p.x.abs() < BORDER || p.abs().max_element() > 0.5 - BORDER {
                continue;
            }
            let (which, expected) = if p.x > 0.0 { (1, left * sun) } else { (0, sun) };
            counts[which] += 1;
            assert!((seen.y - expected).abs() < 0.01 * sun, "sigma {sigma}: {} of {expected} at {p}", seen.y);
        }
        assert!(counts.iter().all(|&n| n > 100), "{counts:?}");
    }
    Ok(())
}

/// With shadow volumes an opaque leaf shades by its volume, and one with holes by the map.
fn volumes_and_maps(gpu: &Gpu) -> Result<(), Failed> {
    let camera = Camera::look("below", Vec3::new(0.0, 0.6, 0.0), Vec3::new(0.0, 0.0, 0.001), 110.0);
    let sun = FLOOR * 3.0 / std::f32::consts::PI;
    for (alpha, left) in [(AlphaMode::Opaque, 0.0), (MASK, sun)] {
        let (scene, ..) = leaf_scene(alpha, [0, 255]);
        let settings = Settings { layer: Layer::Direct, volume_shadows: true, ..small() };
        let seen = picture(gpu, &scene, &camera, settings)?;
        let mut counts = [0; 3];
        for (ray, seen) in rays(&camera, settings.size).into_iter().zip(seen) {
            let p = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
            let outside = p.abs().max_element() - 0.5;
            if p.x.abs() < BORDER || outside.abs() < BORDER {
                continue;
            }
            let (which, expected) = match (outside > 0.0, p.x > 0.0) {
                (true, _) => (0, sun),
                (false, true) => (1, 0.0),
                (false, false) => (2, left),
            };
            counts[which] += 1;
            assert!((seen.y - expected).abs() < 0.01 * sun, "{alpha:?}: {} of {expected} at {p}", seen.y);
        }
        assert!(counts.iter().all(|&n| n > 100), "{counts:?}");
    }
    Ok(())
}
