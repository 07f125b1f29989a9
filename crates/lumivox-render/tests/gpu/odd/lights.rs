//! Lights where none should be, and of odd strengths and shapes.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Renderer, VoxelSource};
use lumivox_scene::{Light, Scene, SpotFalloff};

use super::{Faults, box_camera, dark_box, point, tiny};
use crate::Check;

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("odd lights: on surfaces, at vertices, in solids, at the eye, of any strength", odd_points),
    ("odd spots: cutoffs near 0 and 90 degrees, without beam or direction", odd_spots),
    ("odd suns and panels: along floors, of no area, huge, in a wall", odd_suns_and_panels),
];

/// Renders the box with each of these lights, which are all of one kind.
fn look(gpu: &Gpu, lights: &[(&str, Light)]) -> Result<(), Failed> {
    let mut faults = Faults::default();
    for voxels in [VoxelSource::Progressive, VoxelSource::Triangles] {
        let scene = Scene { lights: vec![lights[0].1], ..dark_box() };
        let mut renderer = Renderer::new(gpu, &scene, tiny(voxels))?;
        renderer.set_camera(&box_camera());
        for (what, light) in lights {
            renderer.set_lights(&[*light]);
            faults.look(gpu, &format!("{what}, {voxels:?}"), &mut renderer)?;
        }
    }
    // Ranges of numbers are found when a renderer is made.
    for (what, light) in lights {
        let scene = Scene { lights: vec![*light], ..dark_box() };
        let mut renderer = Renderer::new(gpu, &scene, tiny(VoxelSource::Progressive))?;
        renderer.set_camera(&box_camera());
        faults.look(gpu, &format!("{what}, made anew"), &mut renderer)?;
    }
    faults.into_result()
}

fn odd_points(gpu: &Gpu) -> Result<(), Failed> {
    look(
        gpu,
        &[
            ("exactly on the floor", point(Vec3::new(0.1, 0.0, 0.7), 5.0)),
            ("at a vertex", point(Vec3::new(-1.0, 0.0, -1.0), 5.0)),
            ("at the camera's eye", point(box_camera().eye, 5.0)),
            ("inside a solid", point(Vec3::new(0.33, 0.3, 0.3), 5.0)),
            ("1e-20 m above the floor", point(Vec3::new(0.1, 1e-20, 0.7), 5.0)),
            ("a million metres away", point(Vec3::new(0.0, 1.0, 1e6), 1e12)),
            ("1e30 m away", point(Vec3::new(0.0, 1.0, 1e30), 1e12)),
            ("of no intensity", point(Vec3::Y, 0.0)),
            ("of 1e-30 W/sr", point(Vec3::Y, 1e-30)),
            ("of 1e30 W/sr", point(Vec3::Y, 1e30)),
            ("of 1e30 W/sr on the floor", point(Vec3::new(0.1, 0.0, 0.7), 1e30)),
            ("of the largest number", point(Vec3::Y, f32::MAX)),
        ],
    )
}

fn odd_spots(gpu: &Gpu) -> Result<(), Failed> {
    let spot = |direction: Vec3, beam: f32, cutoff: f32, falloff| Light::Spot {
        position: Vec3::new(0.2, 1.9, 0.5),
        direction,
        intensity: Vec3::splat(8.0),
        beam: beam.to_radians(),
        cutoff: cutoff.to_radians(),
        falloff,
    };
    let down = Vec3::NEG_Y;
    for falloff in [SpotFalloff::LinearAngle, SpotFalloff::Gltf] {
        look(
            gpu,
            &[
                ("cutoff 1e-4 degrees", spot(down, 0.0, 1e-4, falloff)),
                ("cutoff 0", spot(down, 0.0, 0.0, falloff)),
                ("cutoff 89.99 degrees", spot(down, 60.0, 89.99, falloff)),
                ("cutoff 90 degrees", spot(down, 90.0, 90.0, falloff)),
                ("cutoff 180 degrees", spot(down, 0.0, 180.0, falloff)),
                ("beam as wide as cutoff", spot(down, 30.0, 30.0, falloff)),
                ("beam wider than cutoff", spot(down, 40.0, 30.0, falloff)),
                ("without direction", spot(Vec3::ZERO, 20.0, 30.0, falloff)),
                ("with a tiny direction", spot(1e-30 * down, 20.0, 30.0, falloff)),
            ],
        )?;
    }
    Ok(())
}

fn odd_suns_and_panels(gpu: &Gpu) -> Result<(), Failed> {
    let sun = |x: f32, y: f32, z: f32, w: f32| Light::Directional {
        direction: Vec3::new(x, y, z),
        irradiance: Vec3::splat(w),
    };
    look(
        gpu,
        &[
            ("along the floor", sun(0.0, 0.0, -1.0, 5.0)),
            ("along two walls", sun(0.0, -1.0, 0.0, 5.0)),
            ("1e-7 from along the floor", sun(0.0, -1e-7, -1.0, 5.0)),
            ("without direction", sun(0.0, 0.0, 0.0, 5.0)),
            ("of no irradiance", sun(0.3, -1.0, -0.2, 0.0)),
            ("of 1e30 W/m2", sun(0.3, -1.0, -0.2, 1e30)),
        ],
    )?;
    let panel = |origin: [f32; 3], u: Vec3, v: Vec3, radiance: f32| Light::Rect {
        origin: origin.into(),
        u,
        v,
        radiance: Vec3::splat(radiance),
    };
    let (x, z, corner) = (Vec3::X, Vec3::Z, [-0.25, 1.9, -0.25]);
    look(
        gpu,
        &[
            ("a sound panel", panel(corner, 0.5 * x, 0.5 * z, 5.0)),
            ("without one edge", panel(corner, 0.5 * x, Vec3::ZERO, 5.0)),
            ("with edges along each other", panel(corner, 0.5 * x, 0.7 * x, 5.0)),
            ("a point", panel(corner, Vec3::ZERO, Vec3::ZERO, 5.0)),
            ("1e-15 m wide", panel(corner, 1e-15 * x, 1e-15 * z, 1e30)),
            ("in the ceiling", panel([-0.5, 2.0, -0.5], x, z, 5.0)),
            ("touching a wall", panel([-1.0, 1.5, -0.5], 0.5 * x, z, 5.0)),
            ("across a wall", panel([0.5, 1.5, -0.5], x, z, 5.0)),
            ("of a kilometre", panel([-500.0, 3.0, -500.0], 1e3 * x, 1e3 * z, 5.0)),
            ("of 1e6 m, through the box", panel([-5e5, 1.0, -5e5], 1e6 * x, 1e6 * z, 5.0)),
            ("of 1e18 m", panel([-5e17, 3.0, -5e17], 1e18 * x, 1e18 * z, 5.0)),
            ("of 1e30 W/(m2 sr)", panel(corner, 0.5 * x, 0.5 * z, 1e30)),
        ],
    )
}
