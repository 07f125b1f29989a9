//! Much light, none, and surfaces that keep all of it or nothing.

use glam::Vec3;
use libtest_mimic::Failed;
use lumivox::gpu::Gpu;
use lumivox_render::{Renderer, Settings, VoxelSource};
use lumivox_scene::{Material, Scene, builtin};

use super::{Faults, box_camera, dark_box, point, tiny};
use crate::Check;
use crate::scenes::{add, block};

pub(crate) const TESTS: &[(&str, Check)] = &[
    ("odd emission and skies: none, 1e20, the largest number", odd_emission),
    ("odd albedo: a white closed box keeps its light over 2000 steps, a black one none", closed_boxes),
];

fn odd_emission(gpu: &Gpu) -> Result<(), Failed> {
    let mut faults = Faults::default();
    for emission in [0.0, 1e-30, 1e4, 1e6, 1e20, f32::MAX] {
        for albedo in [0.0, 1.0] {
            let mut scene = builtin::furnace(0);
            scene.materials[0] =
                Material { emission: Vec3::splat(emission), ..Material::matte("", Vec3::splat(albedo)) };
            let what = format!("emission {emission:e}, albedo {albedo}");
            faults.look_at(gpu, &what, &scene, &builtin::furnace(0).cameras[0])?;
        }
    }
    for sky in [1e-30, 1e20, f32::MAX] {
        let scene = Scene { sky: Vec3::splat(sky), ..dark_box() };
        faults.look_at(gpu, &format!("sky {sky:e}"), &scene, &box_camera())?;
        let propagated = Settings { area_samples: 0, ..tiny(VoxelSource::Progressive) };
        let mut renderer = Renderer::new(gpu, &scene, propagated)?;
        renderer.set_camera(&box_camera());
        faults.look(gpu, &format!("sky {sky:e}, propagated"), &mut renderer)?;
    }
    faults.into_result()
}

/// What a lamp sends into a white box can neither leave nor grow; half floats may lose some of it.
fn closed_boxes(gpu: &Gpu) -> Result<(), Failed> {
    let mut faults = Faults::default();
    for (albedo, intensity) in [(0.0, 5.0), (1.0, 5.0), (1.0, 1e30)] {
        let mut scene = Scene::default();
        // Two boxes of different sizes, so that the walls are solid.
        for half in [1.0, 1.2] {
            add(
                &mut scene,
                Material::matte("", Vec3::splat(albedo)),
                &block(Vec3::splat(-half), Vec3::splat(half)),
            );
        }
        scene.lights = vec![point(Vec3::new(0.1, 0.2, 0.3), intensity)];
        for voxels in [VoxelSource::Progressive, VoxelSource::Triangles] {
            let what = format!("albedo {albedo}, {intensity:e} W/sr, {voxels:?}");
            let mut renderer = Renderer::new(gpu, &scene, Settings { iterations: 0, ..tiny(voxels) })?;
            renderer.set_camera(&builtin::furnace(0).cameras[0]);
            renderer.frame(None)?;
            let sent = renderer.light_in_volume()?;
            let mut most = sent;
            for _ in 0..20 {
                renderer.settle(100, None)?;
                most = most.max(renderer.light_in_volume()?);
            }
            faults.check(gpu, &what, &mut renderer)?;
            let left = renderer.light_in_volume()?;
            // Rounding to half floats is unbiased but not exact: 2000 steps of it stay within a hundredth.
            if most > 1.01 * sent || (sent == 0.0) != (albedo == 0.0) {
                faults.0.push(format!("{what}: {sent} W were sent, {most} were under way"));
            }
            if albedo == 0.0 && left > 1e-3 * sent {
                faults.0.push(format!("{what}: {left} of {sent} W are left in a black box"));
            }
        }
    }
    faults.into_result()
}
