//! The volume from frame to frame, and the light in its cells.

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::gpu::Gpu;
use lumivox::progressive::{CHANNELS, InjectionScale, LightRule, Progressive};
use lumivox::volume::NORMAL;
use lumivox_render::gpu_scene::GpuScene;
use lumivox_render::surface::{self, SurfacePass, SurfaceView};
use lumivox_render::{GiMethod, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Material, Scene, builtin};

use crate::Check;
use crate::scenes::{Quad, add, block, occupied, radiosities, skyward, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("an orbit finds more cells than one frame", orbit_grows),
    ("single frames forget", single_frames_forget),
    ("a removed thing vanishes once its place is seen", removed),
    ("no light outlives its lamp", lamps_out),
    ("stored light stays where a lamp has been, and pulled light does not", lamps_gone_by),
    ("twice the injection points are the same light", more_points),
    ("a finer reflective shadow map is the same light", finer_map),
    ("two renderers make the same picture, bit for bit", deterministic),
    ("frames of a still scene settle", still_scene),
];

fn volume_settings(voxels: VoxelSource) -> Settings {
    Settings { gi: GiMethod::Propagation, voxels, ..small() }
}

/// The Cornell box without its lamp: only the camera finds cells.
fn dark_cornell() -> Scene {
    Scene { lights: Vec::new(), ..builtin::cornell(0) }
}

fn orbit() -> Vec<Camera> {
    let eye = |n: u32| {
        let angle = n as f32 / 8.0 * std::f32::consts::TAU;
        Vec3::new(3.0 * angle.sin(), 2.0, 3.0 * angle.cos())
    };
    (0..8).map(|n| Camera::look("orbit", eye(n), Vec3::Y, 50.0)).collect()
}

fn count(occupied: &[bool]) -> usize {
    occupied.iter().filter(|o| **o).count()
}

fn orbit_grows(gpu: &Gpu) -> Result<(), Failed> {
    let mut found = [Vec::new(), Vec::new()];
    for (counts, voxels) in found.iter_mut().zip([VoxelSource::SingleFrame, VoxelSource::Progressive]) {
        let mut renderer = Renderer::new(gpu, &dark_cornell(), volume_settings(voxels))?;
        for camera in orbit() {
            renderer.set_camera(&camera);
            renderer.frame(None)?;
            counts.push(count(&occupied(gpu, &renderer)?));
        }
    }
    let [single, kept] = found;
    assert!(
        single[0] > 300 && single[0] == kept[0],
        "the first frame has nothing to keep: {single:?} {kept:?}"
    );
    let most = single.iter().copied().max().unwrap_or_default();
    assert!(kept[7] as f32 > 1.2 * most as f32, "{kept:?} kept, {single:?} in single frames");
    Ok(())
}

fn single_frames_forget(gpu: &Gpu) -> Result<(), Failed> {
    let settings = volume_settings(VoxelSource::SingleFrame);
    let mut walked = Renderer::new(gpu, &dark_cornell(), settings)?;
    for camera in orbit() {
        walked.set_camera(&camera);
        walked.frame(None)?;
    }
    let mut fresh = Renderer::new(gpu, &dark_cornell(), settings)?;
    fresh.set_camera(&orbit()[7]);
    fresh.frame(None)?;
    let [walked, fresh] = [occupied(gpu, &walked)?, occupied(gpu, &fresh)?];
    assert!(count(&fresh) > 300);
    assert_eq!(walked, fresh);
    Ok(())
}

/// Two states of a scene, one volume: with a block on the floor, then without.
fn removed(gpu: &Gpu) -> Result<(), Failed> {
    let mut empty = Scene::default();
    add(&mut empty, Material::default(), &[Quad::level(Vec3::ZERO, 4.0)]);
    let mut furnished = empty.clone();
    let thing = (Vec3::new(-0.4, 0.0, -0.4), Vec3::new(0.4, 1.0, 0.4));
    add(&mut furnished, Material::default(), &block(thing.0, thing.1));
    let grid = Grid::fit_with_margin(&furnished.bounds(), 24)?;
    let mut volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
    let mut progressive = Progressive::new(gpu, &volume)?;
    let mut light = Progressive::direct_light(gpu, &volume)?;

    let mut frame = |scene: &Scene, eye: Vec3, target: Vec3| -> Result<usize, Failed> {
        let size = UVec2::splat(128);
        let view = View::perspective(eye, target, Vec3::Y, 0.9, 1.0, 0.05, 20.0).with_reversed_depth();
        let textures = surface::targets(gpu, "test", size, surface::RADIANCE_FORMAT)?;
        let mut target = SurfaceView::new(gpu, "test", textures, size, view);
        let points = size.x * size.y;
        let scale = InjectionScale { attribute_points: points, light_points: points, radiance_max: 1.0 };
        target.update(gpu, scale);
        let (gpu_scene, textures) = GpuScene::new(gpu, scene, &Scene::default(), true)?;
        let pass = SurfacePass::gbuffer(gpu, &gpu_scene, &textures)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        pass.record(gpu, &mut encoder, &gpu_scene, None, &mut target)?;
        target.record_clear_radiance(&mut encoder);
        progressive.record_cleanup(gpu, &mut encoder, &target.input, &mut volume)?;
        progressive.record_begin(&mut encoder, &mut light);
        progressive.record_camera(gpu, &mut encoder, &target.input, &volume, &mut light)?;
        progressive.record_end(gpu, &mut encoder, &target.input, &mut volume, &mut light)?;
        gpu.queue.submit([encoder.finish()]);
        let cells = volume.read_back(gpu)?;
        let normals = cells.channel(NORMAL).unwrap_or_default();
        // Above the floor there is nothing but the block.
        let above = grid.cells().filter(|&c| grid.center(c).y > grid.cell_size);
        Ok(above.filter(|&c| normals[grid.index(c)].w > 0.0).count())
    };
    let (front, up) = (Vec3::new(1.5, 2.0, 3.0), Vec3::new(0.0, 40.0, 3.0));
    let before = frame(&furnished, front, Vec3::ZERO)?;
    assert!(before > 20, "{before} cells of the block");
    let unseen = frame(&empty, up, Vec3::new(0.0, 60.0, 3.0))?;
    assert_eq!(unseen, before, "what no view sees stays");
    let seen = frame(&empty, front, Vec3::ZERO)?;
    assert_eq!(seen, 0, "cells of a block that is gone");
    Ok(())
}

const LAMPS: [Light; 2] = [
    Light::Directional { direction: Vec3::new(-0.6, -0.8, 0.0), irradiance: Vec3::splat(4.0) },
    Light::Point { position: Vec3::new(0.2, 1.5, 0.3), intensity: Vec3::splat(3.0) },
];

fn dimmed(light: Light, share: f32) -> Light {
    match light {
        Light::Directional { direction, irradiance } => {
            Light::Directional { direction, irradiance: share * irradiance }
        }
        Light::Point { position, intensity } => Light::Point { position, intensity: share * intensity },
        other => other,
    }
}

fn lamps_out(gpu: &Gpu) -> Result<(), Failed> {
    for voxels in [VoxelSource::Progressive, VoxelSource::Triangles, VoxelSource::SingleFrame] {
        let scene = Scene { lights: LAMPS.to_vec(), ..builtin::cornell(0) };
        let mut renderer = Renderer::new(gpu, &scene, Settings { iterations: 4, ..volume_settings(voxels) })?;
        renderer.set_camera(&scene.cameras[0]);
        renderer.frame(None)?;
        assert!(radiosities(gpu, &renderer)?.iter().filter(|r| **r > 0.1).count() > 300);
        // Out, while the camera looks away: cells that only the lamps' views see must go dark as well.
        renderer.set_camera(&skyward());
        renderer.set_lights(&LAMPS.map(|l| dimmed(l, 0.0)));
        renderer.frame(None)?;
        let light = renderer.direct_light().read_back(gpu)?;
        let lit = light.iter().flatten().filter(|band| band.abs().max_element() > 0.0).count();
        assert_eq!(lit, 0, "{voxels:?}");
        assert!(renderer.light_in_volume()? >= 0.0);
    }
    Ok(())
}

/// Lamps that go below the floor while the camera looks away.
fn lamps_gone_by(gpu: &Gpu) -> Result<(), Failed> {
    let scene = Scene { lights: LAMPS.to_vec(), ..builtin::cornell(0) };
    let below = [
        Light::Directional { direction: Vec3::Y, irradiance: Vec3::splat(4.0) },
        Light::Point { position: Vec3::new(0.0, -30.0, 0.0), intensity: Vec3::splat(3.0) },
    ];
    for voxels in [VoxelSource::Progressive, VoxelSource::SinglePass] {
        let mut remaining = Vec::new();
        for light_rule in [LightRule::Pulled, LightRule::Stored] {
            let settings = Settings { iterations: 4, light_rule, ..volume_settings(voxels) };
            let mut renderer = Renderer::new(gpu, &scene, settings)?;
            renderer.set_camera(&skyward());
            renderer.frame(None)?;
            let lit = radiosities(gpu, &renderer)?;
            renderer.set_lights(&below);
            renderer.frame(None)?;
            let after = radiosities(gpu, &renderer)?;
            remaining.push(lit.iter().zip(&after).filter(|(lit, after)| **lit > 0.0 && lit == after).count());
        }
        assert_eq!(remaining[0], 0, "{voxels:?}: cells shine as before");
        assert!(remaining[1] > 300, "{voxels:?}: only {} cells shine as before", remaining[1]);
    }
    Ok(())
}

/// Mean light of the cells that have some in either.
fn mean_lights(gpu: &Gpu, one: Settings, other: Settings) -> Result<[f32; 2], Failed> {
    let scene = Scene { lights: LAMPS.to_vec(), ..builtin::cornell(0) };
    let mut light = Vec::new();
    for settings in [one, other] {
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&skyward());
        renderer.frame(None)?;
        light.push(radiosities(gpu, &renderer)?);
    }
    let lit: Vec<usize> = (0..light[0].len()).filter(|&n| light[0][n] > 0.0 || light[1][n] > 0.0).collect();
    assert!(lit.len() > 500);
    Ok([0, 1].map(|w| lit.iter().map(|&n| light[w][n]).sum::<f32>() / lit.len() as f32))
}

fn check_same_light(gpu: &Gpu, one: Settings, other: Settings) -> Result<(), Failed> {
    let [one, other] = mean_lights(gpu, one, other)?;
    assert!((other / one - 1.0).abs() < 0.05, "{one} and {other}");
    Ok(())
}

fn more_points(gpu: &Gpu) -> Result<(), Failed> {
    let settings = volume_settings(VoxelSource::Progressive);
    check_same_light(gpu, settings, Settings { points: 2 * settings.points, ..settings })
}

fn finer_map(gpu: &Gpu) -> Result<(), Failed> {
    let settings = Settings { rsm_size: 512, ..volume_settings(VoxelSource::Progressive) };
    check_same_light(gpu, settings, Settings { rsm_size: 1024, ..settings })
}

fn deterministic(gpu: &Gpu) -> Result<(), Failed> {
    let scene = Scene { lights: LAMPS.to_vec(), ..builtin::cornell(0) };
    let render = || -> Result<_, Failed> {
        let settings = Settings { iterations: 12, ..volume_settings(VoxelSource::Progressive) };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        for camera in &orbit()[..3] {
            renderer.set_camera(camera);
            renderer.frame(None)?;
        }
        let picture: Vec<_> =
            renderer.read_picture()?.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        Ok((picture, renderer.volume().read_back(gpu)?))
    };
    let (one, other) = (render()?, render()?);
    assert!(one.0 == other.0, "the pictures differ");
    for name in CHANNELS {
        assert_eq!(one.1.channel(name), other.1.channel(name), "{name}");
    }
    Ok(())
}

/// Cleanup and injection of the same views find the same cells again, frame after frame.
fn still_scene(gpu: &Gpu) -> Result<(), Failed> {
    let scene = Scene { lights: LAMPS.to_vec(), ..builtin::cornell(0) };
    let mut renderer = Renderer::new(gpu, &scene, volume_settings(VoxelSource::Progressive))?;
    renderer.set_camera(&scene.cameras[0]);
    renderer.frame(None)?;
    let first = occupied(gpu, &renderer)?;
    for _ in 0..3 {
        renderer.frame(None)?;
        assert_eq!(occupied(gpu, &renderer)?, first);
    }
    Ok(())
}
