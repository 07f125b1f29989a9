//! Indirect light: what it must be in a furnace, and what colour it takes along.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Material, Scene, builtin};

use crate::Check;
use crate::camera::rays;
use crate::scenes::{Quad, add, block, settle, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("a furnace settles at its closed form", furnace),
    ("without indirect light shadows are black", black_shadows),
    ("a red wall bleeds, voxels from triangles", |gpu| bleeding(gpu, VoxelSource::Triangles)),
    ("a red wall bleeds, voxels from views", |gpu| bleeding(gpu, VoxelSource::Progressive)),
    ("the final picture is the sum of its layers", layers_add_up),
    ("indirect light is never negative", never_negative),
    ("light that flows comes to the settled picture", flows),
];

/// Four coefficients get the mean right, and have a little too little in the middle of a wall and too much along its
/// edges; finer grids come closer in the middle.
fn furnace(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::furnace(0);
    for grid in [24, 32] {
        let settings =
            Settings { gi: GiMethod::Propagation, voxels: VoxelSource::Triangles, grid, ..small() };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&scene.cameras[0]);
        settle(&mut renderer)?;
        let mut radiance: Vec<f32> = renderer.read_picture()?.iter().map(|p| p.y).collect();
        radiance.sort_by(f32::total_cmp);
        let median = radiance[radiance.len() / 2];
        let mean = radiance.iter().sum::<f32>() / radiance.len() as f32;
        assert!((median - 1.0).abs() < 0.03, "grid {grid}: median {median}");
        assert!((mean - 1.0).abs() < 0.01, "grid {grid}: mean {mean}");
    }
    Ok(())
}

/// A red wall that the sun shines on, and beside it the front of a thick white block that the sun never reaches.
fn corner() -> (Scene, Quad) {
    let mut scene = Scene::default();
    scene.lights.push(Light::Directional {
        direction: Vec3::new(1.0, -0.3, 0.05).normalize_or_zero(),
        irradiance: Vec3::splat(10.0),
    });
    let red = block(Vec3::new(1.0, 0.0, -2.0), Vec3::new(1.5, 2.0, 1.5));
    add(&mut scene, Material::matte("red", Vec3::new(0.63, 0.06, 0.05)), &red);
    let white = block(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 2.0, -1.0));
    add(&mut scene, Material::matte("white", Vec3::splat(0.73)), &white);
    (scene, Quad::upright(Vec3::new(0.0, 1.0, -1.0), 2.0, 2.0))
}

fn corner_camera() -> Camera {
    Camera::look("corner", Vec3::new(-0.9, 1.1, 2.2), Vec3::new(0.2, 1.0, -1.0), 60.0)
}

/// Pixels on the front of the white block.
fn front_pixels(front: Quad, settings: &Settings) -> Vec<usize> {
    let rays = rays(&corner_camera(), settings.size);
    let on_front =
        |n: &usize| rays[*n].meets(front.corner, front.u, front.v).is_some_and(|(_, inside)| inside > 0.06);
    (0..rays.len()).filter(on_front).collect()
}

fn black_shadows(gpu: &Gpu) -> Result<(), Failed> {
    let (scene, front) = corner();
    let settings = small();
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&corner_camera());
    renderer.frame(None)?;
    let picture = renderer.read_picture()?;
    let pixels = front_pixels(front, &settings);
    assert!(pixels.len() > 1000);
    assert!(pixels.iter().all(|&n| picture[n] == Vec3::ZERO));
    assert!(picture.iter().any(|p| p.x > 1.0), "the red wall is in the sun");
    Ok(())
}

fn bleeding(gpu: &Gpu, voxels: VoxelSource) -> Result<(), Failed> {
    for gi in [GiMethod::Propagation, GiMethod::Gather] {
        bleeding_by(gpu, voxels, gi)?;
    }
    Ok(())
}

fn bleeding_by(gpu: &Gpu, voxels: VoxelSource, gi: GiMethod) -> Result<(), Failed> {
    let (scene, front) = corner();
    let settings = Settings { gi, voxels, layer: Layer::Indirect, ..small() };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&corner_camera());
    renderer.frame(None)?;
    settle(&mut renderer)?;
    let picture = renderer.read_picture()?;
    let pixels = front_pixels(front, &settings);
    let mean: Vec3 = pixels.iter().map(|&n| picture[n]).sum::<Vec3>() / pixels.len() as f32;
    // The red wall has 0.63 / pi times 10 W/m2 = 2 W/(m2 sr) and fills a good part of what the white one sees.
    assert!(mean.x > 0.05 && mean.x < 0.73 * 2.0, "{mean}");
    assert!(mean.x > 3.0 * mean.y && mean.x > 3.0 * mean.z, "{mean}");
    let dark = pixels.iter().filter(|&&n| picture[n].x <= picture[n].y || picture[n].x <= 0.0).count();
    assert!(dark == 0, "{dark} of {} pixels have no red light", pixels.len());
    assert!(picture.iter().all(|p| p.is_finite() && p.min_element() >= 0.0));
    Ok(())
}

fn layers_add_up(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let settings =
        Settings { gi: GiMethod::Propagation, voxels: VoxelSource::Triangles, iterations: 40, ..small() };
    let mut renderer = Renderer::new(gpu, &scene, settings)?;
    renderer.set_camera(&scene.cameras[0]);
    renderer.frame(None)?;
    let mut layers = Vec::new();
    for layer in [Layer::Final, Layer::Direct, Layer::Indirect] {
        renderer.set_layer(layer);
        renderer.settle(0, None)?;
        layers.push(renderer.read_picture()?);
    }
    for (n, sum) in layers[0].iter().enumerate() {
        let expected = layers[1][n] + layers[2][n];
        assert!((*sum - expected).abs().cmple(0.002 * expected + 1e-6).all(), "{sum} {expected}");
    }
    assert!(layers[2].iter().any(|p| p.max_element() > 0.02));
    Ok(())
}

fn never_negative(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let sources = [VoxelSource::Triangles, VoxelSource::Progressive, VoxelSource::SingleFrame];
    let methods = [GiMethod::Lpv, GiMethod::Propagation, GiMethod::Gather];
    for (voxels, gi) in sources.into_iter().flat_map(|v| methods.map(|gi| (v, gi))) {
        let settings = Settings { gi, voxels, layer: Layer::Indirect, iterations: 1, grid: 16, ..small() };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&scene.cameras[0]);
        renderer.frame(None)?;
        for steps in [0, 1, 2, 4, 16, 64] {
            renderer.settle(steps, None)?;
            let picture = renderer.read_picture()?;
            let bad = picture.iter().filter(|p| !(p.is_finite() && p.min_element() >= 0.0)).count();
            assert_eq!(bad, 0, "{voxels:?}, {gi:?} after {steps} steps more");
        }
    }
    Ok(())
}

/// Eight steps a frame: dark at first, and in the end what a still settles at.
fn flows(gpu: &Gpu) -> Result<(), Failed> {
    let scene = builtin::cornell(0);
    let settings = Settings {
        gi: GiMethod::Propagation,
        voxels: VoxelSource::Triangles,
        layer: Layer::Indirect,
        grid: 16,
        iterations: 8,
        ..small()
    };
    let mean = |renderer: &Renderer| -> Result<f32, Failed> {
        let picture = renderer.read_picture()?;
        Ok(picture.iter().map(|p| p.element_sum()).sum::<f32>() / picture.len() as f32)
    };
    let mut still = Renderer::new(gpu, &scene, settings)?;
    still.set_camera(&scene.cameras[0]);
    still.frame(None)?;
    still.settle(400, None)?;
    let settled = mean(&still)?;
    let mut series = Renderer::new(gpu, &scene, Settings { flow: true, ..settings })?;
    series.set_camera(&scene.cameras[0]);
    let mut seen = Vec::new();
    for _ in 0..40 {
        series.frame(None)?;
        seen.push(mean(&series)? / settled);
    }
    eprintln!("light that flows: {seen:.3?} of the settled picture");
    assert!(settled > 0.01 && seen[0] < 0.7, "{settled}, {seen:?}");
    assert!((seen[39] - 1.0).abs() < 0.01, "{seen:?}");
    Ok(())
}
