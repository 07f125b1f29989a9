//! Gathered light in whole frames: closed forms, leaks, rest and motion.

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gather::GatherSettings;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Material, Scene, builtin};

use crate::Check;
use crate::camera::{Ray, rays};
use crate::scenes::{Quad, add, settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("gathered light: a furnace settles at its closed form", furnace),
    ("gathered light: a dark room beside a lit one stays dark", dark_room),
    ("gathered light: a dark room beside a lit one stays dark, voxels from views", dark_room_of_views),
    ("gathered light: a frame of a still scene is like the one before", rest),
    ("gathered light: a lamp that goes out leaves no light in the picture", lamp_out),
    ("gathered light: the first frame of views has light", first_frame),
    ("gathered light: views that have seen a box show as much light as its triangles", views_of_a_box),
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

/// What a floor of the renderer's roughness mirrors of a wall with radiance 2, from a point towards an eye: half vectors about the normal
/// by GGX's density, light weighted by its cosine.
fn mirrored(wall: Quad, point: Vec3, towards_eye: Vec3, roughness: f32) -> f32 {
    const RAYS: u32 = 4096;
    let alpha_2 = roughness.powi(4);
    let (mut sum, mut weights) = (0.0, 0.0);
    for ray in 0..RAYS {
        let u = (ray as f32 + 0.5) / RAYS as f32;
        let cos_2 = (1.0 - u) / (1.0 + (alpha_2 - 1.0) * u);
        let (sin, cos) = (std::f32::consts::TAU * (ray as f32 * 0.618_034).fract()).sin_cos();
        let half = (1.0 - cos_2).max(0.0).sqrt() * Vec3::new(cos, 0.0, sin) + cos_2.sqrt() * Vec3::Y;
        let direction = 2.0 * towards_eye.dot(half) * half - towards_eye;
        if direction.y > 0.0 {
            let ray = Ray { origin: point, direction };
            let meets = ray.meets(wall.corner, wall.u, wall.v).is_some_and(|(_, inside)| inside > 0.0);
            sum += if meets { 2.0 * direction.y } else { 0.0 };
            weights += direction.y;
        }
    }
    sum / weights
}

/// A black floor before a wall of radiance 2: pixel by pixel what GGX's lobe says. Near the wall the mirrored view meets it, far from it
/// the view goes over it.
fn glossy(gpu: &Gpu) -> Result<(), Failed> {
    let mut scene = Scene::default();
    let (floor, wall) = (Quad::level(Vec3::ZERO, 8.0), Quad::upright(Vec3::new(0.0, 1.0, -3.0), 8.0, 2.0));
    add(&mut scene, Material::matte("floor", Vec3::ZERO), &[floor]);
    let glowing = Material { emission: Vec3::splat(2.0), ..Material::matte("wall", Vec3::ZERO) };
    add(&mut scene, glowing, &[wall]);
    let camera = Camera::look("eye", Vec3::new(0.0, 1.5, 5.0), Vec3::new(0.0, 0.0, 0.5), 50.0);
    let settings = Settings { layer: Layer::Glossy, grid: 32, ..gathering(VoxelSource::Triangles) };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&camera);
    settle(&mut renderer)?;
    let (picture, mut errors, mut off) = (renderer.read_picture()?, Vec::new(), 0.0);
    for (ray, found) in rays(&camera, settings.size).into_iter().zip(&picture) {
        let Some((distance, inside)) = ray.meets(floor.corner, floor.u, floor.v) else { continue };
        let point = ray.origin + distance * ray.direction;
        // In a cell's width of the corner pixels look from above the floor.
        if inside > 0.3 && point.z > wall.corner.z + 0.3 {
            let expected = mirrored(wall, point, -ray.direction, settings.roughness);
            errors.push((found.y - expected).abs());
            off += found.y - expected;
        }
    }
    errors.sort_by(f32::total_cmp);
    let (mean, most) = (off / errors.len() as f32, errors[errors.len() * 19 / 20]);
    eprintln!(
        "glossy: {} pixels, off by {mean:.4} on average, 19 of 20 by less than {most:.4}",
        errors.len()
    );
    assert!(errors.len() > 2000, "{} pixels", errors.len());
    assert!(mean.abs() < 0.03 && most < 0.16, "off by {mean} on average, {most} at most");
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

/// Of one view rays get out where it has not seen the walls behind things; when others have, next to nothing is missing.
fn views_of_a_box(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let light = |voxels, views: usize| -> Result<f32, Failed> {
        let settings = Settings { size: UVec2::splat(160), grid: 24, ..gathering(voxels) };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        for n in 0..views {
            let turn = 0.9 * n as f32;
            let eye = Vec3::new(0.8 * turn.cos(), 1.0 + 0.7 * (1.7 * turn).sin(), 0.8 * turn.sin());
            let target = Vec3::new(-0.5 * turn.sin(), 0.4, 0.3 * turn.cos());
            renderer.set_camera(&Camera::look("around", eye, target, 90.0));
            renderer.frame(None)?;
        }
        renderer.set_camera(&scene.cameras[0]);
        settle(&mut renderer)?;
        Ok(mean(&renderer.read_picture()?))
    };
    let all = light(VoxelSource::Triangles, 0)?;
    let [one, many] = [0, 10].map(|views| light(VoxelSource::Progressive, views).map(|l| l / all));
    let (one, many) = (one?, many?);
    eprintln!("views of a box: {one:.3} of the light with one, {many:.3} with 11");
    assert!(one > 0.87 && one < 1.02, "{one} of the light with one view");
    assert!(many > 0.95 && many < 1.02, "{many} of the light with all views");
    Ok(())
}
