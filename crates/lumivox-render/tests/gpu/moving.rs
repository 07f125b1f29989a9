//! What moves is the same in the picture, in its shadow and in the volume.

use std::path::Path;

use glam::{Mat4, UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Clip, Light, Material, Scene, Track, Transform};

use crate::Check;
use crate::camera::rays;
use crate::scenes::{Quad, add, block, occupied, settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("a moved block moves in picture, shadow and volume", |gpu| moved(gpu, VoxelSource::Progressive)),
    ("a moved block moves in the single-pass form too", |gpu| moved(gpu, VoxelSource::SinglePass)),
    ("a moved block moves where what stands still comes from triangles", |gpu| {
        moved(gpu, VoxelSource::Hybrid)
    }),
    ("a moved block moves in a volume of triangles", |gpu| moved(gpu, VoxelSource::Triangles)),
    ("a moving lamp moves its light", moving_lamp),
];

/// A test that is given the folder of models.
pub(crate) type AssetCheck = fn(&Gpu, &Path) -> Result<(), Failed>;

/// Those that need models.
pub(crate) const WITH_ASSETS: &[(&str, AssetCheck)] = &[
    ("a fox by a coloured wall takes its colour", |gpu, assets| fox(gpu, &assets.join("animated/Fox.glb"))),
    ("a walking man leaves no trail where a view sees the floor", |gpu, assets| {
        man(gpu, &assets.join("animated/CesiumMan.glb"))
    }),
];

const FLOOR: f32 = 6.0;
const SUN: Light =
    Light::Directional { direction: Vec3::new(0.0, -0.8, -0.6), irradiance: Vec3::new(3.0, 3.0, 3.0) };

/// A camera high above the floor.
fn above() -> Camera {
    Camera {
        name: "above".to_owned(),
        eye: Vec3::new(0.0, 9.0, 0.1),
        target: Vec3::ZERO,
        up: Vec3::NEG_Z,
        fov_y: 0.8,
    }
}

fn settings(voxels: VoxelSource) -> Settings {
    Settings { voxels, gi: GiMethod::Propagation, clip: Some(0), layer: Layer::Direct, ..small() }
}

/// A black block on a white floor, in the sun, that slides from x = -1.5 to 1.5 within a second.
pub(crate) fn sliding_block() -> Scene {
    let mut scene = Scene { lights: vec![SUN], ..Scene::default() };
    add(&mut scene, Material::matte("floor", Vec3::ONE), &[Quad::level(Vec3::ZERO, FLOOR)]);
    let node = scene.animation.add_node(None, Transform::default());
    let faces = block(Vec3::new(-0.4, 0.0, -0.4), Vec3::new(0.4, 1.0, 0.4));
    add(&mut scene, Material::matte("block", Vec3::splat(0.01)), &faces);
    for instance in scene.instances.len() - faces.len()..scene.instances.len() {
        scene.hang_instance(instance, node);
    }
    let way = Track::translation([(0.0, Vec3::new(-1.5, 0.0, 0.0)), (1.0, Vec3::new(1.5, 0.0, 0.0))]);
    scene.animation.add_clip(Clip::new("slide").with(node, way).lasting(2.0));
    scene
}

fn moved(gpu: &Gpu, voxels: VoxelSource) -> Result<(), Failed> {
    let mut scene = sliding_block();
    let settings = settings(voxels);
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&above());
    for (seconds, x) in [(0.0, -1.5), (0.5, 0.0), (1.0, 1.5)] {
        let pose = scene.pose(0, seconds);
        scene.apply(&pose);
        renderer.set_pose(&pose);
        // What a view proves empty is gone within two frames.
        for _ in 0..2 {
            renderer.frame(None)?;
        }
        let picture = renderer.read_picture()?;
        let grid = *renderer.volume().grid();
        let cells = occupied(gpu, &renderer)?;
        for at in [-1.5, 0.0, 1.5] {
            let here = at == x;
            let shown = |p: Vec3| {
                // The pixel whose ray passes the point nearest.
                let distance =
                    |r: &crate::camera::Ray| (p - r.origin).reject_from(r.direction).length_squared();
                let all = rays(&above(), settings.size);
                let nearest = (0..all.len()).min_by(|&a, &b| distance(&all[a]).total_cmp(&distance(&all[b])));
                nearest.map_or(Vec3::ZERO, |n| picture[n]).x
            };
            let (top, shadow) = (shown(Vec3::new(at, 1.0, 0.0)), shown(Vec3::new(at, 0.0, -0.8)));
            assert_eq!(top < 0.1, here, "block at {at} s {seconds}: {top}");
            assert_eq!(shadow < 0.1, here, "shadow at {at} s {seconds}: {shadow}");
            // Its upper half, well away from the floor.
            let inside = |c: Vec3| (c.x - at).abs() < 0.6 && c.z.abs() < 0.6 && c.y > 0.5 && c.y < 1.3;
            let found = grid.cells().filter(|&c| inside(grid.center(c)) && cells[grid.index(c)]).count();
            assert_eq!(found > 4, here, "volume at {at} s {seconds}: {found} cells");
            assert!(here || found == 0, "volume at {at} s {seconds}: {found} cells are left");
        }
    }
    Ok(())
}

fn moving_lamp(gpu: &Gpu) -> Result<(), Failed> {
    let lamp = Light::Point { position: Vec3::new(-1.0, 1.0, 0.0), intensity: Vec3::splat(3.0) };
    let mut scene = Scene { lights: vec![lamp], ..Scene::default() };
    add(&mut scene, Material::matte("floor", Vec3::ONE), &[Quad::level(Vec3::ZERO, FLOOR)]);
    let node = scene.animation.add_node(None, Transform::at(Vec3::new(-1.0, 1.0, 0.0)));
    scene.hang_light(0, node);
    let way = Track::translation([(0.0, Vec3::new(-1.0, 1.0, 0.0)), (1.0, Vec3::new(1.0, 1.0, 0.0))]);
    scene.animation.add_clip(Clip::new("swing").with(node, way).lasting(2.0));
    let settings = settings(VoxelSource::Progressive);
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&above());
    let mut sides = Vec::new();
    for seconds in [0.0, 1.0] {
        let pose = scene.pose(0, seconds);
        scene.apply(&pose);
        renderer.set_pose(&pose);
        renderer.frame(None)?;
        let picture = renderer.read_picture()?;
        let row = settings.size.x as usize;
        let half = |right: bool| -> f32 {
            picture.iter().enumerate().filter(|(n, _)| (n % row >= row / 2) == right).map(|(_, p)| p.x).sum()
        };
        sides.push(half(true) / half(false));
    }
    // The lamp's places mirror each other.
    assert!(sides[0] < 0.5 && (sides[0] * sides[1] - 1.0).abs() < 0.05, "{sides:?}");
    Ok(())
}

pub(crate) fn load(path: &Path) -> Result<Scene, Failed> {
    Ok(lumivox_scene::load(&path.display().to_string())?)
}

/// The same fox at the same place of its walk, beside a red and beside a grey wall in the sun: the light that the wall
/// adds to its flank has the wall's colour.
fn fox(gpu: &Gpu, path: &Path) -> Result<(), Failed> {
    let flank = |albedo: Vec3, wall_x: f32| -> Result<Vec3, Failed> {
        let mut scene = load(path)?;
        let clip = scene.clips().iter().position(|c| c.name == "Walk").ok_or("no clip Walk")?;
        scene.materials[0] = Material::matte("white fox", Vec3::splat(0.8));
        let direction = Vec3::new(-0.8, -0.6, 0.0);
        scene.lights = vec![Light::Directional { direction, irradiance: Vec3::splat(5.0) }];
        add(&mut scene, Material::matte("floor", Vec3::splat(0.05)), &[Quad::level(Vec3::ZERO, 300.0)]);
        let wall = Quad {
            corner: Vec3::new(wall_x, 0.0, 150.0),
            u: Vec3::new(0.0, 0.0, -300.0),
            v: Vec3::new(0.0, 150.0, 0.0),
        };
        add(&mut scene, Material::matte("wall", albedo), &[wall]);
        let settings = Settings {
            size: UVec2::splat(96),
            grid: 32,
            layer: Layer::Indirect,
            clip: Some(clip),
            ..settings(VoxelSource::Progressive)
        };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        // From the wall's side: the flank that the sun does not reach.
        let (eye, target) = (Vec3::new(-55.0, 45.0, 60.0), Vec3::new(0.0, 40.0, 0.0));
        renderer.set_camera(&Camera::look("flank", eye, target, 60.0));
        let fox = scene.instances.iter().position(|i| scene.meshes[i.mesh].material == 0).ok_or("no fox")?;
        for step in 0..4 {
            let mut pose = scene.pose(clip, 0.1 * step as f32);
            let walked = Vec3::new(0.0, 0.0, 10.0 * step as f32 - 30.0);
            pose.world_from_local[fox] = Mat4::from_translation(walked) * pose.world_from_local[fox];
            scene.apply(&pose);
            renderer.set_pose(&pose);
            renderer.frame(None)?;
        }
        settle(&mut renderer)?;
        let indirect = renderer.read_picture()?;
        renderer.set_layer(Layer::Albedo);
        renderer.settle(0, None)?;
        let is_fox = renderer.read_picture()?;
        let pixels: Vec<Vec3> =
            (0..indirect.len()).filter(|&n| is_fox[n].min_element() > 0.6).map(|n| indirect[n]).collect();
        assert!(pixels.len() > 200, "{} pixels of the fox", pixels.len());
        Ok(pixels.iter().sum::<Vec3>() / pixels.len() as f32)
    };
    let (red, grey) = (flank(Vec3::new(0.8, 0.1, 0.1), -60.0)?, flank(Vec3::splat(0.4), -60.0)?);
    assert!(red.x > 2.0 * red.y && red.x > 2.0 * red.z, "by the red wall {red}");
    assert!((grey.x - grey.y).abs() < 0.05 * grey.x, "by the grey wall {grey}");
    assert!(red.x > 0.05, "the wall sends light: {red}");
    Ok(())
}

/// A man walks over a floor that the camera sees. Of where he was, nothing is left in the volume.
fn man(gpu: &Gpu, path: &Path) -> Result<(), Failed> {
    let mut scene = load(path)?;
    scene.lights = vec![SUN];
    let man: Vec<usize> = (0..scene.instances.len()).collect();
    add(&mut scene, Material::matte("floor", Vec3::splat(0.6)), &[Quad::level(Vec3::ZERO, FLOOR)]);
    let settings = Settings { size: UVec2::splat(192), grid: 48, ..settings(VoxelSource::Progressive) };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&above());
    let walk = |scene: &mut Scene, step: usize| {
        let mut pose = scene.pose(0, step as f32 / 12.0);
        let walked = Mat4::from_translation(Vec3::new(0.25 * step as f32 - 2.0, 0.0, 0.0));
        man.iter().for_each(|&i| pose.world_from_local[i] = walked * pose.world_from_local[i]);
        scene.apply(&pose);
        pose
    };
    let mut most = 0;
    for step in 0..16 {
        let pose = walk(&mut scene, step);
        renderer.set_pose(&pose);
        renderer.frame(None)?;
        let grid = *renderer.volume().grid();
        let cells = occupied(gpu, &renderer)?;
        // Where he is: his box, and a cell around it.
        let points = man.iter().flat_map(|&i| {
            let instance = scene.instances[i];
            let mesh = &scene.meshes[instance.mesh];
            mesh.positions.iter().map(move |&p| instance.world_from_local.transform_point3(p.into()))
        });
        let his = lumivox::core::Bounds::of_points(points);
        let near = |c: Vec3| (his.min - c).max(c - his.max).max_element() < grid.cell_size;
        // Cells within one and a half of the floor are the floor's, or cannot be told from it.
        let high = |c: Vec3| c.y > 1.5 * grid.cell_size;
        let stand = grid.cells().filter(|&c| cells[grid.index(c)] && high(grid.center(c)));
        let (of_him, left): (Vec<_>, Vec<_>) = stand.partition(|&c| near(grid.center(c)));
        most = most.max(of_him.len());
        assert!(left.is_empty(), "step {step}: {} cells of {} are left behind", left.len(), of_him.len());
    }
    assert!(most > 20, "the volume held at most {most} cells of him");
    Ok(())
}
