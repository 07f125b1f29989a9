//! A lamp that is switched on: how soon the picture of a preset shows its light.

use glam::{UVec2, Vec3};
use libtest_mimic::Failed;
use lumivox::gather::Quality;
use lumivox::gpu::Gpu;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Light, Material, Scene, SpotFalloff};

use crate::Check;
use crate::scenes::{Quad, add, block, small};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("switched: within eight frames nine tenths of all bounces are there, low", |gpu| {
        in_time(gpu, Quality::Low)
    }),
    ("switched: within eight frames nine tenths of all bounces are there, medium", |gpu| {
        in_time(gpu, Quality::Medium)
    }),
    ("switched: within eight frames nine tenths of all bounces are there, high", |gpu| {
        in_time(gpu, Quality::High)
    }),
];

const ALBEDO: f32 = 0.6;
/// Frames in the dark, in which all rays are traced, those that may pass, and those until all light is there.
const DARK: usize = 8;
const MOST: usize = 8;
const ALL: usize = 24;

fn lamp(intensity: f32) -> Light {
    Light::Spot {
        position: Vec3::new(0.3, 2.6, 0.2),
        direction: Vec3::new(0.2, -1.0, -0.1).normalize_or_zero(),
        cutoff: 0.6,
        beam: 0.4,
        falloff: SpotFalloff::LinearAngle,
        intensity: Vec3::splat(intensity),
    }
}

/// A closed box, seen from within.
fn closed_box() -> Scene {
    let mut scene = Scene { lights: vec![lamp(0.0)], ..Scene::default() };
    let inwards = |q: Quad| Quad { u: q.v, v: q.u, ..q };
    let walls: Vec<Quad> =
        block(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 3.0, 2.0)).into_iter().map(inwards).collect();
    add(&mut scene, Material::matte("wall", Vec3::splat(ALBEDO)), &walls);
    scene
}

fn in_time(gpu: &Gpu, quality: Quality) -> Result<(), Failed> {
    let scene = closed_box();
    // The slower with triangles, whose every wall is there to reflect.
    let views = (quality == Quality::Low).then_some(VoxelSource::Progressive);
    for voxels in std::iter::once(VoxelSource::Triangles).chain(views) {
        let settings = Settings {
            gi: GiMethod::Gather,
            layer: Layer::Indirect,
            voxels,
            size: UVec2::splat(32),
            grid: 20,
            points: small().points,
            ..Settings::of(quality)
        };
        let mut renderer = Renderer::new(gpu, &scene, settings)?;
        renderer.set_camera(&Camera::look(
            "corner",
            Vec3::new(-1.7, 1.6, 1.7),
            Vec3::new(0.5, 1.2, -0.5),
            80.0,
        ));
        let frame = |renderer: &mut Renderer| -> Result<f32, Failed> {
            renderer.frame(None)?;
            Ok(renderer.read_picture()?.iter().map(|p| p.y).sum())
        };
        for _ in 0..DARK {
            assert_eq!(frame(&mut renderer)?, 0.0, "light in the dark");
        }
        renderer.set_lights(&[lamp(20.0)]);
        let seen: Vec<f32> = (0..ALL).map(|_| frame(&mut renderer)).collect::<Result<_, _>>()?;
        let end = seen[ALL - 1];
        let parts: Vec<f32> = seen[..MOST + 2].iter().map(|light| light / end).collect();
        eprintln!("{quality:?}, {voxels:?}: {parts:.3?}");
        // At rest by then, so that the end is the end.
        let moves = (seen[ALL - 4] / end - 1.0).abs();
        assert!(end > 1.0 && moves < 2e-3, "{quality:?}, {voxels:?}: {end}, and {moves} in three frames");
        let there = parts[MOST - 1];
        assert!(there >= 0.9, "{quality:?}, {voxels:?}: {there} in the {MOST}th frame");
    }
    Ok(())
}
