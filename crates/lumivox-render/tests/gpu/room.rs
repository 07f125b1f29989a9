//! The dissertation's room (5.6): what of it no sunlight reaches, and how many bounces do.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Scene, builtin};

use crate::Check;
use crate::scenes::{settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("the room: the stair's underside is in shadow", underside),
    ("the room: the far wall is lit by the second bounce", far_wall),
];

/// In the sun alone.
fn room() -> Scene {
    Scene { sky: Vec3::ZERO, ..builtin::room(0) }
}

fn renderer(gpu: &Gpu, scene: &Scene) -> Result<Renderer, Failed> {
    let settings = Settings {
        grid: 40,
        gi: GiMethod::Gather,
        voxels: VoxelSource::Triangles,
        layer: Layer::Indirect,
        shadow_size: 1024,
        bounces: 1,
        ..small()
    };
    Ok(Renderer::new(gpu, scene, settings)?)
}

fn look(from: Vec3, at: Vec3) -> Camera {
    Camera::look("here", from, at, 20.0)
}

/// Mean of a layer as `camera` sees it, without more light than there is.
fn mean(renderer: &mut Renderer, camera: &Camera, layer: Layer) -> Result<f32, Failed> {
    renderer.set_camera(camera);
    renderer.set_layer(layer);
    renderer.frame(None)?;
    let picture = renderer.read_picture()?;
    Ok(picture.iter().map(|p| p.y).sum::<f32>() / picture.len() as f32)
}

fn underside(gpu: &Gpu) -> Result<(), Failed> {
    let mut renderer = renderer(gpu, &room())?;
    let below = look(Vec3::new(2.0, 0.2, 0.4), Vec3::new(2.0, 1.2, 0.401));
    renderer.set_camera(&below);
    settle(&mut renderer)?;
    // The ceiling over the sunlit floor, and that floor.
    let ceiling = look(Vec3::new(-1.5, 1.0, 0.5), Vec3::new(-1.5, 5.0, 0.501));
    let floor = look(Vec3::new(-1.5, 3.0, 1.5), Vec3::new(-1.5, 0.0, 1.501));
    let direct = [&below, &ceiling, &floor].map(|camera| mean(&mut renderer, camera, Layer::Direct));
    let [below_direct, ceiling_direct, floor_direct] = direct;
    assert_eq!((below_direct?, ceiling_direct?), (0.0, 0.0));
    assert!(floor_direct? > 0.1, "no sun on the floor");
    let [under, over] =
        [mean(&mut renderer, &below, Layer::Indirect)?, mean(&mut renderer, &ceiling, Layer::Indirect)?];
    eprintln!("indirect light: {under:.4} under the stairs, {over:.4} on the ceiling");
    assert!(under > 0.01 * over && under < 0.5 * over, "{under} under the stairs, {over} on the ceiling");
    Ok(())
}

fn far_wall(gpu: &Gpu) -> Result<(), Failed> {
    let mut renderer = renderer(gpu, &room())?;
    let far = look(Vec3::new(3.2, 1.2, 0.5), Vec3::new(5.3, 1.2, 0.5));
    let ceiling = look(Vec3::new(-1.5, 1.0, 0.5), Vec3::new(-1.5, 5.0, 0.501));
    // One bounce: light that sunlit surfaces send.
    let first = mean(&mut renderer, &far, Layer::Indirect)?;
    let second = mean(&mut renderer, &far, Layer::Indirect)?;
    let above = mean(&mut renderer, &ceiling, Layer::Indirect)?;
    settle(&mut renderer)?;
    let all = mean(&mut renderer, &far, Layer::Indirect)?;
    eprintln!(
        "far wall: {first:.6} after one bounce, {second:.6} after two, {all:.6} of all; ceiling {above:.4}"
    );
    assert!(first < 0.02 * all, "{first} of {all} come straight from sunlit surfaces");
    assert!(
        second > 5.0 * first && second > 0.05 * all,
        "{second} after the second bounce, {first} after the first"
    );
    assert!(all > 1e-3 * above, "the far wall is dark: {all}");
    Ok(())
}
