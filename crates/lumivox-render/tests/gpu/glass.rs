//! Glass in scenes: what is behind is seen through it, and everything else is as without it.

use glam::{Mat4, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, GlassIssue, GlassNote, GlassSettings, Layer, Renderer, Settings};
use lumivox_scene::{Camera, Glass, Instance, Light, Material, Mesh, Scene};

use crate::Check;
use crate::camera::rays;
use crate::scenes::{Quad, add, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("glass is seen through and tints by its thickness", seen_through),
    ("an open mesh of glass is a thin pane, and is told", open_mesh),
    ("an open mesh is thin where four thick kinds come before it", fifth_kind),
    ("glass turned inside out is turned round, and is told", inside_out),
    ("panes far away leave the thickness of other glass alone", panes),
    ("a pane is the same from both sides", both_sides),
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

fn fifth_kind(gpu: &Gpu) -> Result<(), Failed> {
    let black = Glass { color: Vec3::ZERO, distance: 0.1, ..Glass::default() };
    let mut scene = scene(black, 10);
    let open = scene.instances.pop().ok_or("an open cube")?;
    let closed = self::scene(black, 12).meshes.pop().ok_or("a cube")?;
    for n in 0..4 {
        let glass = Material { glass: Some(black), ..Material::matte("other", Vec3::ONE) };
        scene.materials.push(glass);
        scene.meshes.push(Mesh { material: scene.materials.len() - 1, ..closed.clone() });
        let world_from_local = Mat4::from_translation(Vec3::new(20.0 + 3.0 * n as f32, 1.5, 0.0));
        scene.instances.push(Instance { mesh: scene.meshes.len() - 1, world_from_local });
    }
    scene.instances.push(open);
    let (picture, renderer) = rendered(gpu, &scene, true, Layer::Final)?;
    let thin: Vec<usize> = renderer.glass().iter().filter(|k| k.glass.is_thin).map(|k| k.material).collect();
    assert_eq!((renderer.glass().len(), thin), (4, vec![1]));
    let told = [
        GlassNote { material: 1, issue: GlassIssue::Open { edges: 4 } },
        GlassNote { material: 5, issue: GlassIssue::LooksLike { material: 4 } },
    ];
    assert_eq!(renderer.glass_notes(), told);
    let floor = 0.5 * 3.0 / std::f32::consts::PI;
    let expected = 0.96 * floor * Vec3::new(1.0, 0.5, 1.0);
    let [through, _] = sides(&picture);
    assert!(through.len() > 100);
    for seen in through {
        assert!((seen - expected).abs().max_element() < 0.02 * floor, "{seen} of {expected}");
    }
    Ok(())
}

fn inside_out(gpu: &Gpu) -> Result<(), Failed> {
    let glass = Glass { color: Vec3::new(0.5, 1.0, 1.0), distance: 0.5, ..Glass::default() };
    let scene = scene(glass, 12);
    let (expected, renderer) = rendered(gpu, &scene, true, Layer::Final)?;
    assert!(renderer.glass_notes().is_empty());
    let [through, _] = sides(&expected);
    assert!(through.iter().all(|seen| seen.max_element() > 0.1));
    // With normals that look inward, as importers make them of such faces, and with those of the file.
    for turns_normals in [true, false] {
        let mut turned = scene.clone();
        turned.meshes[1].indices.iter_mut().for_each(|t| t.swap(1, 2));
        if turns_normals {
            turned.meshes[1].normals.iter_mut().for_each(|n| *n = n.map(|c| -c));
        }
        let (picture, renderer) = rendered(gpu, &turned, true, Layer::Final)?;
        let told = GlassNote { material: 1, issue: GlassIssue::InsideOut { meshes: 1 } };
        assert_eq!(renderer.glass_notes(), [told]);
        let off = picture.iter().zip(&expected).map(|(a, b)| (*a - *b).abs().max_element());
        assert!(off.fold(0.0, f32::max) < 1e-3, "turned normals: {turns_normals}");
    }
    Ok(())
}

/// A pane of 400 m a side, looking up or down.
fn add_pane(scene: &mut Scene, height: f32, up: bool) {
    let glass = Some(Glass { is_thin: true, ..Glass::default() });
    scene.materials.push(Material { glass, ..Material::matte("pane", Vec3::new(0.5, 1.0, 1.0)) });
    let corners =
        [[-200.0, height, 200.0], [200.0, height, 200.0], [200.0, height, -200.0], [-200.0, height, -200.0]];
    let indices = if up { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[0, 2, 1], [0, 3, 2]] };
    scene.meshes.push(Mesh::flat("pane", corners.to_vec(), indices, scene.materials.len() - 1));
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance { mesh, world_from_local: Mat4::IDENTITY });
}

fn panes(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = scene(Glass::default(), 12);
    add_pane(&mut scene, -150.0, true);
    let (metres, renderer) = rendered(gpu, &scene, true, Layer::Thickness)?;
    assert_eq!(renderer.glass().len(), 2);
    // Said to be thin, so nobody needs to be told of its open edges.
    assert!(renderer.glass_notes().is_empty());
    let [through, beside] = sides(&metres);
    assert!(through.len() > 100 && beside.len() > 100);
    for metres in through {
        assert!((metres.x - 1.0).abs() < 0.07, "{metres}");
    }
    assert!(beside.iter().all(|m| m.x == 0.0));
    Ok(())
}

fn both_sides(gpu: &Gpu) -> Result<(), Failed> {
    let floor = 0.5 * 3.0 / std::f32::consts::PI;
    let expected = 0.96 * floor * Vec3::new(0.5, 1.0, 1.0);
    for up in [true, false] {
        let mut scene = scene(Glass::default(), 12);
        scene.instances.pop();
        add_pane(&mut scene, 2.0, up);
        let [through, _] = sides(&rendered(gpu, &scene, true, Layer::Final)?.0);
        assert!(through.len() > 100);
        for seen in through {
            assert!((seen - expected).abs().max_element() < 0.02 * floor, "{seen} of {expected}, up: {up}");
        }
    }
    Ok(())
}
