//! Gathered light in whole frames: closed forms, leaks, rest and motion.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::core::View;
use lumivox::gather::GatherSettings;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Material, Scene, builtin};

use crate::Check;
use crate::scenes::{Quad, add, settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("gathered light: a furnace settles at its closed form", furnace),
    ("gathered light: a dark room beside a lit one stays dark", dark_room),
    ("gathered light: a dark room beside a lit one stays dark, voxels from views", dark_room_of_views),
    ("gathered light: a frame of a still scene is like the one before", rest),
    ("gathered light: a lamp that goes out leaves no light in the picture", lamp_out),
    ("gathered light: the first frame of views has light", first_frame),
    ("gathered light: turns and updates do not show in the first frame", first_frame_of_turns),
    ("gathered light: a glossy floor mirrors a glowing wall", glossy),
];

fn gathering(voxels: VoxelSource) -> Settings {
    Settings { gi: GiMethod::Gather, voxels, layer: Layer::Indirect, ..small() }
}

fn mean(picture: &[Vec3]) -> f32 {
    picture.iter().map(|p| p.y).sum::<f32>() / picture.len() as f32
}

fn furnace(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::furnace(0);
    let settings = Settings { layer: Layer::Final, ..gathering(VoxelSource::Triangles) };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&scene.cameras[0]);
    settle(&mut renderer)?;
    let picture = renderer.read_picture()?;
    let worst = picture.iter().map(|p| (p.y - 1.0).abs()).fold(0.0, f32::max);
    assert!(worst < 0.01, "a pixel is {worst} from the closed form");
    Ok(())
}

/// A black floor before a wall of radiance 2. Near the wall the mirrored view meets it, far from it the view goes over it.
fn glossy(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = Scene::default();
    add(&mut scene, Material::matte("floor", Vec3::ZERO), &[Quad::level(Vec3::ZERO, 8.0)]);
    let glowing = Material { emission: Vec3::splat(2.0), ..Material::matte("wall", Vec3::ZERO) };
    add(&mut scene, glowing, &[Quad::upright(Vec3::new(0.0, 1.0, -3.0), 8.0, 2.0)]);
    let camera = Camera::look("eye", Vec3::new(0.0, 1.5, 5.0), Vec3::new(0.0, 0.0, 0.5), 50.0);
    let settings = Settings { layer: Layer::Glossy, grid: 32, ..gathering(VoxelSource::Triangles) };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&camera);
    settle(&mut renderer)?;
    let (picture, size) = (renderer.read_picture()?, settings.size);
    let view = View::perspective(
        camera.eye,
        camera.target,
        camera.up,
        camera.fov_y,
        size.x as f32 / size.y as f32,
        0.1,
        50.0,
    );
    let at = |p: Vec3| {
        let (uv, _) = view.uv_from_world(p).unwrap_or_default();
        let texel = (uv * size.as_vec2()).as_uvec2().min(size - 1);
        picture[(texel.y * size.x + texel.x) as usize].y
    };
    let (near, far) = (at(Vec3::new(0.0, 0.0, -2.0)), at(Vec3::new(0.0, 0.0, 2.8)));
    eprintln!("glossy: {near} near the wall, {far} far from it");
    assert!(near > 1.4 && near <= 2.01, "{near} near the wall");
    assert!(far < 0.4, "{far} far from the wall");
    Ok(())
}

/// Walls of a quarter of a cell, of half of one, and of a whole one.
fn dark_room(gpu: &Gpu) -> Result<(), Failed> {
    for thickness in [0.095, 0.19, 0.38] {
        let scene = builtin::two_rooms(0, thickness);
        let settings = Settings { grid: 24, ..gathering(VoxelSource::Triangles) };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        let mut seen = [0.0; 2];
        for (side, seen) in [-1.0, 1.0].into_iter().zip(&mut seen) {
            let from = Vec3::new(side * (0.5 * thickness + 3.8), 1.4, 1.8);
            let camera = Camera::look("room", from, Vec3::new(side * 0.5, 1.2, -0.5), 80.0);
            renderer.set_camera(&camera);
            settle(&mut renderer)?;
            let picture = renderer.read_picture()?;
            // Of the dark room, the brightest pixel.
            *seen = if side < 0.0 { mean(&picture) } else { picture.iter().map(|p| p.y).fold(0.0, f32::max) };
        }
        assert_eq!(renderer.surfels()?.map(|s| s.refused), Some(0));
        let cell = renderer.volume().grid().cell_size;
        eprintln!(
            "walls of {:.2} cells: lit {}, brightest pixel of the dark {}",
            thickness / cell,
            seen[0],
            seen[1]
        );
        assert!(seen[0] > 0.05, "the lit room is dark: {}", seen[0]);
        let leak = if thickness < cell { 0.02 } else { 0.005 };
        assert!(seen[1] <= leak * seen[0], "{} of {} through {thickness} m", seen[1], seen[0]);
    }
    Ok(())
}

/// The same where views bring the surfaces: the camera stands in the one room, and then in the other.
fn dark_room_of_views(gpu: &Gpu) -> Result<(), Failed> {
    for thickness in [0.095, 0.38, 0.57] {
        let scene = builtin::two_rooms(0, thickness);
        let settings = Settings { grid: 24, ..gathering(VoxelSource::Progressive) };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        let mut pictures = Vec::new();
        for side in [-1.0, 1.0] {
            let from = Vec3::new(side * (0.5 * thickness + 3.8), 1.4, 1.8);
            renderer.set_camera(&Camera::look("room", from, Vec3::new(side * 0.5, 1.2, -0.5), 80.0));
            for _ in 0..12 {
                renderer.frame(None)?;
            }
            pictures.push(renderer.read_picture()?);
        }
        let lit = mean(&pictures[0]);
        let dark = mean(&pictures[1]) / lit;
        let most = pictures[1].iter().map(|p| p.y).fold(0.0, f32::max) / lit;
        let cell = renderer.volume().grid().cell_size;
        eprintln!(
            "views, walls of {:.2} cells: dark {dark:.5} of the lit, its brightest pixel {most:.5}",
            thickness / cell
        );
        assert!(lit > 0.05, "the lit room is dark: {lit}");
        let leak = if thickness < cell { 0.02 } else { 0.005 };
        assert!(dark < 0.1 * leak && most <= leak, "{dark}, {most} through {thickness} m");
    }
    Ok(())
}

/// The picture as a screen shows it, in steps of 8 bits: linear, and by sRGB's curve after any exposure.
fn on_screen(value: f32, exposure: f32) -> [f32; 2] {
    let linear = (exposure * value).clamp(0.0, 1.0);
    let curved = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    [255.0 * linear, 255.0 * curved]
}

fn rest(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    for voxels in [VoxelSource::Triangles, VoxelSource::Progressive] {
        let mut renderer = Renderer::new(gpu, &scene, Settings { layer: Layer::Final, ..gathering(voxels) })?;
        renderer.set_camera(&scene.cameras[0]);
        let mut before = Vec::new();
        for frame in 1..=25 {
            renderer.frame(None)?;
            let after = renderer.read_picture()?;
            if [12, 13, 14, 18, 25].contains(&frame) {
                let pairs = || {
                    before
                        .iter()
                        .zip(&after)
                        .flat_map(|(a, b): (&Vec3, &Vec3)| a.to_array().into_iter().zip(b.to_array()))
                };
                let change = |exposure: f32, curve: usize| {
                    let step = |(a, b)| (on_screen(a, exposure)[curve] - on_screen(b, exposure)[curve]).abs();
                    pairs().map(step).fold(0.0, f32::max)
                };
                // Of linear light and through the display's curve, as it is and four times as bright.
                let changes = [change(1.0, 0), change(1.0, 1), change(4.0, 0), change(4.0, 1)];
                eprintln!("{voxels:?}, frame {frame}: {changes:.4?} steps");
                assert!(changes.iter().all(|c| *c < 0.25), "{voxels:?}, frame {frame}: {changes:?} of 255");
            }
            before = after;
        }
    }
    Ok(())
}

fn lamp_out(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let mut renderer = Renderer::new(gpu, &scene, gathering(VoxelSource::Progressive))?;
    renderer.set_camera(&scene.cameras[0]);
    for _ in 0..4 {
        renderer.frame(None)?;
    }
    let lit = mean(&renderer.read_picture()?);
    let out: Vec<Light> = scene
        .lights
        .iter()
        .cloned()
        .map(|light| match light {
            Light::Spot { position, direction, cutoff, beam, falloff, .. } => {
                Light::Spot { position, direction, cutoff, beam, falloff, intensity: Vec3::ZERO }
            }
            other => other,
        })
        .collect();
    renderer.set_lights(&out);
    for _ in 0..8 {
        renderer.frame(None)?;
    }
    let left = mean(&renderer.read_picture()?);
    assert!(lit > 0.01, "there is no light: {lit}");
    assert!(left < 0.01 * lit, "{left} of {lit} is left after eight frames");
    Ok(())
}

/// However light is spread over frames, the first picture is that of whole frames, pixel by pixel.
fn first_frame_of_turns(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    for voxels in [VoxelSource::Triangles, VoxelSource::Progressive] {
        let first = |frames: f32, light_every: u32| -> Result<Vec<Vec3>, Failed> {
            let usual = gathering(voxels);
            let settings =
                Settings { light_every, gather: GatherSettings { frames, ..usual.gather }, ..usual };
            let mut renderer = Renderer::new(gpu, &scene, settings)?;
            renderer.set_camera(&scene.cameras[0]);
            renderer.frame(None)?;
            Ok(renderer.read_picture()?)
        };
        let whole = first(1.0, 1)?;
        assert!(mean(&whole) > 0.01);
        assert!(first(8.0, 1)? == whole, "{voxels:?}: turns show");
        assert!(first(1.0, 30)? == whole, "{voxels:?}: the wait for the next update shows");
    }
    Ok(())
}

fn first_frame(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    for voxels in [VoxelSource::Progressive, VoxelSource::SingleFrame, VoxelSource::SinglePass] {
        let mut renderer = Renderer::new(gpu, &scene, gathering(voxels))?;
        renderer.set_camera(&scene.cameras[0]);
        renderer.frame(None)?;
        let first = mean(&renderer.read_picture()?);
        for _ in 0..6 {
            renderer.frame(None)?;
        }
        let later = mean(&renderer.read_picture()?);
        assert!(first > 0.7 * later && later > 0.01, "{voxels:?}: {first} at first, {later} later");
    }
    Ok(())
}
