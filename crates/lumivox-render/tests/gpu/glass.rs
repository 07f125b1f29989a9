//! Glass in scenes: what is behind is seen through it, and everything else is as without it.

use glam::{Mat4, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, GlassSettings, Layer, Renderer, Settings};
use lumivox_scene::{Camera, Glass, Instance, Light, Material, Mesh, Scene};

use crate::Check;
use crate::camera::rays;
use crate::scenes::{Quad, add, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("glass is seen through and tints by its thickness", seen_through),
    ("an open mesh of glass is a thin pane, and is told", open_mesh),
];

/// A lit floor, and a cube of 1 m over it.
fn scene(glass: Glass, faces: usize) -> Scene {
    let mut scene = Scene::default();
    scene.lights.push(Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(3.0) });
    add(&mut scene, Material::matte("floor", Vec3::splat(0.5)), &[Quad::level(Vec3::ZERO, 4.0)]);
    scene
        .materials
        .push(Material { glass: Some(glass), ..Material::matte("glass", Vec3::new(1.0, 0.5, 1.0)) });
    let corner = |n: u32| [n & 1, n >> 1 & 1, n >> 2 & 1].map(|c| c as f32 - 0.5);
    let cube = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    let mesh = Mesh::flat("cube", (0..8).map(corner).collect(), cube[..faces].to_vec(), 1);
    scene.meshes.push(mesh);
    let world_from_local = Mat4::from_translation(Vec3::new(0.0, 1.5, 0.0));
    scene.instances.push(Instance { mesh: 1, world_from_local });
    scene
}

fn camera() -> Camera {
    Camera::look("above", Vec3::new(0.0, 6.0, 0.01), Vec3::ZERO, 40.0)
}

fn rendered(gpu: &Gpu, scene: &Scene, glass: bool, layer: Layer) -> Result<(Vec<Vec3>, Renderer), Failed> {
    let glass = glass.then(GlassSettings::default);
    let settings = Settings { gi: GiMethod::Off, layer, glass, ..small() };
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    renderer.set_camera(&camera());
    renderer.frame(None)?;
    Ok((renderer.read_picture()?, renderer))
}

/// Whether a pixel looks at the middle of the cube, or well beside it and what it might mirror.
fn sides(picture: &[Vec3]) -> [Vec<Vec3>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for (ray, seen) in rays(&camera(), small().size).into_iter().zip(picture) {
        let at = |height: f32| ray.origin + (height - ray.origin.y) / ray.direction.y * ray.direction;
        let (top, floor) = (at(2.0), at(0.0));
        if top.x.abs().max(top.z.abs()) < 0.3 {
            found[0].push(*seen);
        } else if top.x.abs().max(top.z.abs()) > 0.8 && floor.x.abs().max(floor.z.abs()) < 1.8 {
            found[1].push(*seen);
        }
    }
    found
}

fn seen_through(gpu: &Gpu) -> Result<(), Failed> {
    let glass = Glass { color: Vec3::new(0.5, 1.0, 1.0), distance: 0.5, bend: Some(0.0), ..Glass::default() };
    let scene = scene(glass, 12);
    let floor = 0.5 * 3.0 / std::f32::consts::PI;
    // The floor is lit through glass: it throws no shadow. A quarter of red is left by a metre, half of green by the tint, and a
    // twenty-fifth is mirrored of a black sky.
    let expected = 0.96 * floor * Vec3::new(0.25, 0.5, 1.0);
    let (picture, mut renderer) = rendered(gpu, &scene, true, Layer::Final)?;
    let [through, beside] = sides(&picture);
    assert!(through.len() > 100 && beside.len() > 100);
    for seen in through {
        assert!((seen - expected).abs().max_element() < 0.03 * floor, "{seen} of {expected}");
    }
    for seen in beside {
        assert!((seen - floor).abs().max_element() < 0.01 * floor, "{seen} of {floor}");
    }
    // Live: the same glass without colour.
    let kind = renderer.glass().first().ok_or("a kind of glass")?.glass;
    renderer.set_glass(0, lumivox::refraction::Glass { through: Vec3::ONE, tint: Vec3::ONE, ..kind });
    renderer.frame(None)?;
    let [through, _] = sides(&renderer.read_picture()?);
    assert!(through.iter().all(|seen| (*seen - 0.96 * floor).abs().max_element() < 0.02 * floor));
    // A metre thick.
    let (metres, _) = rendered(gpu, &scene, true, Layer::Thickness)?;
    let [through, beside] = sides(&metres);
    assert!(through.iter().all(|m| (m.x - 1.0).abs() < 0.07) && beside.iter().all(|m| m.x == 0.0));
    // Without refraction it is a cube that hides the floor.
    let (picture, renderer) = rendered(gpu, &scene, false, Layer::Final)?;
    let [through, _] = sides(&picture);
    let top = 3.0 / std::f32::consts::PI;
    assert!(through.iter().all(|seen| (*seen - top * Vec3::new(1.0, 0.5, 1.0)).abs().max_element() < 0.02));
    assert!(renderer.glass().is_empty());
    Ok(())
}

fn open_mesh(gpu: &Gpu) -> Result<(), Failed> {
    // Thick, it would be black.
    let glass = Glass { color: Vec3::ZERO, distance: 0.1, ..Glass::default() };
    let (picture, renderer) = rendered(gpu, &scene(glass, 10), true, Layer::Final)?;
    let kinds = renderer.glass();
    assert_eq!((kinds.len(), kinds[0].open_edges, kinds[0].glass.is_thin), (1, 4, true));
    let floor = 0.5 * 3.0 / std::f32::consts::PI;
    let expected = 0.96 * floor * Vec3::new(1.0, 0.5, 1.0);
    let [through, _] = sides(&picture);
    assert!(
        through.iter().all(|seen| (*seen - expected).abs().max_element() < 0.02 * floor),
        "{:?}",
        through.first()
    );
    Ok(())
}
